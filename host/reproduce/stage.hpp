// What `reproduce` runs: the program's own commands, one after the other, each with the files that it leaves.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu::reproduce {

/// One command, run in the folder of the results.
struct Stage {
  std::string name;                   ///< "harmonic"
  std::string what;                   ///< "the surface over the harmonic map, by the paper's recipe"
  std::vector<std::string> arguments; ///< arguments of the program
  std::string output;                 ///< takes standard output: "data/tensors.json", or a text
  std::vector<std::string> files;     ///< that the command writes itself
  double seconds = 1;                 ///< what it took on two cores, for the estimate of the time left
};

/// A picture, made by a stage.
struct Figure {
  std::string file, title, caption;
};

struct Plan {
  std::vector<Stage> stages;
  std::vector<Figure> figures;
};

/// For the paper's mesh, or another that stands in for it; `device` as --device has it; with `page` also the report, report.html.
Plan plan(const std::string& mesh, bool papers_mesh, const std::string& device, bool page);

/// What is left of a stage that ran: nothing is run twice whose key and files are as they were.
struct Done {
  std::string key; ///< SHA-256 of the program, the mesh's name and the arguments
  double seconds = 0;
  std::vector<std::string> hashes; ///< SHA-256 of output and files, in this order
};

/// The state of a run, in DIR/data/stages.json. A file that is missing or damaged is an empty state.
class State {
public:
  explicit State(std::filesystem::path folder);
  /// The stage as it was run, where it succeeded with the same key and its files are unchanged.
  std::optional<Done> finished(const Stage& stage, const std::string& key) const;
  /// Takes it down and writes the state, whole or not at all. Throws Error(cannot_write).
  void finish(const Stage& stage, const std::string& key, double seconds);

private:
  std::vector<std::string> hashes(const Stage& stage) const;
  std::filesystem::path folder_;
  std::vector<std::pair<std::string, Done>> done_;
};

/// The key of a stage: `program` is the hash of the program itself.
std::string stage_key(const Stage& stage, const std::string& program);

} // namespace cowgpu::reproduce

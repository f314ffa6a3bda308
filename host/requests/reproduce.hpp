// Every table, number and figure of "Higher multipoles of the cow", beside what the paper prints.
#pragma once

#include "host/monitor.hpp"
#include "host/reproduce/report.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace cowgpu {

/// Runs the program `cowgpu` with `arguments` in `folder`. Standard output goes to the file `output` there, standard error to
/// `errors`; `waiting` is called now and then. Returns the exit code.
using RunStage =
    std::function<int(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                      const std::string& output, const std::string& errors, const std::function<void()>& waiting)>;

struct ReproduceRequest {
  std::filesystem::path folder;  ///< of the results; a run that was stopped goes on where it was
  std::string mesh;              ///< word for the mesh that every stage reads, the same in every folder
  std::string mesh_sha256;       ///< SHA-256 of that mesh; numbers are compared where it is the paper's
  bool asked_for = false;        ///< the user wants this mesh; else another one than the paper's stands in for it
  std::string device = "auto";   ///< as the option --device has it
  std::vector<std::string> only; ///< stages by name; empty: all
  bool fresh = false;            ///< do again what was done before
  bool page = true;              ///< also the page report.html
  RunStage run;
  std::string program;              ///< what identifies the program that `run` runs: stages of others are done again
  std::vector<std::string> command; ///< the command line, for the document
  /// Told after each stage, with its number from 1 and how many there are; may be empty.
  std::function<void(const reproduce::Ran& ran, std::size_t number, std::size_t count)> done;
};

/// Runs the stages one after the other, goes on where one fails, lays what they wrote beside the paper's numbers, and writes
/// reproduce.json and reproduce.md; data/ and figures/ have what the stages left. Throws
/// Error(bad_argument) for a stage that there is none of and for a folder in which another run is going on, cannot_write,
/// interrupted.
reproduce::Reproduction reproduce_paper(const ReproduceRequest& request, Monitor& monitor);

} // namespace cowgpu

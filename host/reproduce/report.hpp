// What `reproduce` found, as a document and as JSON.
#pragma once

#include "host/document.hpp"
#include "host/reproduce/row.hpp"
#include "host/reproduce/stage.hpp"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace cowgpu::reproduce {

/// How a stage ended.
struct Ran {
  Stage stage;
  double seconds = 0;
  int exit_code = 0;
  bool again = false;  ///< false: left by an earlier run
  std::string message; ///< last words of a stage that failed
};

struct Reproduction {
  std::vector<std::string> command;
  std::string created;
  std::string mesh, mesh_hash;
  bool papers_mesh = true;
  bool asked_for = false; ///< the user named this mesh; else it stands in for the paper's, which is missing
  nlohmann::json device;  ///< as in the result of `expand`, or null
  double seconds = 0;     ///< time of all stages, whenever they ran
  std::vector<Row> rows;
  std::vector<Ran> stages;
  std::vector<Figure> figures; ///< those that are there
  nlohmann::json errata;       ///< output of `cowgpu errata --json`, or null
};

/// How many rows of each verdict.
struct Tally {
  int agrees = 0, differs = 0, not_compared = 0, not_computed = 0;
};
Tally tally(const std::vector<Row>& rows);

/// The document cowgpu.reproduce.v1.
Object document(const Reproduction& all);

/// The same to read, in Markdown, the pictures linked.
std::string reproduce_markdown(const Reproduction& all);

} // namespace cowgpu::reproduce

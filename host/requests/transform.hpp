// What `transform` computes: coefficients of the fields on a grid, and fields from their coefficients.
#pragma once

#include "host/backend.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/grid_file.hpp"

#include <string>
#include <vector>

namespace cowgpu {

struct AnalyseRequest {
  GridFile input;        ///< as read_grid() has it
  std::string name;      ///< name of the input, for messages
  int lmax = -1;         ///< largest degree, at most the grid's; below 0: the input's
  Convention convention; ///< convention of the file to be written
};

struct SynthesiseRequest {
  CoefficientFile input; ///< as read_coefficients() has it
  std::string name;      ///< name of the input, for messages
  int lmax = -1;         ///< degree of the grid; below 0: the input's. Coefficients above it are left out
  GridKind grid = GridKind::gauss_legendre;
};

/// What a transform will do.
struct TransformPlan {
  const char* direction = ""; ///< "analysis" or "synthesis"
  SphereGrid grid;
  int lmax = 0;                   ///< largest degree that is transformed
  std::vector<std::string> names; ///< one a field
  std::vector<std::string> notes; ///< sentences: of the reader, and what is left out
  Convention convention;          ///< convention of the coefficients in the file
  MemoryNeed memory;              ///< at most, files and all
};

/// Throw Error(bad_argument) for a degree beyond the grid, too_large for memory that this machine does not have.
TransformPlan plan_transform(const AnalyseRequest& request, const Backend& backend);
TransformPlan plan_transform(const SynthesiseRequest& request, const Backend& backend);

/// What a transform did.
struct TransformRun {
  TransformPlan plan;
  DeviceFacts device;
  TransformReport report;
  double setup_seconds = 0; ///< grid, nodes, weights, recurrences
};

struct AnalyseResult {
  CoefficientFile coefficients;
  TransformRun run;
};

struct SynthesiseResult {
  GridFile grid;
  TransformRun run;
};

/// Throw what plan_transform() and the transform throw, and Error(file_format) where sums of the input overflow doubles.
AnalyseResult analyse(const AnalyseRequest& request, Backend& backend, Monitor& monitor);
SynthesiseResult synthesise(const SynthesiseRequest& request, Backend& backend, Monitor& monitor);

} // namespace cowgpu

// What `transform` computes: coefficients of the fields on a grid, and fields from their coefficients.
#pragma once

#include "host/backend.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/grid_file.hpp"
#include "host/report/transform_report.hpp"

#include <string>

namespace cowgpu {

struct AnalyseRequest {
  GridFile input;        ///< as read_grid() has it
  std::string name;      ///< name of the input, for messages
  int lmax = -1;         ///< largest degree, at most the grid's; below 0: the input's
  Convention convention; ///< convention of the file to be written
};

struct SynthesiseRequest {
  CoefficientSet input; ///< as read_fields() has it
  std::string name;     ///< name of the input, for messages
  int lmax = -1;        ///< degree of the grid; below 0: the input's. Coefficients above it are left out
  GridKind grid = GridKind::gauss_legendre;
};

/// Throw Error(bad_argument) for a degree beyond the grid, too_large for memory that this machine does not have.
TransformPlan plan_transform(const AnalyseRequest& request, const Backend& backend);
TransformPlan plan_transform(const SynthesiseRequest& request, const Backend& backend);

struct AnalyseResult {
  CoefficientSet coefficients; ///< real, in the convention that was asked for
  TransformRun run;
};

struct SynthesiseResult {
  GridFile grid;
  TransformRun run;
};

/// The caller fills in `command`, `output` and the times of files. Throw what plan_transform() and the transform throw,
/// and Error(file_format) where sums of the input overflow doubles, bad_argument where the convention asked for does.
AnalyseResult analyse(const AnalyseRequest& request, Backend& backend, Monitor& monitor);
SynthesiseResult synthesise(const SynthesiseRequest& request, Backend& backend, Monitor& monitor);

} // namespace cowgpu

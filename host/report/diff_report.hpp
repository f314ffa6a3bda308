// Two files of coefficients beside each other, ready to be shown.
#pragma once

#include "host/report/result.hpp"
#include "host/spectrum/difference.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// Result of `diff`.
struct DiffResult {
  std::vector<std::string> command; ///< as typed
  std::string created;              ///< UTC, ISO 8601
  std::string first, second;        ///< names of the files
  CoefficientDifference difference;
  std::optional<double> tolerance;
  std::vector<std::string> notes; ///< sentences of the readers, which begin with "A: " or "B: "
};

/// For people: a table of each field by degree.
void write_screen(const DiffResult& result, const Sink& sink);

/// After data/schemas/cowgpu.diff.v1.json.
Object document(const DiffResult& result);

} // namespace cowgpu

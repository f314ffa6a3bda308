// Transforms between fields on a grid and their coefficients, ready to be shown.
#pragma once

#include "host/convention.hpp"
#include "host/report/result.hpp"
#include "host/sphere_transform.hpp"

#include <string>
#include <vector>

namespace cowgpu {

/// What a transform will do.
struct TransformPlan {
  const char* direction = ""; ///< "analysis" or "synthesis"
  SphereGrid grid;
  int lmax = 0;                   ///< largest degree that is transformed
  std::vector<std::string> names; ///< one a field
  std::vector<std::string> notes; ///< sentences: of the reader, and what is left out
  Convention convention;          ///< convention of the coefficients in the file
  DeviceFacts device;
  MemoryNeed memory; ///< at most, files and all
};

/// What a transform did.
struct TransformRun {
  std::vector<std::string> command; ///< as typed
  std::string created;              ///< UTC, ISO 8601
  std::string input, output;        ///< names of the files
  TransformPlan plan;
  TransformReport report;
  double read_seconds = 0, setup_seconds = 0, write_seconds = 0; ///< set-up: grid, nodes, weights, recurrences
};

/// For people, before the work.
void write_plan(const TransformPlan& plan, const Sink& sink);

/// For people: what was computed, on what, how long.
void write_screen(const TransformRun& run, const Sink& sink);

/// After data/schemas/cowgpu.transform.v1.json.
Object document(const TransformRun& run);

} // namespace cowgpu

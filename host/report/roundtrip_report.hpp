// Random coefficients to a grid and back, ready to be shown.
#pragma once

#include "host/report/result.hpp"
#include "host/spectrum/roundtrip.hpp"
#include "host/sphere_transform.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace cowgpu {

/// What is asked for.
struct RoundtripRequest {
  int lmax = 0;
  int fields = 1; ///< transformed together, at most most_fields
  GridKind grid = GridKind::gauss_legendre;
  std::uint64_t seed = 1; ///< seed of the coefficients
  int runs = 1;           ///< timed runs after one to warm up
};

/// Result of `transform roundtrip`.
struct RoundtripResult {
  std::vector<std::string> command; ///< as typed
  std::string created;              ///< UTC, ISO 8601
  std::vector<std::string> notes;   ///< sentences: why the CPU was used
  RoundtripRequest request;
  SphereGrid grid;
  DeviceFacts device;
  MemoryNeed memory;                   ///< at most
  double setup_seconds = 0;            ///< nodes, weights, recurrences
  TransformReport synthesis, analysis; ///< reports of the run with the median time
  CoefficientError error;
  double bound = 0;                      ///< what error.max may be
  std::uint64_t peak_resident_bytes = 0; ///< most memory that the process had

  bool passed() const { return error.max <= bound; } // NaN fails
};

/// For people: grid, device, error, times, memory.
void write_screen(const RoundtripResult& result, const Sink& sink);

/// For people, before the work: grid, device, memory.
void write_plan(const RoundtripResult& result, const Sink& sink);

/// After data/schemas/cowgpu.roundtrip.v1.json.
Object document(const RoundtripResult& result);

} // namespace cowgpu

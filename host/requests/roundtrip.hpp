// What `transform roundtrip` computes: random coefficients to a grid and back.
#pragma once

#include "host/backend.hpp"
#include "host/spectrum/roundtrip.hpp"

#include <cstdint>

namespace cowgpu {

struct RoundtripRequest {
  int lmax = 0;
  int fields = 1; ///< transformed together, at most most_fields
  GridKind grid = GridKind::gauss_legendre;
  std::uint64_t seed = 1; ///< seed of the coefficients
  int runs = 1;           ///< timed runs after one to warm up
};

struct RoundtripResult {
  SphereGrid grid;
  DeviceFacts device;
  MemoryNeed memory;                   ///< at most
  double setup_seconds = 0;            ///< nodes, weights, recurrences
  TransformReport synthesis, analysis; ///< reports of the run with the median time
  CoefficientError error;
  double bound = 0; ///< what error.max may be

  bool passed() const { return error.max <= bound; } // NaN fails
};

/// Grid, device and memory alone. Throws Error(bad_argument, too_large).
RoundtripResult plan_roundtrip(const RoundtripRequest& request, const Backend& backend);

/// Throws what plan_roundtrip() and the transforms throw. An error beyond the bound is a result: see passed().
RoundtripResult roundtrip(const RoundtripRequest& request, Backend& backend, Monitor& monitor);

} // namespace cowgpu

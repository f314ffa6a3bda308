// Every path on every triangle, and the laws moments obey.
#pragma once

#include "host/backend.hpp"
#include "host/mass/error_estimate.hpp"
#include "host/mesh/body.hpp"

#include <string>
#include <vector>

namespace cowgpu {

/// One check of something that must stay within a bound.
struct Check {
  std::string what;
  double value = 0; ///< for degrees: the largest error over its estimate
  double bound = 0;
  int degree = -1; ///< where that was found; -1: no degree
  bool passed = false;
  double relative = -1; ///< for degrees: the largest error over the norm, of degrees known to half of it; -1: none
};

struct Validation {
  std::vector<Check> checks;
  /// Estimate for the CPU path's moments, with what the cut-off leaves out; checks allow for the default's only.
  ErrorEstimate estimate;
};

/// Moments of `body` to `lmax` by the reference in extended precision, the CPU path on one and on all threads, and, if
/// `gpu` is not null, Vulkan, on all triangles; each against the reference, whose error must not exceed the estimate
/// (host/mass/error_estimate.hpp), and run to run; then against closed facts: Q_00 and the volume, the dipole about the
/// centre of mass, Q_2m and the Cartesian quadrupole tensor. Throws what the backends throw.
Validation validate_moments(const Body& body, int lmax, double cut_off, Backend* gpu, unsigned threads,
                            Monitor& monitor);

} // namespace cowgpu

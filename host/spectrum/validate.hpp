// Every path on every triangle, and the laws moments obey.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/body.hpp"

#include <string>
#include <vector>

namespace cowgpu {

/// One check: a figure and the bound it must stay within (of degrees: DegreeErrors::weighed must).
struct Check {
  std::string what;
  double value = 0;
  double bound = 0;
  int degree = -1; ///< where the worst was found; -1: no degree
  bool passed = false;
};

/// Moments of `body` to `lmax` by the reference in extended precision, the CPU path on one and on all threads, and, if
/// `gpu` is not null, Vulkan, on all triangles; each against the reference and run to run; then against closed facts: Q_00
/// and the volume, the dipole about the centre of mass, Q_2m and the Cartesian quadrupole tensor. Throws what the
/// backends throw.
std::vector<Check> validate_moments(const Body& body, int lmax, double cut_off, Backend* gpu, unsigned threads,
                                    Monitor& monitor);

} // namespace cowgpu

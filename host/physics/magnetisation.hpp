// The field of a uniformly magnetised body.
#pragma once

#include "host/potential.hpp"
#include "host/types.hpp"

#include <span>
#include <vector>

namespace cowgpu::physics {

/// Vacuum magnetic permeability in N/A^2, CODATA 2018.
inline constexpr double vacuum_permeability = 1.25663706212e-6;

/// B in tesla of a body with `magnetisation` in A/m times its density, from the second derivatives of V = integral of density/|x - y|,
/// which have no unit (Poisson 1826; R. J. Blakely, Potential Theory in Gravity and Magnetic Applications, 1995, sect. 5.3): with
/// H = (dd V) M/4 pi and the density -(trace of dd V)/4 pi at the place,
///   B = mu_0 (H + density M) = mu_0/(4 pi) (dd V - trace(dd V)) M.
/// On a face, where B jumps along it, the mean of both sides'.
std::vector<Vec3> magnetic_induction(std::span<const SymmetricTensor> hessian, const Vec3& magnetisation);

} // namespace cowgpu::physics

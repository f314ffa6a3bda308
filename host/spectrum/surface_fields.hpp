// The six fields of a surface over the sphere, from its positions.
#pragma once

#include "host/sphere_grid.hpp"
#include "host/types.hpp"

#include <array>
#include <vector>

namespace cowgpu {

/// f_r = |F - origin|, f_dtheta = theta(F - origin) - theta, f_dphi = phi(F - origin) - phi wrapped to (-pi, pi] (its
/// absolute value unless `signed_dphi`), and x, y, z of F. The angles are 0 where F is the origin.
std::array<double, 6> surface_field_values(const Vec3& position, const Vec3& origin, double theta, double phi,
                                           bool signed_dphi);

/// The same for every point of a grid: `positions` are x, y, z of F, [3][ring][longitude]; the result is
/// [field][ring][longitude].
std::vector<double> surface_fields(const std::vector<double>& positions, const SphereGrid& grid, const Vec3& origin,
                                   bool signed_dphi);

} // namespace cowgpu

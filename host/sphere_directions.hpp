// The directions of a grid's points, as the doubles that exact decisions are about.
#pragma once

#include "host/sphere_grid.hpp"
#include "host/types.hpp"

#include <vector>

namespace cowgpu {

/// Point (i, j) of a grid has the direction (s_i c_j, s_i t_j, z_i): s_i and z_i are sin theta_i and cos theta_i, c_j and
/// t_j cos and sin of phi_j = 2 pi (j + shift) / ring_length, each rounded to double; the products are rounded to double. It is
/// (0, 0, 1) or (0, 0, -1) for every point of a ring at a pole, has exact zeros wherever phi_j is a multiple of 90
/// degrees or theta_i is 90 degrees, and exact symmetry between the octants.
struct SphereDirections {
  explicit SphereDirections(const SphereGrid& grid);

  Vec3 operator()(int ring, int j) const {
    const auto i = std::size_t(ring), k = std::size_t(j);
    return {sine[i] * cosine_phi[k], sine[i] * sine_phi[k], cosine[i]};
  }

  std::vector<double> sine, cosine;         ///< sine and cosine of theta, one a ring
  std::vector<double> cosine_phi, sine_phi; ///< one a longitude
};

} // namespace cowgpu

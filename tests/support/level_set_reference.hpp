// Coefficients of the level set's map by quadrature over the level set itself, piece by piece: no ray is cast, no root is
// looked for and no grid of the sphere is used.
#pragma once

#include "host/mesh/raw_mesh.hpp"
#include "host/types.hpp"

#include <array>
#include <complex>
#include <vector>

namespace cowgpu::test {

/// a_lm of f_r, f_dtheta, f_dphi, x, y, z (host/spectrum/surface_fields.hpp), l = 0 ... lmax, m = 0 ... l, means included:
/// [l (l + 1) / 2 + m][field].
using LevelSetCoefficients = std::vector<std::array<std::complex<double>, 6>>;

/// The integrals of f conj(Y_lm) d Omega over the level set d = level of a closed manifold mesh, with d Omega = n . p / |p|^3 dA,
/// p from the origin. Level 0: of the faces, for a body star-shaped about the origin (angles are 0, as F lies on the ray).
/// Above 0: of the faces moved outwards, cylinders about the edges and parts of balls about the vertices, for a convex body. Absolute error
/// about `tolerance` times the body's size.
LevelSetCoefficients level_set_coefficients(const RawMesh& mesh, const Vec3& origin, double level, int lmax,
                                            double tolerance = 1e-9);

} // namespace cowgpu::test

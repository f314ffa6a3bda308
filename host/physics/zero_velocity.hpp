// Surfaces of zero velocity: where a particle with a given Jacobi constant would come to rest, and beyond which it cannot be.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/body.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/monitor.hpp"
#include "host/physics/spinning_field.hpp"

#include <array>

namespace cowgpu::physics {

struct ZeroVelocityProblem {
  double constant = 1; ///< G in the body's units
  Spin spin;
  double jacobi = 0; ///< v^2/2 - W, W = G V + w^2 r^2/2
  double extent = 1; ///< half side of the cube about Spin::through, along the mesh's axes, that is looked at
  int cells = 64;    ///< along its sides
  double tolerance =
      1e-9; ///< of the field on the lattice, as PolyhedronProblem has it; vertices are placed by direct sums
};

/// The level set -W = jacobi in the cube, open where it leaves that, empty where it does not meet it; seen counter-clockwise from
/// where a particle with this constant may be, -W < jacobi, and its normals point there. By marching tetrahedra on a lattice; each vertex is moved along its
/// edge until -W is right to 1e-12 of the largest |W| on the lattice, so that the surface is right to O(cell^2). What is
/// thinner than a cell may be missed. Throws Error(bad_argument) for an extent that is not above 0 or cells outside 4 ... 512;
/// what SpinningField throws. Memory: 8 bytes a point of the lattice and about 200 a vertex.
TriangleSurface zero_velocity_surface(const Body& body, const ZeroVelocityProblem& problem, const Backend& backend,
                                      Monitor& monitor);

} // namespace cowgpu::physics

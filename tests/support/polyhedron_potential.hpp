// The exact gravity of a polyhedron of uniform density.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <Eigen/Core>

namespace cowgpu::test {

using LongVec3 = Eigen::Matrix<long double, 3, 1>;

/// At one point, for G * density = 1.
struct PolyhedronGravity {
  long double potential = 0;                ///< U = integral of 1 / |x - p|, positive
  LongVec3 acceleration = LongVec3::Zero(); ///< its gradient
  long double laplacian = 0;                ///< -4 pi inside, 0 outside
};

/// Werner and Scheeres, Exterior gravitation of a polyhedron derived and compared with harmonic and mascon gravitation
/// representations of asteroid 4769 Castalia, Celest. Mech. Dyn. Astron. 65 (1997) 313: equations 10, 15 and 17, with the
/// edge dyads summed face by face, so that the surface need not be a manifold. The mesh is closed and looks outwards; `at`
/// lies on no edge.
PolyhedronGravity polyhedron_gravity(const RawMesh& mesh, const LongVec3& at);

} // namespace cowgpu::test

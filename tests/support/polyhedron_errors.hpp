// How far the field of a polyhedron is from the truth, in the units of its tolerance.
#pragma once

#include "host/mesh/raw_mesh.hpp"
#include "host/polyhedron.hpp"

#include <vector>

namespace cowgpu::test {

std::vector<Vec3> centroids(const RawMesh& mesh);

/// `mesh` must outlive it.
PolyhedronProblem fast_problem(const RawMesh& mesh, double tolerance, Derivatives derivatives = Derivatives::first,
                               bool guarantee = false);

/// The largest: of the gradient over v/R^2, of V over v/R, with v the volume and R the radius of its ball; of the winding number
/// and of second derivatives as they are. `bound`: the largest one over v/R^2; `bounded`: no error is above its own.
struct FieldErrors {
  double gradient = 0, value = 0, winding = 0, hessian = 0, bound = 0;
  bool bounded = true;
};
FieldErrors field_errors(const RawMesh& mesh, const PolyhedronValues& found, const PolyhedronValues& truth);

} // namespace cowgpu::test

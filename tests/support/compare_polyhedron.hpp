// One call that holds every path of the stage `polyhedron` against the reference.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/raw_mesh.hpp"
#include "tests/support/compare_moments.hpp"

#include <span>
#include <vector>

namespace cowgpu::test {

/// `mesh` must outlive it.
PolyhedronProblem polyhedron_problem(const RawMesh& mesh, Derivatives derivatives = Derivatives::second);

/// Centroids, vertices, midpoints of edges, points above faces, inside, around and up to 20 radii away, in turn.
std::vector<Vec3> points_about(const RawMesh& mesh, std::size_t count, unsigned seed);

/// Without anybody watching.
PolyhedronValues polyhedron(Backend& backend, const PolyhedronProblem& problem, std::span<const Vec3> points,
                            RunReport* report = nullptr);

/// What compare_polyhedron() asks for.
struct PolyhedronFigures {
  /// Error of V by |V|, and of the gradient by its norm: 4e-15 on the body, a (distance/radius)^2 times that up to 3 radii.
  double field = 5e-14;
  double tensor = 2e-14; ///< error of second derivatives by their norm, and of the winding number; 0: do not look
};

/// Errors against the reference in 80-bit arithmetic, at no more than about 64 of the points, are within `figures` on every path;
/// which points are on edges is the same.
void compare_polyhedron(Paths& paths, const PolyhedronProblem& problem, std::span<const Vec3> points,
                        const PolyhedronFigures& figures = {});

bool same_bits(const PolyhedronValues& a, const PolyhedronValues& b);

} // namespace cowgpu::test

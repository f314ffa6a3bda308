// One call that holds every path of the stage `closest` against the reference; and queries to do it with.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/raw_mesh.hpp"
#include "tests/support/compare_moments.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace cowgpu::test {

/// Without anybody watching.
ClosestPoints closest(Backend& backend, const RawMesh& mesh, const std::vector<Vec3>& queries, bool with_sign = true);

/// Asks of every path: distances within `figure` (of the diagonal plus the distance) of the reference's in 113-bit
/// arithmetic; points at that distance (as far as coordinates can say it), on the feature named, where their barycentric coordinates put them, in the least
/// face that holds the feature; with sign, the reference's winding numbers and the sign they mean; all paths the same bits.
/// Together that proves a closest point right without asking for the reference's choice among equals.
void compare_closest(Paths& paths, const RawMesh& mesh, const std::vector<Vec3>& queries, double figure,
                     bool with_sign = true);

/// The winding number, from solid angles in 113-bit arithmetic.
int winding_reference(const RawMesh& mesh, const Vec3& query);

/// Uniform in the bounding box enlarged by `factor`.
std::vector<Vec3> queries_in_box(const RawMesh& mesh, std::size_t count, double factor, std::uint32_t seed);
/// Points of the surface (as many on every face), moved by a Gaussian of `deviation` diagonals.
std::vector<Vec3> queries_near_surface(const RawMesh& mesh, std::size_t count, double deviation, std::uint32_t seed);
/// Vertices, then points of edges, and all of them moved by about 1e-15 and 1e-9 diagonals.
std::vector<Vec3> queries_at_edges(const RawMesh& mesh, std::size_t count, std::uint32_t seed);

double diagonal(const RawMesh& mesh);

} // namespace cowgpu::test

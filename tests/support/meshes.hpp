// Families of closed meshes for property tests. All are oriented outwards unless flipped.
#pragma once

#include "host/mesh/closed_surface.hpp"

#include <Eigen/Geometry>

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace cowgpu::test {

/// The box [corner, corner + sides].
RawMesh box(const Vec3& sides, const Vec3& corner = Vec3::Zero());
/// The tetrahedron with these corners, in any order.
RawMesh tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
/// The convex hull of `points` random points with integer coordinates of size at most `largest` (under 1000): exact,
/// with coplanar neighbours where the grid makes them.
RawMesh convex_polyhedron(std::mt19937& random, int points, int largest);
/// An icosahedron cut `level` times at its edges' midpoints, then blown up to the sphere of this radius: 20 * 4^level
/// faces, as smooth over each of the twenty as the sphere is, so that errors have a series in 4^-level.
RawMesh icosphere(int level, double radius = 1);
/// A torus about the z axis, 2 n m faces.
RawMesh torus(std::uint32_t n, std::uint32_t m, double ring_radius = 3, double tube_radius = 1);
/// Two tori far apart, of different size and direction.
RawMesh two_shells();
/// A box with a ball taken out of it, off its middle.
RawMesh shell_with_cavity();

/// Both as one mesh of several shells.
RawMesh together(RawMesh mesh, const RawMesh& more);
RawMesh flipped(RawMesh mesh);
RawMesh translated(RawMesh mesh, const Vec3& shift);
RawMesh scaled(RawMesh mesh, const Vec3& factors);
RawMesh rotated(RawMesh mesh, const Eigen::Matrix3d& rotation);
/// Vertices, faces and the corner each face begins with in random order.
RawMesh shuffled(RawMesh mesh, std::uint32_t seed);
/// `count` faces, stepping through the mesh by `stride`: neighbours mostly where that is 1.
RawMesh some_faces(RawMesh mesh, std::size_t count, std::size_t stride = 1);

/// cow.off, found in $COWGPU_MESHES or in data/meshes and known by its checksum.
std::optional<ClosedSurface> benchmark_cow();
/// Makes ctest list the test as skipped; the test returns then.
void skip_without_cow();

/// The closed bodies of genus 0 among those of Debian's libcgal-demo.
extern const std::vector<std::string> demo_bodies;
/// One of them by name ("bull"), found in $COWGPU_BODIES or in data/meshes/cgal, where ./check puts them.
std::optional<ClosedSurface> demo_body(const std::string& name);
/// Makes ctest list the test as skipped; the test returns then.
void skip_without_bodies(const std::string& name);

} // namespace cowgpu::test

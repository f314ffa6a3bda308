#include "host/mesh/audit.hpp"

#include "host/mesh/topology.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace cowgpu {
namespace {

using Wide3 = Eigen::Matrix<long double, 3, 1>;

std::size_t duplicates(std::vector<Face> faces) {
  for (Face& face : faces) std::sort(face.begin(), face.end());
  std::sort(faces.begin(), faces.end());
  return static_cast<std::size_t>(faces.end() - std::unique(faces.begin(), faces.end()));
}

std::size_t coincident_groups(const std::vector<Vec3>& vertices) {
  std::vector<std::array<double, 3>> places;
  places.reserve(vertices.size());
  for (const Vec3& p : vertices) places.push_back({p.x(), p.y(), p.z()});
  std::sort(places.begin(), places.end());
  std::size_t groups = 0;
  for (std::size_t i = 1; i < places.size(); ++i)
    groups += places[i] == places[i - 1] && (i == 1 || places[i] != places[i - 2]);
  return groups;
}

/// True if the triangle's height over its longest side is below the rounding of its coordinates.
bool has_no_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Wide3 u = (b.cast<long double>() - a.cast<long double>()), v = (c.cast<long double>() - a.cast<long double>());
  const long double longest = std::sqrt(std::max({u.squaredNorm(), v.squaredNorm(), (v - u).squaredNorm()}));
  const double largest = a.cwiseAbs().cwiseMax(b.cwiseAbs()).cwiseMax(c.cwiseAbs()).maxCoeff();
  return u.cross(v).norm() <= 0x1p-52L * largest * longest;
}

void add_topology(Audit& a, const RawMesh& mesh, std::span<const EdgeUse> uses) {
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    const EdgeBalance sides = balance(edge);
    const std::size_t surplus = std::max(sides.forward, sides.backward) - std::min(sides.forward, sides.backward);
    ++a.edges;
    a.open_edges += edge.size() % 2;
    a.unbalanced_edges += surplus > 1;
    a.crowded_edges += edge.size() > 2;
  });
  a.pinched_vertices = vertices_with_several_fans(mesh.faces, uses, a.vertices).size();
  a.unused_vertices = unused_vertices(mesh.faces, a.vertices);
  a.repeating_faces = static_cast<std::size_t>(std::count_if(mesh.faces.begin(), mesh.faces.end(), repeats_vertex));
  a.duplicate_faces = duplicates(mesh.faces);
  a.closed = a.faces != 0 && a.open_edges == 0;
  a.consistently_oriented = a.unbalanced_edges == 0;
  a.edge_manifold = a.crowded_edges == 0 && a.repeating_faces == 0;
  a.vertex_manifold = a.pinched_vertices == 0;
  a.euler_characteristic = static_cast<std::int64_t>(a.vertices - a.unused_vertices) -
                           static_cast<std::int64_t>(a.edges) + static_cast<std::int64_t>(a.faces);
}

void add_geometry(Audit& a, const RawMesh& mesh, std::span<const EdgeUse> uses) {
  for (const Face& f : mesh.faces)
    a.degenerate_faces +=
        repeats_vertex(f) || has_no_area(mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]);
  a.coincident_groups = coincident_groups(mesh.vertices);
  a.box = bounding_box(mesh.vertices, mesh.faces);
  a.area = area(mesh.vertices, mesh.faces);
  if (uses.empty()) return;
  long double shortest = std::numeric_limits<long double>::infinity(), longest = 0;
  for (const EdgeUse& use : uses) {
    const long double length =
        (mesh.vertices[use.high].cast<long double>() - mesh.vertices[use.low].cast<long double>()).squaredNorm();
    shortest = std::min(shortest, length);
    longest = std::max(longest, length);
  }
  a.shortest_edge = static_cast<double>(std::sqrt(shortest));
  a.longest_edge = static_cast<double>(std::sqrt(longest));
}

void add_volumes(Audit& a, const RawMesh& mesh, std::span<const std::uint32_t> shell) {
  const double noise = volume_noise(mesh.vertices, mesh.faces);
  a.volume = volume(mesh.vertices, mesh.faces);
  a.outward = *a.volume > noise;
  if (std::fabs(*a.volume) > noise) a.centre_of_mass = centre_of_mass(mesh.vertices, mesh.faces);
  for (const ShellSize& size : shell_sizes(mesh.vertices, mesh.faces, shell, a.components))
    a.cavities += size.volume < -noise * (size.area / a.area);
}

} // namespace

Audit audit(const RawMesh& mesh) {
  require_valid_indices(mesh);
  Audit a;
  a.vertices = mesh.vertices.size();
  a.faces = mesh.faces.size();
  const std::vector<EdgeUse> uses = edge_uses(mesh.faces, a.vertices);
  add_topology(a, mesh, uses);
  const std::vector<std::uint32_t> shell = shells(mesh.faces, uses, a.components);
  const bool oriented = a.closed && a.consistently_oriented;
  if (oriented && a.edge_manifold && a.vertex_manifold)
    a.genus = static_cast<std::int64_t>(a.components) - a.euler_characteristic / 2;

  a.not_finite_vertices = static_cast<std::size_t>(
      std::count_if(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& p) { return !p.allFinite(); }));
  a.finite = a.not_finite_vertices == 0;
  if (!a.finite) return a;
  add_geometry(a, mesh, uses);
  if (oriented) add_volumes(a, mesh, shell);
  return a;
}

} // namespace cowgpu

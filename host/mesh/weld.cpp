#include "host/mesh/weld.hpp"

#include "host/mesh/topology.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace cowgpu {
namespace {

constexpr std::uint32_t free_slot = PointWelder::none;

std::uint64_t bits(double x) {
  return std::bit_cast<std::uint64_t>(x + 0.0); // -0 becomes +0
}

bool same(const Vec3& a, const Vec3& b) {
  return bits(a[0]) == bits(b[0]) && bits(a[1]) == bits(b[1]) && bits(a[2]) == bits(b[2]);
}

/// Every step is one-to-one and spreads high bits to low ones (the finaliser of splitmix64).
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

std::uint64_t hash(const Vec3& p) {
  return mixed(bits(p[0]) + 0x9e3779b97f4a7c15U * mixed(bits(p[1]) + 0x9e3779b97f4a7c15U * mixed(bits(p[2]))));
}

/// Gives the corners their new numbers and leaves out the faces that collapse; returns how many.
std::size_t renumber(RawMesh& mesh, std::span<const std::uint32_t> to) {
  std::size_t kept = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Face old = mesh.faces[f], face = {to[old[0]], to[old[1]], to[old[2]]};
    if (repeats_vertex(face) && !repeats_vertex(old)) continue;
    mesh.faces[kept] = face;
    if (!mesh.face_lines.empty()) mesh.face_lines[kept] = mesh.face_lines[f];
    ++kept;
  }
  const std::size_t collapsed = mesh.faces.size() - kept;
  mesh.faces.resize(kept);
  if (!mesh.face_lines.empty()) mesh.face_lines.resize(kept);
  return collapsed;
}

/// Vertices joined that lie within `distance`, in chains too. Cubes of side distance / sqrt(3) hold vertices that are near
/// whatever they are; those of two cubes are compared where the cubes are near.
DisjointSets near_points(std::span<const Vec3> vertices, double distance) {
  const double side = distance / std::sqrt(3.0) * (1 - 1e-12);
  std::vector<Vec3> cubes;
  PointWelder numbers(cubes);
  std::vector<std::vector<std::uint32_t>> members;
  DisjointSets sets(vertices.size());
  const auto near = [&](std::uint32_t a, std::uint32_t b) {
    return (vertices[a] - vertices[b]).squaredNorm() <= distance * distance;
  };
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    const std::uint32_t cube = numbers.index((vertices[v] / side).array().floor());
    if (cube == members.size()) members.emplace_back();
    // The first of them, but where the cubes are as small as the rounding of the coordinates.
    const auto other = std::find_if(members[cube].begin(), members[cube].end(), [&](auto m) { return near(m, v); });
    if (other != members[cube].end()) sets.join(*other, v);
    members[cube].push_back(v);
  }
  const auto join_some = [&](std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
    for (const std::uint32_t i : a)
      for (const std::uint32_t j : b) {
        if (sets.find(i) == sets.find(j)) return; // each cube is one set
        if (near(i, j)) return sets.join(i, j);
      }
  };
  for (std::uint32_t cube = 0; cube < members.size(); ++cube) {
    const Vec3 at = cubes[cube];
    for (int x = -2; x <= 2; ++x)
      for (int y = -2; y <= 2; ++y)
        for (int z = -2; z <= 2; ++z)
          if (const std::uint32_t other = numbers.find(at + Vec3(x, y, z)); other != PointWelder::none && other > cube)
            join_some(members[cube], members[other]);
  }
  return sets;
}

} // namespace

std::size_t PointWelder::slot(const Vec3& point) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t i = hash(point) & mask;
  while (slots_[i] != free_slot && !same(points_[slots_[i]], point)) i = (i + 1) & mask;
  return i;
}

std::uint32_t PointWelder::index(const Vec3& point) {
  if (4 * (points_.size() + 1) > 3 * slots_.size()) grow();
  std::uint32_t& found = slots_[slot(point)];
  if (found == free_slot) {
    found = static_cast<std::uint32_t>(points_.size());
    points_.push_back(point);
  }
  return found;
}

std::uint32_t PointWelder::find(const Vec3& point) const {
  return slots_.empty() ? none : slots_[slot(point)];
}

void PointWelder::grow() {
  const std::size_t size = slots_.empty() ? 64 : 2 * slots_.size();
  slots_ = {}; // the old ones are made again from the points
  slots_.assign(size, free_slot);
  for (std::size_t p = 0; p < points_.size(); ++p) {
    std::size_t i = hash(points_[p]) & (size - 1);
    while (slots_[i] != free_slot) i = (i + 1) & (size - 1);
    slots_[i] = static_cast<std::uint32_t>(p);
  }
}

Weld weld_equal_points(RawMesh& mesh) {
  std::vector<std::uint32_t> to(mesh.vertices.size());
  std::vector<Vec3> points;
  PointWelder welder(points);
  for (std::size_t v = 0; v < to.size(); ++v) to[v] = welder.index(mesh.vertices[v]);
  Weld weld;
  weld.merged = to.size() - points.size();
  mesh.vertices = std::move(points);
  weld.collapsed = renumber(mesh, to);
  return weld;
}

Weld weld_near_points(RawMesh& mesh, double distance) {
  const std::size_t count = mesh.vertices.size();
  DisjointSets near = near_points(mesh.vertices, distance);
  Weld weld;
  std::vector<std::uint32_t> to(count);
  std::vector<Vec3> points;
  for (std::size_t v = 0; v < count; ++v) {
    const std::size_t first = near.find(v);
    if (first == v) {
      to[v] = static_cast<std::uint32_t>(points.size());
      points.push_back(mesh.vertices[v]);
      continue;
    }
    to[v] = to[first];
    weld.farthest = std::max(weld.farthest, (mesh.vertices[v] - mesh.vertices[first]).norm());
  }
  weld.merged = count - points.size();
  mesh.vertices = std::move(points);
  weld.collapsed = renumber(mesh, to);
  return weld;
}

bool seems_balanced(std::span<const Face> faces) {
  std::uint64_t sum = 0;
  for (const Face& f : faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t from = f[k], to = f[(k + 1) % 3];
      if (from < to) sum += mixed(from << 32 | to);
      if (from > to) sum -= mixed(to << 32 | from);
    }
  return sum == 0;
}

} // namespace cowgpu

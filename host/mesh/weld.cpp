#include "host/mesh/weld.hpp"

#include "host/mesh/topology.hpp"

#include <bit>

namespace cowgpu {
namespace {

constexpr std::uint32_t free_slot = 0xffffffff;

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

} // namespace

std::uint32_t PointWelder::index(const Vec3& point) {
  if (4 * (points_.size() + 1) > 3 * slots_.size()) grow();
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t i = hash(point) & mask;; i = (i + 1) & mask) {
    if (slots_[i] == free_slot) {
      slots_[i] = static_cast<std::uint32_t>(points_.size());
      points_.push_back(point);
      return slots_[i];
    }
    if (same(points_[slots_[i]], point)) return slots_[i];
  }
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
  Weld weld;
  std::vector<std::uint32_t> to(mesh.vertices.size());
  std::vector<Vec3> points;
  PointWelder welder(points);
  for (std::size_t v = 0; v < to.size(); ++v) to[v] = welder.index(mesh.vertices[v]);
  weld.merged = to.size() - points.size();
  mesh.vertices = std::move(points);
  std::size_t kept = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Face old = mesh.faces[f], face = {to[old[0]], to[old[1]], to[old[2]]};
    if (repeats_vertex(face) && !repeats_vertex(old)) continue;
    mesh.faces[kept] = face;
    if (!mesh.face_lines.empty()) mesh.face_lines[kept] = mesh.face_lines[f];
    ++kept;
  }
  weld.collapsed = mesh.faces.size() - kept;
  mesh.faces.resize(kept);
  if (!mesh.face_lines.empty()) mesh.face_lines.resize(kept);
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

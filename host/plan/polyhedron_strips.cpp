#include "host/plan/polyhedron_strips.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace cowgpu::plan {
namespace {

using Patches = PolyhedronPatches<double>;
using Face = Patches::Face;

constexpr std::uint32_t none = ~std::uint32_t(0);

// The strips of one patch.
class Walk {
public:
  Walk(const Patches::Patch& patch, std::vector<double>& steps) : patch_(patch), steps_(steps) {
    // Faces at each edge, in a list by its last one.
    last_.assign(patch.edges.size(), none);
    before_.assign(3 * patch.faces.size(), none);
    for (std::uint32_t side = 0; side < before_.size(); ++side) {
      const std::uint16_t edge = patch.faces[side / 3].edges[side % 3];
      before_[side] = last_[edge];
      last_[edge] = side;
    }
    taken_.assign(patch.faces.size(), false);
  }

  void all() {
    // Those with few neighbours first: later they would be strips of their own.
    for (int most = 0; most <= 3; ++most)
      for (std::uint32_t face = 0; face < patch_.faces.size(); ++face)
        if (!taken_[face] && neighbours(face) <= most) strip(face);
  }

private:
  // A face not taken yet at edge k of `face`, as 3 face + its edge; `none` where there is none.
  std::uint32_t neighbour(std::uint32_t face, std::size_t k) const {
    for (std::uint32_t side = last_[patch_.faces[face].edges[k]]; side != none; side = before_[side])
      if (!taken_[side / 3] && side / 3 != face) return side;
    return none;
  }

  int neighbours(std::uint32_t face) const {
    int count = 0;
    for (std::size_t k = 0; k < 3; ++k) count += neighbour(face, k) != none ? 1 : 0;
    return count;
  }

  // From the face on over its neighbours. The first edge PQ is one without a neighbour, if there is one.
  void strip(std::uint32_t face) {
    taken_[face] = true;
    std::size_t k = 0;
    for (std::size_t i = 0; i < 3; ++i)
      if (neighbour(face, i) == none) k = i;
    const Face& first = patch_.faces[face];
    std::uint16_t p = first.corners[k], q = first.corners[(k + 1) % 3];
    corner(p, 0, PolyhedronStrips::first);
    corner(q, patch_.edges[first.edges[k]].length, 0);
    while (true) {
      const Face& f = patch_.faces[face];
      // Corners of the face in its own order: edge k is between p and q, in one direction or the other.
      const std::size_t next = (k + 1) % 3, third = (k + 2) % 3;
      const std::uint16_t n = f.corners[third];
      const bool along = f.corners[k] == p; // then QN is edge `next`, NP edge `third`
      const std::size_t qn = along ? next : third, np = along ? third : next;
      std::uint32_t side = neighbour(face, qn);
      const std::uint32_t other = neighbour(face, np);
      const bool keep_p = side == none || (other != none && neighbours(other / 3) < neighbours(side / 3));
      if (keep_p) side = other;
      step(f, k, qn, np, n, keep_p);
      if (side == none) return;
      if (!keep_p) p = q;
      q = n;
      face = side / 3;
      k = side % 3;
      taken_[face] = true;
    }
  }

  double* room() {
    steps_.resize(steps_.size() + PolyhedronStrips::numbers, 0.0);
    return steps_.data() + steps_.size() - PolyhedronStrips::numbers;
  }
  void corner(std::uint16_t corner, double from_last, std::uint64_t flags) {
    double* to = room();
    std::copy_n(patch_.vertices[corner].data(), 3, to);
    to[17] = from_last;
    std::memcpy(to + 19, &flags, sizeof flags);
  }
  void step(const Face& f, std::size_t pq, std::size_t qn, std::size_t np, std::uint16_t n, bool keep_p) {
    double* to = room();
    std::copy_n(patch_.vertices[n].data(), 3, to);
    std::copy_n(f.normal.data(), 3, to + 3);
    std::copy_n(f.outward[pq].data(), 3, to + 6);
    std::copy_n(f.outward[qn].data(), 3, to + 9);
    std::copy_n(f.outward[np].data(), 3, to + 12);
    to[15] = f.four_areas;
    const auto& e = patch_.edges;
    to[16] = f.four_areas / (2 * e[f.edges[pq]].length);
    to[17] = e[f.edges[qn]].length;
    to[18] = e[f.edges[np]].length;
    const std::uint64_t flags = (keep_p ? PolyhedronStrips::keep_p : 0) |
                                (e[f.edges[pq]].sharp ? PolyhedronStrips::sharp_pq : 0) |
                                (e[f.edges[qn]].sharp ? PolyhedronStrips::sharp_qn : 0) |
                                (e[f.edges[np]].sharp ? PolyhedronStrips::sharp_np : 0);
    std::memcpy(to + 19, &flags, sizeof flags);
  }

  const Patches::Patch& patch_;
  std::vector<double>& steps_;
  std::vector<std::uint32_t> last_, before_;
  std::vector<bool> taken_;
};

} // namespace

PolyhedronStrips polyhedron_strips(const PolyhedronPatches<double>& patches) {
  PolyhedronStrips strips;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    strips.starts.push_back(std::uint32_t(strips.steps.size() / PolyhedronStrips::numbers));
    PolyhedronStrips::Box box{Vec3::Constant(std::numeric_limits<double>::infinity()), Vec3::Zero(), 0};
    box.high = -box.low;
    for (const auto& v : patches[p].vertices) {
      const Vec3 at(v[0], v[1], v[2]);
      box.low = box.low.cwiseMin(at);
      box.high = box.high.cwiseMax(at);
    }
    for (const auto& edge : patches[p].edges) box.longest = std::max(box.longest, edge.length);
    strips.boxes.push_back(box);
    strips.faces += patches[p].faces.size();
    Walk(patches[p], strips.steps).all();
  }
  if (strips.steps.size() / PolyhedronStrips::numbers >= none)
    throw Error(Fault::too_large, fmt::format("{} faces are more than a device sums; use --device cpu", strips.faces));
  strips.starts.push_back(std::uint32_t(strips.steps.size() / PolyhedronStrips::numbers));
  return strips;
}

void StepLists::add(std::uint32_t first, std::uint32_t end) {
  if (first == end) return;
  if (ranges.size() > starts.back() && ranges.back()[1] == first)
    ranges.back()[1] = end;
  else
    ranges.push_back({first, end});
}

PointBox::PointBox(std::span<const Vec3> points) : low(points[0]), high(points[0]) {
  for (const Vec3& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
}

void DirectLists::add(const PolyhedronStrips& strips, std::size_t patch, const PointBox& points) {
  const auto& box = strips.boxes[patch];
  const Vec3 gap = (box.low - points.high).cwiseMax(points.low - box.high).cwiseMax(Vec3::Zero());
  (gap.norm() > far_edges * box.longest ? far : near).add(strips.starts[patch], strips.starts[patch + 1]);
}

void DirectLists::end_group() {
  near.end_group();
  far.end_group();
}

DirectLists direct_lists(const PolyhedronStrips& strips, std::span<const Vec3> points, std::size_t size) {
  DirectLists lists;
  for (std::size_t begin = 0; begin < points.size(); begin += size) {
    const PointBox box(points.subspan(begin, std::min(size, points.size() - begin)));
    for (std::size_t p = 0; p < strips.boxes.size(); ++p) lists.add(strips, p, box);
    lists.end_group();
  }
  return lists;
}

} // namespace cowgpu::plan

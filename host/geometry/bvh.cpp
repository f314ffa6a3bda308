#include "host/geometry/bvh.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace cowgpu {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int bins = 16;
constexpr double edge_margin = 1e-12;

/// Closest point of the triangle (a, a + ab, a + ac) to p.
Vec3 closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& ab, const Vec3& ac) {
  const Vec3 ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = ap - ab;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return a + ab;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return a + d1 / (d1 - d3) * ab;
  const Vec3 cp = ap - ac;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return a + ac;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0 && (d4 - d3) + (d5 - d6) > 0)
    return a + ab + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (ac - ab);
  const double sum = va + vb + vc;
  return sum > 0 ? Vec3(a + vb / sum * ab + vc / sum * ac) : a;
}

double box_distance2(const Vec3& low, const Vec3& high, const Vec3& p) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
}

} // namespace

struct Bvh::Builder {
  struct Bounds {
    Vec3 low = Vec3::Constant(infinity), high = Vec3::Constant(-infinity);
    void add(const Vec3& p) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    void add(const Bounds& b) {
      low = low.cwiseMin(b.low);
      high = high.cwiseMax(b.high);
    }
    double half_area() const {
      const Vec3 d = high - low;
      return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
    }
  };

  Bvh& tree;
  std::vector<Bounds> bounds;
  std::vector<Vec3> centres;
  std::vector<std::uint32_t>& order = tree.faces_;

  /// Where to cut [begin, end): the first of the second part. `begin` if one leaf is best.
  std::uint32_t split(std::uint32_t begin, std::uint32_t end, const Bounds& box, int depth) {
    Bounds middle;
    for (std::uint32_t i = begin; i < end; ++i) middle.add(centres[order[i]]);
    const Vec3 extent = middle.high - middle.low;
    int axis = 0;
    const double length = extent.maxCoeff(&axis);
    const auto first = order.begin() + begin, last = order.begin() + end;
    const auto halve = [&] {
      const std::uint32_t half = begin + (end - begin) / 2;
      std::nth_element(first, order.begin() + half, last, [&](std::uint32_t a, std::uint32_t b) {
        const double x = centres[a][axis], y = centres[b][axis];
        return x < y || (x == y && a < b);
      });
      return half;
    };
    const double scale = bins / length;
    if (depth >= halving_depth || !std::isfinite(scale)) return end - begin <= leaf_faces ? begin : halve();

    struct Bin {
      Bounds box;
      std::uint32_t count = 0;
    };
    std::array<Bin, bins> bin;
    const auto bin_of = [&](std::uint32_t f) {
      return std::min(bins - 1, int((centres[f][axis] - middle.low[axis]) * scale));
    };
    for (std::uint32_t i = begin; i < end; ++i) {
      Bin& b = bin[std::size_t(bin_of(order[i]))];
      b.box.add(bounds[order[i]]);
      ++b.count;
    }
    std::array<double, bins> right{}; // cost of the bins from k on
    Bounds sweep;
    std::uint32_t count = 0;
    for (int k = bins - 1; k > 0; --k) {
      sweep.add(bin[std::size_t(k)].box);
      count += bin[std::size_t(k)].count;
      right[std::size_t(k)] = count ? count * sweep.half_area() : 0;
    }
    sweep = {};
    count = 0;
    int best = 0;
    double cost = infinity;
    for (int k = 1; k < bins; ++k) {
      sweep.add(bin[std::size_t(k - 1)].box);
      count += bin[std::size_t(k - 1)].count;
      const double here = (count ? count * sweep.half_area() : 0) + right[std::size_t(k)];
      if (count && count < end - begin && here < cost) cost = here, best = k;
    }
    // A step through a node costs as much as a triangle.
    const double total = box.half_area();
    if (end - begin <= leaf_faces && (best == 0 || cost + total >= (end - begin) * total)) return begin;
    if (best == 0) return halve();
    const auto cut = std::partition(first, last, [&](std::uint32_t f) { return bin_of(f) < best; });
    return std::uint32_t(cut - order.begin());
  }

  void build(std::uint32_t begin, std::uint32_t end, int depth) {
    const std::size_t at = tree.nodes_.size();
    tree.nodes_.emplace_back();
    Bounds box;
    for (std::uint32_t i = begin; i < end; ++i) box.add(bounds[order[i]]);
    tree.nodes_[at].low = box.low;
    tree.nodes_[at].high = box.high;
    const std::uint32_t cut = end - begin > 1 ? split(begin, end, box, depth) : begin;
    if (cut == begin) {
      tree.nodes_[at].first = begin;
      tree.nodes_[at].count = end - begin;
      return;
    }
    build(begin, cut, depth + 1);
    tree.nodes_[at].first = std::uint32_t(tree.nodes_.size());
    build(cut, end, depth + 1);
  }
};

Bvh::Bvh(std::span<const Vec3> vertices, std::span<const Face> faces) : faces_(faces.size()) {
  if (faces.empty()) return;
  std::iota(faces_.begin(), faces_.end(), 0U);
  Builder builder{*this, std::vector<Builder::Bounds>(faces.size()), std::vector<Vec3>(faces.size())};
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (const std::uint32_t v : faces[f]) builder.bounds[f].add(vertices[v]);
    builder.centres[f] = builder.bounds[f].low / 2 + builder.bounds[f].high / 2;
  }
  nodes_.reserve(faces.size());
  builder.build(0, std::uint32_t(faces.size()), 0);
  triangles_.reserve(faces.size());
  for (const std::uint32_t f : faces_) {
    const Vec3& a = vertices[faces[f][0]];
    triangles_.push_back({a, vertices[faces[f][1]] - a, vertices[faces[f][2]] - a});
  }
}

bool Bvh::first_hit(const Ray& ray, RayHit& hit) const {
  if (nodes_.empty()) return false;
  double limit = ray.limit;
  bool found = false;
  double inverse[3], origin[3];
  bool parallel[3]; // to a box's sides: no quotient says where the ray is between them
  for (int c = 0; c < 3; ++c) {
    parallel[c] = std::abs(ray.direction[c]) < 1e-100;
    inverse[c] = parallel[c] ? 0 : 1 / ray.direction[c];
    origin[c] = ray.origin[c];
  }
  // Entry into a box; infinite if it is missed. The margin covers the rounding of both ends (Ize, JCGT 2 (2013) 12).
  const auto entry = [&](const Node& node) {
    double near = 0, far = limit;
    for (int c = 0; c < 3; ++c) {
      if (parallel[c]) {
        if (origin[c] < node.low[c] || origin[c] > node.high[c]) return infinity;
        continue;
      }
      const double t1 = (node.low[c] - origin[c]) * inverse[c], t2 = (node.high[c] - origin[c]) * inverse[c];
      near = std::max(near, std::min(t1, t2));
      far = std::min(far, std::max(t1, t2) * (1 + 8e-16));
    }
    return near <= far ? near : infinity;
  };
  struct Waiting {
    std::uint32_t node;
    double near;
  };
  Waiting stack[deepest + 1];
  int waiting = 0;
  std::uint32_t at = 0;
  if (entry(nodes_[0]) == infinity) return false;
  for (;;) {
    const Node& node = nodes_[at];
    if (node.count) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const Triangle& triangle = triangles_[i];
        // Moeller and Trumbore, Journal of Graphics Tools 2 (1997) 21.
        const Vec3 p = ray.direction.cross(triangle.ac);
        const double det = triangle.ab.dot(p);
        if (det == 0) continue;
        const double scale = 1 / det;
        const Vec3 s = ray.origin - triangle.a;
        const double u = s.dot(p) * scale;
        if (!(u >= -edge_margin && u <= 1 + edge_margin)) continue;
        const Vec3 q = s.cross(triangle.ab);
        const double v = ray.direction.dot(q) * scale;
        if (!(v >= -edge_margin && u + v <= 1 + edge_margin)) continue;
        const double t = triangle.ac.dot(q) * scale;
        if (!(t >= 0 && t <= limit) || (found && t == limit && faces_[i] > hit.face)) continue;
        limit = t;
        hit = {faces_[i], t, u, v};
        found = true;
      }
    } else {
      std::uint32_t near = at + 1, far = node.first;
      double near_t = entry(nodes_[near]), far_t = entry(nodes_[far]);
      if (far_t < near_t) {
        std::swap(near, far);
        std::swap(near_t, far_t);
      }
      if (far_t < infinity) stack[waiting++] = {far, far_t};
      if (near_t < infinity) {
        at = near;
        continue;
      }
    }
    do {
      if (waiting == 0) return found;
      --waiting;
    } while (stack[waiting].near > limit);
    at = stack[waiting].node;
  }
}

ClosestPoint Bvh::closest(const Vec3& point, double below) const {
  ClosestPoint best;
  if (nodes_.empty()) return best;
  double limit = below;
  struct Waiting {
    std::uint32_t node;
    double distance2;
  };
  Waiting stack[deepest + 1];
  int waiting = 0;
  std::uint32_t at = 0;
  if (!(box_distance2(nodes_[0].low, nodes_[0].high, point) < below)) return best;
  for (;;) {
    const Node& node = nodes_[at];
    if (node.count) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const Vec3 q = closest_on_triangle(point, triangles_[i].a, triangles_[i].ab, triangles_[i].ac);
        const double d2 = (q - point).squaredNorm();
        if (d2 < limit || (d2 == best.distance2 && faces_[i] < best.face)) {
          best = {faces_[i], q, d2};
          limit = d2;
        }
      }
    } else {
      std::uint32_t near = at + 1, far = node.first;
      double near_d = box_distance2(nodes_[near].low, nodes_[near].high, point);
      double far_d = box_distance2(nodes_[far].low, nodes_[far].high, point);
      if (far_d < near_d) {
        std::swap(near, far);
        std::swap(near_d, far_d);
      }
      if (far_d <= limit) stack[waiting++] = {far, far_d};
      if (near_d <= limit) {
        at = near;
        continue;
      }
    }
    do {
      if (waiting == 0) return best;
      --waiting;
    } while (stack[waiting].distance2 > limit);
    at = stack[waiting].node;
  }
}

} // namespace cowgpu

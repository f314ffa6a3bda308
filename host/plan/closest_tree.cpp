#include "host/plan/closest_tree.hpp"

#include "host/error.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace cowgpu::plan {
namespace {

constexpr float nowhere = 3e18F; // squares of it stay finite, and exceed every bound
constexpr std::uint32_t width = closest_width;
constexpr std::uint32_t swept = 4096; // faces up to which every split is tried
constexpr std::size_t bins = 32;

// In the tree's units, rounded outwards.
struct Bounds {
  std::array<float, 3> low{nowhere, nowhere, nowhere}, high{-nowhere, -nowhere, -nowhere};
  void add(const Bounds& b) {
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], b.low[c]);
      high[c] = std::max(high[c], b.high[c]);
    }
  }
  double half_area() const {
    const double x = double(high[0]) - low[0], y = double(high[1]) - low[1], z = double(high[2]) - low[2];
    return x * y + y * z + z * x;
  }
};

double inverse(double squared) {
  return squared > 1e-290 ? 1 / squared : 0;
}

Vec3 any_perpendicular(const Vec3& u) {
  int axis = 0;
  (void)u.cwiseAbs().minCoeff(&axis);
  return u.cross(Vec3::Unit(axis)).normalized();
}

// The longest side of the box is about 1, so that nothing over- or underflows that matters.
TriangleFrame<double> frame_of(const std::array<Vec3, 3>& corners) {
  TriangleFrame<double> t{};
  double longest = -1;
  for (std::uint32_t k = 0; k < 3; ++k)
    if (const double l = (corners[(k + 1) % 3] - corners[k]).stableNorm(); l > longest) longest = l, t.corner = k;
  const Vec3 &a = corners[t.corner], ab = corners[(t.corner + 1) % 3] - a, ac = corners[(t.corner + 2) % 3] - a;
  const Vec3 u = longest > 0 ? Vec3(ab / longest) : Vec3(Vec3::UnitX());
  // Twice, so that v is perpendicular to u however thin the triangle is.
  Vec3 v = ac - ac.dot(u) * u;
  double height = v.stableNorm();
  v = height > 0 ? Vec3(v / height) : any_perpendicular(u);
  v -= v.dot(u) * u;
  v = v.norm() > 0.5 ? Vec3(v.normalized()) : any_perpendicular(u);
  const Vec3 n = u.cross(v).normalized();
  for (int c = 0; c < 3; ++c) t.a[c] = a[c], t.u[c] = u[c], t.v[c] = v[c], t.n[c] = n[c];
  t.length = longest;
  t.cx = std::clamp(ac.dot(u), 0.0, longest);
  t.cy = std::max(ac.dot(v), 0.0);
  t.ex = t.cx - t.length;
  t.ey = t.cy;
  t.c_inverse = inverse(t.cx * t.cx + t.cy * t.cy);
  t.e_inverse = inverse(t.ex * t.ex + t.ey * t.ey);
  return t;
}

float single_inverse(float x, float y) {
  const float squared = x * x + y * y;
  return squared > 1e-30F ? 1 / squared : 0;
}

TriangleFrame<float> single_frame(const TriangleFrame<double>& d, const Vec3& centre, double scale) {
  TriangleFrame<float> s{};
  const Vec3 a = (Vec3(d.a[0], d.a[1], d.a[2]) - centre) * scale;
  const auto along = [&](const double* w) { return float(a.dot(Vec3(w[0], w[1], w[2]))); };
  s.a[0] = along(d.u), s.a[1] = along(d.v), s.a[2] = along(d.n);
  for (int c = 0; c < 3; ++c) s.u[c] = float(d.u[c]), s.v[c] = float(d.v[c]), s.n[c] = float(d.n[c]);
  s.length = float(d.length * scale);
  s.cx = float(d.cx * scale), s.cy = float(d.cy * scale);
  s.ex = float(d.ex * scale), s.ey = float(d.ey * scale);
  s.c_inverse = single_inverse(s.cx, s.cy);
  s.e_inverse = single_inverse(s.ex, s.ey);
  s.corner = d.corner;
  return s;
}

class Builder {
public:
  explicit Builder(ClosestTree& tree) : tree_(tree), order_(tree.faces.size()), bounds_(order_.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    for (std::size_t f = 0; f < order_.size(); ++f)
      for (const std::uint32_t v : tree.faces[f]) {
        const auto p = tree.local(tree.vertices[v]);
        Bounds corner;
        for (std::size_t c = 0; c < 3; ++c) {
          corner.low[c] = std::nextafter(p[c], -nowhere);
          corner.high[c] = std::nextafter(p[c], nowhere);
        }
        bounds_[f].add(corner);
      }
  }

  void build() {
    if (order_.size() <= width) {
      tree_.nodes.push_back(empty_node());
      set_child(0, 0, {0, std::uint32_t(order_.size())});
    } else {
      node({0, std::uint32_t(order_.size())});
    }
  }

private:
  struct Range {
    std::uint32_t begin, end;
    std::uint32_t size() const { return end - begin; }
  };

  static ClosestNode empty_node() {
    ClosestNode node;
    for (auto* boxes : {node.boxes.low, node.boxes.high})
      for (int c = 0; c < 3; ++c) std::fill_n(boxes[c], width, nowhere);
    std::fill_n(node.child, width, 0);
    return node;
  }

  Bounds box(Range r) const {
    Bounds b;
    for (std::uint32_t i = r.begin; i < r.end; ++i) b.add(bounds_[order_[i]]);
    return b;
  }
  // Twice the middle.
  float middle(std::uint32_t face, std::size_t axis) const {
    return bounds_[face].low[axis] + bounds_[face].high[axis];
  }
  auto before(std::size_t axis) const {
    return [this, axis](std::uint32_t f, std::uint32_t g) {
      const float x = middle(f, axis), y = middle(g, axis);
      return x < y || (x == y && f < g);
    };
  }

  // Neither part is less than a quarter, which bounds the depth.
  static bool balanced(std::uint32_t part, std::uint32_t all) {
    return all <= 2 * width || (part >= all / 4 && part <= all - all / 4);
  }

  // Parts are multiples of a leaf, tried along all axes.
  std::uint32_t sweep(Range r) {
    const auto first = order_.begin() + r.begin, last = order_.begin() + r.end;
    std::vector<double> right(r.size() + 1);
    double least = std::numeric_limits<double>::infinity();
    std::size_t best_axis = 0;
    std::uint32_t cut = r.begin + std::max(width, r.size() / 2 / width * width);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::sort(first, last, before(axis));
      Bounds all;
      for (std::uint32_t i = r.size(); i-- > 0;) {
        all.add(bounds_[order_[r.begin + i]]);
        right[i] = all.half_area();
      }
      all = {};
      for (std::uint32_t i = 1; i < r.size(); ++i) {
        all.add(bounds_[order_[r.begin + i - 1]]);
        if (i % width || !balanced(i, r.size())) continue;
        const double cost = i * all.half_area() + (r.size() - i) * right[i];
        if (cost < least) least = cost, best_axis = axis, cut = r.begin + i;
      }
    }
    if (best_axis != 2) std::sort(first, last, before(best_axis));
    return cut;
  }

  std::uint32_t binned(Range r) {
    Bounds middles;
    for (std::uint32_t i = r.begin; i < r.end; ++i) {
      Bounds m;
      for (std::size_t c = 0; c < 3; ++c) m.low[c] = m.high[c] = middle(order_[i], c);
      middles.add(m);
    }
    const auto first = order_.begin() + r.begin, last = order_.begin() + r.end;
    double least = std::numeric_limits<double>::infinity();
    std::size_t best_axis = 0, best_bin = 0, longest = 0;
    const auto bin_of = [&](std::uint32_t f, std::size_t axis) {
      const double from = middles.low[axis], length = double(middles.high[axis]) - from;
      return std::min(bins - 1, std::size_t((middle(f, axis) - from) / length * bins));
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (middles.high[axis] - middles.low[axis] > middles.high[longest] - middles.low[longest]) longest = axis;
      if (!(middles.high[axis] > middles.low[axis])) continue;
      std::array<Bounds, bins> boxes;
      std::array<std::uint32_t, bins> counts{};
      for (std::uint32_t i = r.begin; i < r.end; ++i) {
        const std::size_t b = bin_of(order_[i], axis);
        boxes[b].add(bounds_[order_[i]]);
        ++counts[b];
      }
      std::array<double, bins> right{};
      Bounds all;
      for (std::size_t b = bins; b-- > 1;) {
        all.add(boxes[b]);
        right[b] = all.half_area();
      }
      all = {};
      std::uint32_t count = 0;
      for (std::size_t b = 1; b < bins; ++b) {
        all.add(boxes[b - 1]);
        count += counts[b - 1];
        if (!balanced(count, r.size())) continue;
        const double cost = count * all.half_area() + (r.size() - count) * right[b];
        if (cost < least) least = cost, best_axis = axis, best_bin = b;
      }
    }
    if (least < std::numeric_limits<double>::infinity())
      return std::uint32_t(
          std::partition(first, last, [&](std::uint32_t f) { return bin_of(f, best_axis) < best_bin; }) -
          order_.begin());
    const std::uint32_t half = r.begin + r.size() / 2;
    std::nth_element(first, order_.begin() + half, last, before(longest));
    return half;
  }

  void node(Range all) {
    // The costliest part is split until there are sixteen.
    std::vector<Range> parts{all};
    std::vector<double> costs{1};
    const auto cost = [&](Range r) { return r.size() > width ? box(r).half_area() * r.size() : -1; };
    while (parts.size() < width) {
      const auto most = std::size_t(std::max_element(costs.begin(), costs.end()) - costs.begin());
      const Range r = parts[most];
      if (r.size() <= width) break;
      const std::uint32_t cut = r.size() <= swept ? sweep(r) : binned(r);
      parts[most] = {r.begin, cut};
      parts.push_back({cut, r.end});
      costs[most] = cost(parts[most]);
      costs.push_back(cost(parts.back()));
    }
    const std::size_t at = tree_.nodes.size();
    tree_.nodes.push_back(empty_node());
    for (std::size_t j = 0; j < parts.size(); ++j) set_child(at, j, parts[j]);
  }

  void set_child(std::size_t at, std::size_t slot, Range r) {
    const Bounds b = box(r);
    for (std::size_t c = 0; c < 3; ++c) {
      tree_.nodes[at].boxes.low[c][slot] = b.low[c];
      tree_.nodes[at].boxes.high[c][slot] = b.high[c];
    }
    if (r.size() <= width) {
      tree_.nodes[at].child[slot] = ~std::int32_t(tree_.leaves.size());
      leaf(r);
    } else {
      tree_.nodes[at].child[slot] = std::int32_t(tree_.nodes.size());
      node(r);
    }
  }

  void leaf(Range r) {
    ClosestLeaf leaf{};
    for (std::uint32_t j = 0; j < width; ++j) {
      const bool used = j < r.size();
      const std::uint32_t face = order_[used ? r.begin + j : r.begin];
      const auto& corners = tree_.faces[face];
      TriangleFrame<double> frame =
          frame_of({tree_.vertices[corners[0]], tree_.vertices[corners[1]], tree_.vertices[corners[2]]});
      TriangleFrame<float> single = single_frame(frame, tree_.centre, tree_.scale);
      if (!used) single.a[2] = -nowhere;
      const float* numbers = single.a;
      for (std::size_t k = 0; k < frame_numbers; ++k) leaf.frame[k][j] = numbers[k];
      for (std::size_t c = 0; c < 3; ++c) {
        leaf.boxes.low[c][j] = used ? bounds_[face].low[c] : nowhere;
        leaf.boxes.high[c][j] = used ? bounds_[face].high[c] : nowhere;
      }
      if (used) tree_.slot_of_face[face] = std::uint32_t(tree_.frames.size());
      tree_.face_of_slot.push_back(used ? face : no_face);
      tree_.frames.push_back(frame);
      tree_.single_frames.push_back(single);
    }
    tree_.leaves.push_back(leaf);
  }

  ClosestTree& tree_;
  std::vector<std::uint32_t> order_;
  std::vector<Bounds> bounds_;
};

static_assert(sizeof(TriangleFrame<float>) == (frame_numbers + 1) * sizeof(float));

struct EdgeUse {
  std::uint32_t low, high, face, corner;
  bool forward;
};

// The least face of every vertex and edge; and whether the edges are balanced.
void set_least_faces(ClosestTree& tree) {
  tree.face_of_vertex.assign(tree.vertices.size(), no_face);
  tree.face_of_edge.resize(tree.faces.size());
  std::vector<EdgeUse> uses;
  uses.reserve(3 * tree.faces.size());
  for (std::uint32_t f = 0; f < tree.faces.size(); ++f)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = tree.faces[f][k], to = tree.faces[f][(k + 1) % 3];
      tree.face_of_vertex[from] = std::min(tree.face_of_vertex[from], f);
      uses.push_back({std::min(from, to), std::max(from, to), f, k, from < to});
    }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.low, a.high, a.face, a.corner) < std::tie(b.low, b.high, b.face, b.corner);
  });
  tree.closed = true;
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    std::ptrdiff_t balance = 0;
    for (; end < uses.size() && uses[end].low == uses[begin].low && uses[end].high == uses[begin].high; ++end) {
      tree.face_of_edge[uses[end].face][uses[end].corner] = uses[begin].face;
      balance += uses[end].forward ? 1 : -1;
    }
    if (balance != 0 && uses[begin].low != uses[begin].high) tree.closed = false;
  }
}

} // namespace

ClosestTree::ClosestTree(std::span<const Vec3> mesh_vertices, std::span<const Face> mesh_faces)
    : vertices(mesh_vertices.begin(), mesh_vertices.end()), faces(mesh_faces.begin(), mesh_faces.end()) {
  check_distance_surface(mesh_vertices, mesh_faces);
  if (faces.size() > (std::size_t(1) << 30))
    throw Error(Fault::too_large,
                fmt::format("the surface has {} faces; distances can be measured from up to 2^30", faces.size()));
  low = high = vertices[faces[0][0]];
  for (const Face& face : faces)
    for (const std::uint32_t v : face) {
      low = low.cwiseMin(vertices[v]);
      high = high.cwiseMax(vertices[v]);
    }
  size = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  centre = low / 2 + high / 2;
  const double half = (high / 2 - low / 2).maxCoeff();
  scale = half > 0 ? 1 / half : 1;
  slot_of_face.resize(faces.size());
  Builder(*this).build();
  set_least_faces(*this);
}

std::uint64_t ClosestTree::bytes(std::uint64_t face_count, std::uint64_t vertex_count) {
  // Leaves are at least half full but for one in a node; while building, 24 bytes a side and 28 a face are in use.
  const std::uint64_t leaf_count = 2 * (face_count / width + 1);
  const std::uint64_t slot = sizeof(TriangleFrame<float>) + sizeof(TriangleFrame<double>) + 4;
  return 28 * vertex_count + 140 * face_count +
         leaf_count * (sizeof(ClosestLeaf) + width * slot + sizeof(ClosestNode) / 4);
}

SurfacePoint ClosestTree::on_face(std::uint32_t face, const Vec3& p) const {
  const TriangleFrame<double>& t = frames[slot_of_face[face]];
  const auto dot = [](const double* w, const Vec3& r) { return w[0] * r.x() + w[1] * r.y() + w[2] * r.z(); };
  const Vec3 a(t.a[0], t.a[1], t.a[2]), r = p - a;
  const double x = dot(t.u, r), y = dot(t.v, r), z = dot(t.n, r);
  const std::uint32_t corner[3] = {t.corner, (t.corner + 1) % 3, (t.corner + 2) % 3};

  // What rounding cannot tell from an edge or a vertex counts as one, so that neighbours agree.
  const double rounding = 1e-16 * (t.length + std::abs(x) + std::abs(y) + std::abs(z));
  SurfacePoint result;
  if (y > rounding && t.cy * x - t.cx * y > rounding * (t.cx + t.cy) &&
      t.ex * y - t.ey * (x - t.length) > rounding * (t.ey - t.ex)) {
    const double wc = std::min(1.0, y / t.cy), wb = std::clamp((x - wc * t.cx) / t.length, 0.0, 1.0 - wc);
    result.barycentric[int(corner[0])] = std::max(0.0, 1 - wb - wc);
    result.barycentric[int(corner[1])] = wb;
    result.barycentric[int(corner[2])] = wc;
    result.face = face;
    result.feature = {SurfaceFeature::Kind::face, face, face};
    result.point = a + x * Vec3(t.u[0], t.u[1], t.u[2]) + y * Vec3(t.v[0], t.v[1], t.v[2]);
    result.distance = std::abs(z);
    return result;
  }
  // The nearest of the edges ab, bc, ca: `s` runs from 0 to 1 along it.
  double s = t.length > 0 ? std::clamp(x / t.length, 0.0, 1.0) : 0;
  const double along = std::clamp(x, 0.0, t.length);
  double least = (x - along) * (x - along) + y * y;
  std::uint32_t edge = 0;
  const double sc = std::clamp((x * t.cx + y * t.cy) * t.c_inverse, 0.0, 1.0);
  const double c2 = (x - sc * t.cx) * (x - sc * t.cx) + (y - sc * t.cy) * (y - sc * t.cy);
  if (c2 < least) least = c2, edge = 2, s = 1 - sc;
  const double xb = x - t.length, se = std::clamp((xb * t.ex + y * t.ey) * t.e_inverse, 0.0, 1.0);
  const double e2 = (xb - se * t.ex) * (xb - se * t.ex) + (y - se * t.ey) * (y - se * t.ey);
  if (e2 < least) least = e2, edge = 1, s = se;

  const double edge_length =
      edge == 0 ? t.length : std::sqrt(edge == 1 ? t.ex * t.ex + t.ey * t.ey : t.cx * t.cx + t.cy * t.cy);
  const std::uint32_t from = corner[edge], to = corner[(edge + 1) % 3];
  const std::uint32_t v = faces[face][from], w = faces[face][to];
  const auto at_vertex = [&](std::uint32_t vertex) {
    result.feature = {SurfaceFeature::Kind::vertex, vertex, vertex};
    result.face = face_of_vertex[vertex];
    result.point = vertices[vertex];
    const Face& f = faces[result.face];
    result.barycentric[int(std::find(f.begin(), f.end(), vertex) - f.begin())] = 1;
    result.distance = (p - result.point).norm();
  };
  if (s * edge_length <= rounding || v == w) {
    at_vertex(v);
  } else if ((1 - s) * edge_length <= rounding) {
    at_vertex(w);
  } else {
    result.feature = {SurfaceFeature::Kind::edge, std::min(v, w), std::max(v, w)};
    result.face = face_of_edge[face][from];
    result.point = vertices[v] + s * (vertices[w] - vertices[v]);
    const Face& f = faces[result.face];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t here = f[std::size_t(k)], next = f[std::size_t(k + 1) % 3];
      if ((here == v && next == w) || (here == w && next == v)) {
        result.barycentric[k] = here == v ? 1 - s : s;
        result.barycentric[(k + 1) % 3] = here == v ? s : 1 - s;
        break;
      }
    }
    result.distance = std::sqrt(least + z * z);
  }
  return result;
}

} // namespace cowgpu::plan

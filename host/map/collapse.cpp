#include "host/map/collapse.hpp"

#include "host/error.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace cowgpu {

bool VertexRings::adjacent(std::uint32_t a, std::uint32_t b) const {
  if (rings_[a].size() > rings_[b].size()) std::swap(a, b);
  return std::find(rings_[a].begin(), rings_[a].end(), b) != rings_[a].end();
}

bool VertexRings::link_condition(std::uint32_t v, std::uint32_t u) const {
  if (rings_[v].size() > rings_[u].size()) std::swap(v, u);
  int common = 0;
  for (const std::uint32_t x : rings_[v])
    if (x != u && adjacent(x, u)) ++common;
  return common == 2;
}

Collapse VertexRings::collapse(std::uint32_t v, std::uint32_t u) {
  Collapse step{v, std::move(rings_[v])};
  rings_[v].clear();
  auto& ring = step.ring;
  std::rotate(ring.begin(), std::find(ring.begin(), ring.end(), u), ring.end());
  const std::size_t k = ring.size();
  for (std::size_t i = 1; i < k; ++i) {
    auto& other = rings_[ring[i]];
    const auto at = std::find(other.begin(), other.end(), v);
    if (i == 1 || i + 1 == k)
      other.erase(at);
    else
      *at = u;
  }
  auto& centre = rings_[u]; // ... ring[1], v, ring[k-1] ...
  const auto at = std::find(centre.begin(), centre.end(), v);
  if (k == 3)
    centre.erase(at);
  else {
    *at = ring[2];
    centre.insert(at + 1, ring.begin() + 3, ring.end() - 1);
  }
  return step;
}

void VertexRings::undo(Collapse&& step) {
  const std::uint32_t v = step.vertex, u = step.ring[0];
  const auto& ring = step.ring;
  const std::size_t k = ring.size();
  auto& centre = rings_[u];
  std::rotate(centre.begin(), std::find(centre.begin(), centre.end(), ring[1]), centre.end());
  if (k == 3)
    centre.insert(centre.begin() + 1, v);
  else {
    centre[1] = v;
    centre.erase(centre.begin() + 2, centre.begin() + std::ptrdiff_t(k - 2));
  }
  for (std::size_t i = 1; i < k; ++i) {
    auto& other = rings_[ring[i]];
    const auto at = std::find(other.begin(), other.end(), u);
    if (i == 1)
      other.insert(at, v);
    else if (i + 1 == k)
      other.insert(at + 1, v);
    else
      *at = v;
  }
  rings_[v] = std::move(step.ring);
}

namespace {

// Squared distances from planes, weighted and summed: area p.p term by term about the vertex's own position, where
// nothing cancels.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0; // sum of w n n^T
  Vec3 linear = Vec3::Zero();                            // sum of w n (n . (own - plane))
  double constant = 0;

  Vec3 times(const Vec3& d) const {
    return {xx * d[0] + xy * d[1] + xz * d[2], xy * d[0] + yy * d[1] + yz * d[2], xz * d[0] + yz * d[1] + zz * d[2]};
  }
  void add_plane(double w, const Vec3& n) {
    xx += w * n[0] * n[0], xy += w * n[0] * n[1], xz += w * n[0] * n[2];
    yy += w * n[1] * n[1], yz += w * n[1] * n[2], zz += w * n[2] * n[2];
  }
  double at(const Vec3& d) const { return constant + d.dot(times(d) + 2 * linear); }
  void add_moved(const Quadric& q, const Vec3& d) { // q's own position plus d is this one's
    xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz;
    linear += q.linear + q.times(d);
    constant += q.at(d);
  }
};

class Simplifier {
public:
  Simplifier(VertexRings& rings, std::span<const Vec3> points) : rings_(rings), points_(points) {
    for (std::uint32_t v = 0; v < rings.size(); ++v)
      if (!rings.of(v).empty()) ++left_;
    quadrics_.resize(rings.size());
    for (std::uint32_t v = 0; v < rings.size(); ++v) {
      const auto ring = rings.of(v);
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vec3 normal = (points[ring[i]] - points[v]).cross(points[ring[(i + 1) % ring.size()]] - points[v]);
        const double twice = normal.norm();
        if (twice > 0) quadrics_[v].add_plane(twice, normal / twice);
      }
    }
  }

  std::vector<Collapse> run() {
    for (const std::size_t most : {largest_ring, rings_.size()}) {
      if (left_ == 4) break;
      largest_ = most;
      version_.assign(rings_.size(), 0);
      queue_ = {};
      for (std::uint32_t v = 0; v < rings_.size(); ++v)
        if (!rings_.of(v).empty()) push(v);
      while (left_ > 4 && !queue_.empty()) take();
    }
    if (left_ != 4)
      throw Error(Fault::map_failed,
                  "the surface could not be simplified to a tetrahedron: it is not a triangulated sphere, "
                  "perhaps because two edges join the same vertices. Use another method of mapping");
    return std::move(steps_);
  }

private:
  // Vertices with more neighbours are removed only if nothing else is left: looking at all their collapses takes long.
  static constexpr std::size_t largest_ring = 24;

  struct Candidate {
    float cost;
    std::uint32_t vertex, target, version;
    bool operator<(const Candidate& other) const { // the top of the queue is the largest
      return cost != other.cost ? cost > other.cost : vertex > other.vertex;
    }
  };

  // Of v -> u; v's ring is `ring` with u at `at`. Infinite once it is no less than `limit`.
  double cost(std::uint32_t v, std::uint32_t u, std::span<const std::uint32_t> ring, std::size_t at,
              double limit) const {
    const Vec3 d = points_[u] - points_[v];
    const double k = double(ring.size()), square = d.squaredNorm(), size = square * square;
    const double excess = std::max(0.0, double(rings_.of(u).size()) + k - 13);
    const double base = std::max(0.0, quadrics_[v].at(d)) + (k > 10 ? 1e-2 * size * k : 0);
    const double scale = 1e-3 * size * (1 + excess * excess);
    double shape = 1; // 1 for equilateral triangles
    for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
      if (base + scale * (1 + 0.1 * shape) >= limit) return std::numeric_limits<double>::infinity();
      const Vec3 a = points_[ring[(at + i) % ring.size()]] - points_[u];
      const Vec3 b = points_[ring[(at + i + 1) % ring.size()]] - points_[u];
      const double edges = a.squaredNorm() + b.squaredNorm() + (a - b).squaredNorm();
      const double ratio = edges / (2 * std::sqrt(3.0) * a.cross(b).norm() + 1e-12 * edges);
      shape = std::max(shape, std::min(ratio, 1e4));
    }
    return base + scale * (1 + 0.1 * shape);
  }

  void push(std::uint32_t v) {
    ++version_[v];
    const auto ring = rings_.of(v);
    if (ring.size() > largest_) return;
    double least = std::numeric_limits<double>::infinity();
    std::uint32_t target = v;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      // Only what single precision tells apart counts as less.
      const double c = cost(v, ring[i], ring, i, least * (1 + 1e-6));
      if ((target == v || float(c) < float(least) || (float(c) == float(least) && ring[i] < target)) &&
          rings_.link_condition(v, ring[i])) {
        least = c;
        target = ring[i];
      }
    }
    if (target != v) queue_.push({float(least), v, target, version_[v]});
  }

  void take() {
    const Candidate next = queue_.top();
    queue_.pop();
    if (next.version != version_[next.vertex]) return;
    if (!rings_.link_condition(next.vertex, next.target)) { // broken by a collapse farther away
      push(next.vertex);
      return;
    }
    ++version_[next.vertex];
    steps_.push_back(rings_.collapse(next.vertex, next.target));
    quadrics_[next.target].add_moved(quadrics_[next.vertex], points_[next.target] - points_[next.vertex]);
    --left_;
    for (const std::uint32_t u : steps_.back().ring) push(u);
  }

  VertexRings& rings_;
  std::span<const Vec3> points_;
  std::size_t left_ = 0, largest_ = largest_ring;
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> version_;
  std::priority_queue<Candidate> queue_;
  std::vector<Collapse> steps_;
};

} // namespace

std::vector<Collapse> collapse_to_tetrahedron(VertexRings& rings, std::span<const Vec3> points) {
  return Simplifier(rings, points).run();
}

} // namespace cowgpu

#include "host/mesh/convex_hull.hpp"

#include "host/geometry/orientation.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

namespace cowgpu {
namespace {

using Index = std::uint32_t;

struct Facet {
  std::array<Index, 3> corners;
  std::array<Index, 3> across;  // the facet beyond the edge from corner i to corner i + 1
  std::vector<Index> outside{}; // points in front of it; each point is kept by one facet
  bool alive = true;
  std::uint32_t seen = 0; // the round in which it was found to be visible
};

class Hull {
public:
  explicit Hull(std::span<const Vec3> points) : points_(points) {}

  std::vector<Face> run() {
    const auto first = simplex();
    if (!first) return {};
    begin(*first);
    // Facets that are made are looked at later, at the end of the list.
    for (Index f = 0; f < facets_.size(); ++f)
      if (facets_[f].alive && !facets_[f].outside.empty()) add_point(f);
    std::vector<Face> faces;
    for (const Facet& facet : facets_)
      if (facet.alive) faces.push_back({facet.corners[0], facet.corners[1], facet.corners[2]});
    return faces;
  }

private:
  bool in_front(const std::array<Index, 3>& f, Index p) const {
    return side_of_plane(points_[f[0]], points_[f[1]], points_[f[2]], points_[p]) < 0;
  }

  bool on_one_line(Index a, Index b, Index c) const {
    for (int axis = 0; axis < 3; ++axis)
      if (orientation_along(axis, points_[a], points_[b], points_[c]) != 0) return false;
    return true;
  }

  // Four points that span a volume, the farthest of each kind where rounding can tell.
  std::optional<std::array<Index, 4>> simplex() const {
    if (points_.empty()) return std::nullopt;
    const auto farthest = [&](auto&& measure, auto&& allowed) -> std::optional<Index> {
      std::optional<Index> best;
      double most = -1;
      for (Index i = 0; i < points_.size(); ++i)
        if (const double m = measure(points_[i]); m > most && allowed(i)) {
          most = m;
          best = i;
        }
      return best;
    };
    const Index a = 0;
    const auto b = farthest([&](const Vec3& p) { return (p - points_[a]).norm(); },
                            [&](Index i) { return points_[i] != points_[a]; });
    if (!b) return std::nullopt;
    const Vec3 along = (points_[*b] - points_[a]).stableNormalized();
    const auto c = farthest([&](const Vec3& p) { return (p - points_[a]).cross(along).norm(); },
                            [&](Index i) { return !on_one_line(a, *b, i); });
    if (!c) return std::nullopt;
    const Vec3 normal = along.cross(points_[*c] - points_[a]).stableNormalized();
    const auto d =
        farthest([&](const Vec3& p) { return std::abs((p - points_[a]).dot(normal)); },
                 [&](Index i) { return side_of_plane(points_[a], points_[*b], points_[*c], points_[i]) != 0; });
    if (!d) return std::nullopt;
    if (in_front({a, *b, *c}, *d)) return std::array{a, *c, *b, *d};
    return std::array{a, *b, *c, *d};
  }

  // The corner d lies behind a, b, c.
  void begin(const std::array<Index, 4>& s) {
    const auto [a, b, c, d] = s;
    facets_ = {{{a, b, c}, {1, 2, 3}}, {{b, a, d}, {0, 3, 2}}, {{c, b, d}, {0, 1, 3}}, {{a, c, d}, {0, 2, 1}}};
    for (Index p = 0; p < points_.size(); ++p) keep(p, 0);
  }

  // Gives a point to the first facet from `from` on that it is in front of; one that is in front of none is inside.
  void keep(Index p, Index from) {
    for (Index f = from; f < facets_.size(); ++f)
      if (in_front(facets_[f].corners, p)) {
        facets_[f].outside.push_back(p);
        return;
      }
  }

  Index farthest_of(const Facet& facet) const {
    const Vec3& a = points_[facet.corners[0]];
    const Vec3 normal = (points_[facet.corners[1]] - a).cross(points_[facet.corners[2]] - a);
    return *std::max_element(facet.outside.begin(), facet.outside.end(), [&](Index p, Index q) {
      return (points_[p] - a).dot(normal) < (points_[q] - a).dot(normal);
    });
  }

  void add_point(Index start) {
    const Index p = farthest_of(facets_[start]);
    ++round_;
    // What the point sees is one region, whose border it sees as a simple loop.
    std::vector<Index> visible = {start};
    facets_[start].seen = round_;
    struct Edge {
      Index from, to, beyond;
    };
    std::vector<Edge> border;
    for (std::size_t i = 0; i < visible.size(); ++i) {
      const Facet facet = {facets_[visible[i]].corners, facets_[visible[i]].across};
      for (std::size_t e = 0; e < 3; ++e) {
        Facet& next = facets_[facet.across[e]];
        if (next.seen == round_) continue;
        if (in_front(next.corners, p)) {
          next.seen = round_;
          visible.push_back(facet.across[e]);
        } else {
          border.push_back({facet.corners[e], facet.corners[(e + 1) % 3], facet.across[e]});
        }
      }
    }
    const auto made = Index(facets_.size());
    begins_.resize(points_.size());
    for (std::size_t i = 0; i < border.size(); ++i) begins_[border[i].from] = Index(made + i);
    for (std::size_t i = 0; i < border.size(); ++i) {
      const auto [from, to, beyond] = border[i];
      Facet facet = {{from, to, p}, {beyond, begins_[to], 0}};
      Facet& neighbour = facets_[beyond];
      for (std::size_t e = 0; e < 3; ++e)
        if (neighbour.corners[e] == to && neighbour.corners[(e + 1) % 3] == from) neighbour.across[e] = Index(made + i);
      facets_.push_back(std::move(facet));
    }
    for (Index f = made; f < facets_.size(); ++f) facets_[facets_[f].across[1]].across[2] = f;
    for (const Index f : visible) {
      facets_[f].alive = false;
      for (const Index q : facets_[f].outside)
        if (q != p) keep(q, made);
      facets_[f].outside = {};
    }
  }

  std::span<const Vec3> points_;
  std::vector<Facet> facets_;
  std::vector<Index> begins_; // the new facet whose border edge begins at a point
  std::uint32_t round_ = 0;
};

} // namespace

std::vector<Face> convex_hull(std::span<const Vec3> points) {
  return Hull(points).run();
}

std::vector<double> normal_cone_solid_angles(std::span<const Vec3> points, std::span<const Face> hull) {
  std::vector<double> angles(points.size(), 0);
  for (const Face& face : hull)
    for (std::size_t c = 0; c < 3; ++c) {
      double& solid = angles[face[c]];
      if (solid == 0) solid = 2 * std::numbers::pi;
      const Vec3 a = points[face[(c + 1) % 3]] - points[face[c]], b = points[face[(c + 2) % 3]] - points[face[c]];
      solid -= std::atan2(a.cross(b).norm(), a.dot(b));
    }
  // A corner in the middle of a facet or an edge is left with rounding.
  for (double& solid : angles) solid = std::max(solid, 0.0);
  return angles;
}

} // namespace cowgpu

#include "host/flow/star_shape.hpp"

#include "host/error.hpp"
#include "host/geometry/orientation.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/triangle_surface.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace cowgpu {
namespace {

constexpr std::size_t regions_at_once = 1 << 16;
constexpr std::uint64_t most_regions = 20'000'000;

std::array<Vec3, 3> corners(const Vec3& a = Vec3::Zero()) {
  return {a, a, a};
}

/// A simplex of surface points times a simplex of normals: a face and its normal, an edge and an arc, a vertex and a
/// spherical triangle.
struct Region {
  std::array<Vec3, 3> points = corners(), normals = corners();
  int point_count = 1, normal_count = 1;
  std::uint32_t cone = 0; ///< directions along the surface: a normal looks away from all of them
};

struct Ball {
  Vec3 centre = Vec3::Zero();
  double radius = 0;
};

// The mean, and how far the simplex reaches from it.
Ball round_points(const Region& r) {
  Ball ball;
  for (int i = 0; i < r.point_count; ++i) ball.centre += r.points[std::size_t(i)] / r.point_count;
  for (int i = 0; i < r.point_count; ++i)
    ball.radius = std::max(ball.radius, (r.points[std::size_t(i)] - ball.centre).norm());
  return ball;
}

// A cap of the unit sphere: convex, so it holds all between its corners. The radius is a chord.
Ball round_normals(const Region& r) {
  Ball ball;
  for (int i = 0; i < r.normal_count; ++i) ball.centre += r.normals[std::size_t(i)];
  ball.centre.normalize();
  for (int i = 0; i < r.normal_count; ++i)
    ball.radius = std::max(ball.radius, (r.normals[std::size_t(i)] - ball.centre).norm());
  return ball;
}

// Cuts the longest edge of a simplex of `count` corners in its middle.
template <class Middle>
void cut(const std::array<Vec3, 3>& corners, int count, const Middle& middle, std::array<Vec3, 3>& one,
         std::array<Vec3, 3>& other) {
  int from = 0, to = 1;
  for (int i = 0; i < count; ++i)
    for (int j = i + 1; j < count; ++j)
      if ((corners[std::size_t(i)] - corners[std::size_t(j)]).squaredNorm() >
          (corners[std::size_t(from)] - corners[std::size_t(to)]).squaredNorm())
        from = i, to = j;
  const Vec3 between = middle(corners[std::size_t(from)], corners[std::size_t(to)]);
  one = other = corners;
  one[std::size_t(to)] = between;
  other[std::size_t(from)] = between;
}

// Whether the origin is behind the plane of every face, by exact signs.
bool sees_all(std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& origin) {
  return std::all_of(faces.begin(), faces.end(), [&](const Face& f) {
    return side_of_plane(vertices[f[0]], vertices[f[1]], vertices[f[2]], origin) > 0;
  });
}

class StarSearch {
public:
  StarSearch(std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& origin, double tolerance,
             Backend& backend, Monitor& monitor)
      : origin_(origin), tolerance_(tolerance), monitor_(monitor), field_(backend.distance_field(vertices, faces)) {
    Vec3 low = vertices[faces[0][0]], high = low;
    for (const Face& face : faces)
      for (const std::uint32_t v : face) low = low.cwiseMin(vertices[v]), high = high.cwiseMax(vertices[v]);
    diagonal_ = (high - low).norm();
    if (!(tolerance >= 1e-9 * diagonal_))
      throw Error(Fault::bad_argument,
                  fmt::format("a star-shape time to {} is beyond the rounding of distances: ask for "
                              "{} at least",
                              tolerance, 1e-9 * diagonal_));
    sees_all_ = sees_all(vertices, faces, origin);
    if (!sees_all_) seed(vertices, faces);
  }

  StarShapeTime run(double farthest) {
    if (sees_all_) {
      found_.upper = tolerance_;
      return found_;
    }
    const double finest = tolerance_;
    found_.upper = farthest;
    int tens = 0;
    while (finest * std::pow(10., tens + 1) < diagonal_ / 10) ++tens;
    for (; tens >= 0; --tens) {
      tolerance_ = finest * std::pow(10., tens);
      if (found_.upper <= found_.lower + tolerance_ && tens > 0) continue;
      if (!settle()) {
        found_.given_up = true;
        break;
      }
      found_.upper = found_.lower + tolerance_;
    }
    return found_;
  }

private:
  // Whether nothing is left above lower + tolerance.
  bool settle() {
    std::vector<Region> waiting = seeds_;
    while (!waiting.empty()) {
      // Depth first, in batches: what is found early rules out more.
      const std::size_t count = std::min(regions_at_once, waiting.size());
      std::vector<Region> now(waiting.end() - std::ptrdiff_t(count), waiting.end());
      waiting.resize(waiting.size() - count);
      check_stop(monitor_);
      found_.regions += count;
      if (found_.regions > most_regions) return false;
      look(now, waiting);
    }
    return true;
  }

  void seed(std::span<const Vec3> vertices, std::span<const Face> faces);
  void look(const std::vector<Region>& regions, std::vector<Region>& waiting);
  void raise(const std::vector<Region>& regions);
  double behind(const Vec3& q, const Vec3& n) const { return (origin_ - q).dot(n); }

  // Whether no normal of the region belongs to its cone, or none of it can beat the level.
  bool idle(const Region& r, const Ball& n, double level) const {
    for (const Vec3& along : cones_[r.cone])
      if (along.dot(n.centre) > n.radius + 1e-12) return true;
    // Largest (origin - q) . n over the cap: along an edge only the part across it counts.
    const double angle = 2 * std::asin(std::min(1.0, n.radius / 2));
    double most = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < r.point_count; ++i) {
      Vec3 w = origin_ - r.points[std::size_t(i)];
      if (r.point_count == 2) {
        const Vec3 along = (r.points[1] - r.points[0]).normalized();
        w -= w.dot(along) * along;
      }
      const double between = std::atan2(w.cross(n.centre).norm(), w.dot(n.centre));
      most = std::max(most, w.norm() * std::cos(std::max(0.0, between - angle)));
    }
    return most <= level;
  }

  const Vec3 origin_;
  double tolerance_;
  Monitor& monitor_;
  std::unique_ptr<DistanceField> field_;
  double diagonal_ = 0;
  bool sees_all_ = false; ///< the origin is behind every face
  std::vector<std::vector<Vec3>> cones_ = {{}};
  std::vector<Region> seeds_;
  StarShapeTime found_;
};

void StarSearch::seed(std::span<const Vec3> vertices, std::span<const Face> faces) {
  // Besides directions along the surface every cone has one into the body, against the angle-weighted normal: a normal looks
  // away from it too (Baerentzen and Aanaes, IEEE Trans. Vis. Comput. Graph. 11 (2005) 243).
  const std::vector<Vec3> outwards = vertex_normals(vertices, faces);
  std::map<std::array<std::uint32_t, 2>, std::vector<Vec3>> edges;
  std::map<std::array<std::uint32_t, 2>, Vec3> edge_normals;
  std::map<std::uint32_t, std::vector<Vec3>> fans;
  std::vector<Region> flat;
  for (const Face& face : faces) {
    const Vec3 normal =
        (vertices[face[1]] - vertices[face[0]]).cross(vertices[face[2]] - vertices[face[0]]).stableNormalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = face[k], b = face[(k + 1) % 3], c = face[(k + 2) % 3];
      const Vec3 along = (vertices[b] - vertices[a]).stableNormalized(), to_c = vertices[c] - vertices[a];
      edge_normals.try_emplace({std::min(a, b), std::max(a, b)}, Vec3::Zero()).first->second += normal;
      edges[{std::min(a, b), std::max(a, b)}].push_back((to_c - to_c.dot(along) * along).stableNormalized());
      fans[a].push_back(along);
      fans[b].push_back(-along);
    }
    if (normal.squaredNorm() == 0) continue; // its edges say it all
    flat.push_back({{vertices[face[0]], vertices[face[1]], vertices[face[2]]}, corners(normal), 3, 1, 0});
  }
  // Last in, first out: faces come first.
  for (auto& [vertex, cone] : fans) {
    cone.push_back(-outwards[vertex]);
    cones_.push_back(std::move(cone));
    for (int octant = 0; octant < 8; ++octant) {
      Region r{corners(vertices[vertex]), corners(), 1, 3, std::uint32_t(cones_.size() - 1)};
      for (int k = 0; k < 3; ++k) r.normals[std::size_t(k)] = (octant >> k & 1 ? -1 : 1) * Vec3::Unit(k);
      seeds_.push_back(r);
    }
  }
  for (auto& [ends, cone] : edges) {
    cone.push_back(-edge_normals.at(ends).stableNormalized());
    cones_.push_back(std::move(cone));
    const Vec3 along = (vertices[ends[1]] - vertices[ends[0]]).stableNormalized();
    if (along.squaredNorm() == 0) continue;
    const Vec3 u = along.unitOrthogonal(), v = along.cross(u), round[4] = {u, v, -u, -v};
    for (int k = 0; k < 4; ++k)
      seeds_.push_back({{vertices[ends[0]], vertices[ends[1]], Vec3::Zero()},
                        {round[k], round[(k + 1) % 4], Vec3::Zero()},
                        2,
                        2,
                        std::uint32_t(cones_.size() - 1)});
  }
  seeds_.insert(seeds_.end(), flat.begin(), flat.end());
}

void StarSearch::look(const std::vector<Region>& regions, std::vector<Region>& waiting) {
  const double level = found_.lower + tolerance_, rounding = 1e-12 * diagonal_;
  std::vector<const Region*> open;
  std::vector<Vec3> centres;
  for (const Region& r : regions) {
    const Ball q = round_points(r), n = round_normals(r);
    if (idle(r, n, level)) continue;
    open.push_back(&r);
    centres.push_back(q.centre + level * n.centre);
  }
  const ClosestPoints closest = field_->closest(centres, {}, monitor_);
  found_.queries += centres.size();
  std::vector<Region> left;
  std::vector<double> short_of; // by how much a ball of this size does not fit at the middle
  for (std::size_t i = 0; i < open.size(); ++i) {
    const Ball q = round_points(*open[i]), n = round_normals(*open[i]);
    const double distance = std::abs(closest.distance[i]), reach = q.radius + level * n.radius;
    if (distance + reach < level - rounding) continue;                    // no ball of this size fits
    if (distance > reach + rounding && closest.winding[i] != 0) continue; // it fits inside the body
    left.push_back(*open[i]);
    short_of.push_back(level - distance);
  }
  raise(left);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const Region& r = left[i];
    const Ball q = round_points(r), n = round_normals(r);
    Region one = r, other = r;
    // Cutting points can rule the rest out only if normals alone leave no room.
    const double turn = level * n.radius;
    const bool cut_normals = n.radius > 1e-10 && (short_of[i] <= turn || q.radius < turn);
    if (!cut_normals)
      cut(
          r.points, r.point_count, [](const Vec3& a, const Vec3& b) { return Vec3((a + b) / 2); }, one.points,
          other.points);
    else
      cut(
          r.normals, r.normal_count, [](const Vec3& a, const Vec3& b) { return Vec3((a + b).normalized()); },
          one.normals, other.normals);
    waiting.push_back(one);
    waiting.push_back(other);
  }
}

// The values at the regions' middles: the ball there shrinks from the size that would see the origin.
void StarSearch::raise(const std::vector<Region>& regions) {
  struct Try {
    Vec3 q, n;
    double radius;
  };
  std::vector<Try> tries, settled;
  for (const Region& r : regions) {
    Try t{round_points(r).centre, round_normals(r).centre, 0};
    t.radius = behind(t.q, t.n);
    const auto& cone = cones_[r.cone];
    const bool normal = std::all_of(cone.begin(), cone.end(), [&](const Vec3& along) { return along.dot(t.n) <= 0; });
    if (normal && t.radius > found_.lower) tries.push_back(t);
  }
  for (int round = 0; round < 60 && !tries.empty(); ++round) {
    std::vector<Vec3> centres;
    for (const Try& t : tries) centres.push_back(t.q + t.radius * t.n);
    const ClosestPoints closest = field_->closest(centres, {}, monitor_);
    found_.queries += centres.size();
    std::vector<Try> next;
    for (std::size_t i = 0; i < tries.size(); ++i) {
      Try t = tries[i];
      if (std::abs(closest.distance[i]) >= t.radius - 1e-13 * diagonal_) {
        if (closest.winding[i] == 0) settled.push_back(t);
        continue;
      }
      const Vec3 p = closest.point[i] - t.q;
      const double height = p.dot(t.n);
      if (!(height > 0)) continue;
      const double smaller = p.squaredNorm() / (2 * height);
      if (!(smaller < t.radius) || smaller <= found_.lower) continue;
      t.radius = smaller;
      next.push_back(t);
    }
    tries = std::move(next);
    for (const Try& t : settled)
      if (t.radius > found_.lower) {
        found_.lower = t.radius;
        found_.point = t.q;
        found_.normal = t.n;
        found_.place = t.q + t.radius * t.n;
      }
    settled.clear();
  }
}

} // namespace

double usual_star_shape_tolerance(std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& origin) {
  const Box box = bounding_box(vertices, faces);
  const double diagonal = (box.max - box.min).norm();
  const double largest = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
  const double least = std::max(1e-9 * diagonal, 0x1p-47 * largest);
  return sees_all(vertices, faces, origin) ? least : std::max(1e-6 * diagonal, least);
}

StarShapeTime star_shape_time(std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& origin,
                              double tolerance, Backend& backend, Monitor& monitor) {
  if (faces.empty()) throw Error(Fault::bad_argument, "a surface without faces is not star-shaped at any time");
  if (!origin.allFinite()) throw Error(Fault::bad_argument, "the origin of a star-shaped body must be finite");
  return StarSearch(vertices, faces, origin, tolerance, backend, monitor)
      .run(brillouin_radius(vertices, faces, origin));
}

} // namespace cowgpu

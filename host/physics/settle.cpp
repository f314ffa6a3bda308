#include "host/physics/settle.hpp"

#include "host/error.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

namespace cowgpu::physics {
namespace {

using Vec2 = Eigen::Vector2d;

// Of the body's size: vertices so near to the ground touch it, and a point so near to a border lies on it.
constexpr double ground_tolerance = 1e-10;

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Corners of the convex hull, counter-clockwise (Andrew's monotone chain); corners nearer than `noise` to the line of their
// neighbours are left out.
std::vector<std::size_t> hull(const std::vector<Vec2>& points, double noise) {
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(points[a].x(), points[a].y()) < std::pair(points[b].x(), points[b].y());
  });
  std::vector<std::size_t> chain;
  const auto add = [&](std::size_t next, std::size_t keep) {
    while (chain.size() >= keep + 2) {
      const Vec2 &a = points[chain[chain.size() - 2]], &b = points[chain.back()], &c = points[next];
      if (cross(b - a, c - a) > noise * (c - a).norm()) break;
      chain.pop_back();
    }
    if (chain.empty() || (points[chain.back()] - points[next]).norm() > noise) chain.push_back(next);
  };
  for (const std::size_t i : order) add(i, 0);
  const std::size_t lower = chain.size() - 1;
  for (auto i = order.rbegin(); i != order.rend(); ++i) add(*i, lower);
  if (chain.size() > 1 && (points[chain.front()] - points[chain.back()]).norm() <= noise) chain.pop_back();
  return chain;
}

// Where the origin lies with respect to a convex polygon, segment or point.
struct Place {
  double margin = 0;                ///< distance from the border, below 0 outside
  Vec2 outward = Vec2::Zero();      ///< from the nearest border towards where the origin is, or would leave
  std::vector<std::size_t> nearest; ///< the corner or the two of the edge, as indices of the polygon
};

Place place_of_origin(const std::vector<Vec2>& corners, double noise) {
  Place place;
  if (corners.size() == 1) {
    place.margin = -corners[0].norm();
    place.nearest = {0};
    if (corners[0].norm() > noise) place.outward = -corners[0].normalized();
    return place;
  }
  place.margin = -std::numeric_limits<double>::infinity();
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = corners.size() > 2;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::size_t j = (i + 1) % corners.size();
    const Vec2 edge = corners[j] - corners[i];
    const double along = std::clamp(-corners[i].dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    const Vec2 foot = corners[i] + along * edge;
    const Vec2 normal = Vec2(edge.y(), -edge.x()).normalized(); // outward of a counter-clockwise polygon
    if (normal.dot(corners[i]) <= 0) inside = false;
    if (!(foot.norm() < nearest)) continue;
    nearest = foot.norm();
    place.nearest = along == 0 ? std::vector{i} : along == 1 ? std::vector{j} : std::vector{i, j};
    place.outward = foot.norm() > noise && place.nearest.size() == 1 ? Vec2(-foot.normalized()) : normal;
    if (place.nearest.size() == 2 && normal.dot(foot) > 0) place.outward = -normal; // the segment's other side
  }
  place.margin = inside ? nearest : -nearest;
  return place;
}

// Two directions at right angles to `down`, the first near +z.
std::pair<Vec3, Vec3> level_axes(const Vec3& down) {
  const Vec3 aim = std::abs(down.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitY();
  const Vec3 first = (aim - aim.dot(down) * down).normalized();
  return {first, down.cross(first)};
}

Eigen::Matrix3d least_rotation(const Vec3& from, const Vec3& to) {
  const double cosine = from.dot(to);
  if (cosine < -1 + 1e-15) { // half a turn: about x, as good as any
    const Vec3 axis = (Vec3::UnitX() - to.x() * to).normalized();
    return 2 * axis * axis.transpose() - Eigen::Matrix3d::Identity();
  }
  const Vec3 k = from.cross(to);
  Eigen::Matrix3d skew;
  skew << 0, -k.z(), k.y(), k.z(), 0, -k.x(), -k.y(), k.x(), 0;
  return Eigen::Matrix3d::Identity() + skew + skew * skew / (1 + cosine);
}

double angle_of(const Eigen::Matrix3d& rotation) {
  const Vec3 twice_sine(rotation(2, 1) - rotation(1, 2), rotation(0, 2) - rotation(2, 0),
                        rotation(1, 0) - rotation(0, 1));
  return std::atan2(twice_sine.norm(), rotation.trace() - 1);
}

[[noreturn]] void no_facet(const std::string& why) {
  throw Error(Fault::cannot_stand,
              fmt::format("the body cannot stand: {}; a barycentre inside the convex hull of the vertices is needed, "
                          "which parts of negative density can take away",
                          why));
}

// The body on its way down: r = vertices - b.
struct Rolling {
  std::vector<Vec3> r;
  double size = 0;
  Vec3 down = -Vec3::UnitY();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity(); // product of all rolls so far: brings `down` to -y

  // Rolls on to another direction: about the axis at right angles to both, which is level.
  void turn_to(const Vec3& direction) {
    rotation = least_rotation(rotation * direction, -Vec3::UnitY()) * rotation;
    down = direction;
  }

  double height() const {
    double height = -std::numeric_limits<double>::infinity();
    for (const Vec3& v : r) height = std::max(height, down.dot(v));
    return height;
  }

  std::vector<std::size_t> touching_ground() const {
    const double height = this->height();
    if (!(height > ground_tolerance * size)) no_facet("its barycentre is not above what it stands on");
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < r.size(); ++i)
      if (down.dot(r[i]) >= height - ground_tolerance * size) found.push_back(i);
    return found;
  }

  // Turns `down` towards `way` until a vertex that is not in `touch` comes to the height of `pivot`; the angle.
  double tip(const Vec3& way, std::size_t pivot, const std::vector<std::size_t>& touch) {
    double least = std::numeric_limits<double>::infinity();
    auto known = touch.begin();
    for (std::size_t i = 0; i < r.size(); ++i) {
      if (known != touch.end() && *known == i) {
        ++known;
        continue;
      }
      const Vec3 d = r[i] - r[pivot];
      least = std::min(least, std::atan2(-down.dot(d), way.dot(d)));
    }
    if (!(least < std::numbers::pi / 2)) no_facet("it rolls over its last vertex");
    turn_to((std::cos(least) * down + std::sin(least) * way).normalized());
    return least;
  }
};

// The facet's own normal, from its corners: rounding of the way there goes.
Vec3 facet_normal(const std::vector<Vec3>& corners, const Vec3& near) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
  return sum.dot(near) < 0 ? Vec3(-sum.normalized()) : Vec3(sum.normalized());
}

} // namespace

Attitude settle(std::span<const Vec3> vertices, const Vec3& barycentre, const Monitor& monitor) {
  Rolling body;
  for (const Vec3& v : vertices) {
    body.r.push_back(v - barycentre);
    body.size = std::max(body.size, body.r.back().norm());
  }
  if (!(body.size > 0) || !std::isfinite(body.size)) no_facet("it has no size");
  const double noise = ground_tolerance * body.size;
  Attitude attitude;
  std::set<std::vector<std::size_t>> edges; // rolled over
  for (;;) {
    check_stop(monitor);
    if (attitude.rolls.size() > 8 * body.r.size() + 64) no_facet("it rolls on and on");
    const std::vector<std::size_t> touch = body.touching_ground();
    const auto [first, second] = level_axes(body.down);
    std::vector<Vec2> flat;
    for (const std::size_t i : touch) flat.emplace_back(first.dot(body.r[i]), second.dot(body.r[i]));
    const std::vector<std::size_t> corner = hull(flat, noise);
    std::vector<Vec2> polygon;
    for (const std::size_t i : corner) polygon.push_back(flat[i]);
    Place place = place_of_origin(polygon, noise);
    Roll roll;
    for (const std::size_t i : place.nearest) roll.over.push_back(touch[corner[i]]);
    std::sort(roll.over.begin(), roll.over.end());
    const bool again = roll.over.size() == 2 && edges.contains(roll.over);
    if (place.margin > noise || (again && corner.size() > 2)) {
      std::vector<Vec3> corners;
      for (const std::size_t i : corner) corners.push_back(body.r[touch[i]]);
      body.turn_to(facet_normal(corners, body.down));
      break;
    }
    if (std::abs(place.margin) <= noise) {
      attitude.balanced = true;
      if (place.outward.isZero(0)) place.outward = {1, 0};
    }
    if (roll.over.size() == 2) edges.insert(roll.over);
    const Vec3 way = place.outward.x() * first + place.outward.y() * second;
    roll.before = body.height();
    roll.angle = body.tip(way, touch[corner[place.nearest[0]]], touch);
    roll.after = body.height();
    attitude.rolls.push_back(std::move(roll));
  }
  // Newton's step to the orthogonal matrix next to it: many rolls leave rounding.
  const Eigen::Matrix3d& r = body.rotation;
  attitude.rotation = r * (3 * Eigen::Matrix3d::Identity() - r.transpose() * r) / 2;
  attitude.angle = angle_of(attitude.rotation);
  attitude.least_angle = std::atan2(body.down.cross(Vec3::UnitY()).norm(), -body.down.y());
  const Eigen::Matrix3d about_y = attitude.rotation * least_rotation(body.down, -Vec3::UnitY()).transpose();
  attitude.heading = std::atan2(about_y(0, 2) - about_y(2, 0), about_y(0, 0) + about_y(2, 2));
  return attitude;
}

Contact contact(std::span<const Vec3> vertices, const Vec3& barycentre, double tolerance) {
  Contact found;
  double size = 0;
  found.ground = std::numeric_limits<double>::infinity();
  for (const Vec3& v : vertices) {
    found.ground = std::min(found.ground, v.y());
    size = std::max(size, (v - barycentre).norm());
  }
  const double noise = ground_tolerance * size;
  std::vector<Vec2> flat; // (z, x) from the barycentre's foot: counter-clockwise about y
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec3& v = vertices[i];
    if (v.y() > found.ground + std::max(tolerance, 10 * noise)) continue;
    found.vertices.push_back(i);
    found.support.push_back(v);
    flat.emplace_back(v.z() - barycentre.z(), v.x() - barycentre.x());
  }
  if (flat.empty()) no_facet("it has no vertex");
  std::vector<Vec2> polygon;
  for (const std::size_t i : hull(flat, noise)) {
    found.patch.push_back(found.support[i]);
    polygon.push_back(flat[i]);
  }
  found.margin = place_of_origin(polygon, noise).margin;
  return found;
}

} // namespace cowgpu::physics

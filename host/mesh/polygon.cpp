#include "host/mesh/polygon.hpp"

#include "host/mesh/polygon_sweep.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cowgpu {
namespace {

constexpr double thin = 1e-6;           // part of a triangle's longest edge, and of the mean area
constexpr double flat = 1e-6;           // part of the polygon's extent
constexpr double float_rounding = 1e-7; // part of the largest coordinate
constexpr double no_area = 1e-14;       // part of the square of the extent, and of extent times largest coordinate
constexpr double much_bent = 0.01;      // part of the extent

/// The corners about the first one, so that the extent is 1: areas neither overflow nor vanish.
struct Shape {
  Vec3 origin = Vec3::Zero(), normal = Vec3::Zero(); ///< twice the area vector
  double extent = 0, largest = 0;                    ///< largest: coordinate, over the extent
  double bend = 0, flatness = 0;                     ///< flatness: the bend that passes as flat

  Vec3 place(const Vec3& p) const { return p / extent - origin; }
};

Shape shape_of(std::span<const Vec3> points, std::span<const std::uint32_t> corners) {
  Shape shape;
  Vec3 low = points[corners[0]], high = low;
  for (const std::uint32_t c : corners) low = low.cwiseMin(points[c]), high = high.cwiseMax(points[c]);
  const double largest = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  shape.extent = 2 * (high / 2 - low / 2).maxCoeff();
  if (!(shape.extent > 0)) return shape;
  shape.largest = largest / shape.extent;
  if (!std::isfinite(shape.largest)) return shape;
  shape.origin = points[corners[0]] / shape.extent;
  Vec3 before = shape.place(points[corners.back()]);
  for (const std::uint32_t c : corners) {
    const Vec3 p = shape.place(points[c]);
    shape.normal += before.cross(p);
    before = p;
  }
  shape.flatness = flat + float_rounding * shape.largest;
  if (const double length = shape.normal.norm(); length > 0) {
    double least = 0, most = 0;
    for (const std::uint32_t c : corners) {
      const double height = shape.place(points[c]).dot(shape.normal) / length;
      least = std::min(least, height), most = std::max(most, height);
    }
    shape.bend = (most - least) / 2;
  }
  return shape;
}

/// The direction at right angles to the widest triangle of the first corner, the one farthest from it, and a third.
Vec3 some_normal(const Shape& shape, std::span<const Vec3> points, std::span<const std::uint32_t> corners) {
  Vec3 far = Vec3::Zero(), normal = Vec3::Zero();
  for (const std::uint32_t c : corners)
    if (const Vec3 p = shape.place(points[c]); p.squaredNorm() > far.squaredNorm()) far = p;
  for (const std::uint32_t c : corners)
    if (const Vec3 n = far.cross(shape.place(points[c])); n.squaredNorm() > normal.squaredNorm()) normal = n;
  return normal;
}

/// Whether the fan from corner 0 covers the polygon once: all its triangles turn in one sense, by less than 360 degrees in all.
bool fan_is_simple(const FlatPolygon& polygon) {
  const int sense = polygon.turn(0, 1, 2);
  if (sense == 0) return false;
  bool beyond = false; // 180 degrees
  for (std::uint32_t i = 2; i + 1 < polygon.size(); ++i) {
    if (polygon.turn(0, i, i + 1) != sense) return false;
    const bool ahead = polygon.turn(0, 1, i + 1) == sense;
    if (beyond && (ahead || polygon.turn(0, 1, i + 1) == 0)) return false;
    beyond = beyond || !ahead;
  }
  return true;
}

/// Whether the fan has a triangle that has hardly any area where another cut may do better.
bool fan_has_slivers(const Shape& shape, std::span<const Vec3> points, std::span<const std::uint32_t> corners) {
  const double mean = shape.normal.norm() / static_cast<double>(corners.size() - 2);
  const auto place = [&](std::size_t i) { return shape.place(points[corners[i]]); };
  const Vec3 first = place(0);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec3 a = place(i) - first, b = place(i + 1) - first;
    const double area = a.cross(b).norm(),
                 longest = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
    if (area < thin * longest && area < thin * mean) return true;
  }
  return false;
}

int steepest_axis(const Vec3& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return axis;
}

/// The corners in the plane at right angles to the normal, turning as they do seen from its end.
std::vector<std::array<double, 2>> in_plane(const Shape& shape, const Vec3& normal, std::span<const Vec3> points,
                                            std::span<const std::uint32_t> corners) {
  const Vec3 up = normal.normalized(), across = up.unitOrthogonal(), along = up.cross(across);
  std::vector<std::array<double, 2>> places;
  places.reserve(corners.size());
  for (const std::uint32_t c : corners) {
    const Vec3 p = shape.place(points[c]);
    places.push_back({p.dot(across), p.dot(along)});
  }
  return places;
}

} // namespace

CutPolygon PolygonCutter::cut(std::span<const Vec3> corners) {
  triangles_.clear();
  distinct_.clear();
  const auto n = static_cast<std::uint32_t>(corners.size());
  if (n < 4 || !std::all_of(corners.begin(), corners.end(), [](const Vec3& p) { return p.allFinite(); })) return {};
  for (std::uint32_t i = 0; i < n; ++i)
    if (distinct_.empty() || corners[i] != corners[distinct_.back()]) distinct_.push_back(i);
  while (distinct_.size() > 1 && corners[distinct_.front()] == corners[distinct_.back()]) distinct_.pop_back();
  if (distinct_.size() < 3) return {}; // a point or a segment: no cut has area

  const Shape shape = shape_of(corners, distinct_);
  CutPolygon result;
  if (!(shape.extent > 0) || !std::isfinite(shape.largest)) return result; // too large or too small to compute with
  if (shape.bend > shape.flatness) result.bend = shape.bend;
  const double rounding = no_area * (1 + shape.largest);
  // A polygon that crosses itself may have no area vector though it has a plane.
  const Vec3 normal = shape.normal.norm() > rounding ? shape.normal : some_normal(shape, corners, distinct_);
  const int axis = steepest_axis(normal);
  FlatPolygon polygon(corners, distinct_, axis, normal[axis] < 0);
  if (fan_is_simple(polygon) && !fan_has_slivers(shape, corners, distinct_)) return result;
  if (normal.norm() <= rounding) {
    result.result = PolygonCut::no_plane;
    return result;
  }

  const int sense = sense_of(polygon);
  const bool turned = sense < 0;
  if (turned) polygon = FlatPolygon(corners, distinct_, axis, normal[axis] >= 0);
  std::optional<NotSimple> fault = sweep(polygon, triangles_);
  if (fault) {
    triangles_.clear();
    if (n == 4 && shape.bend > much_bent) return result;
    result.result = fault->touches ? PolygonCut::touches : PolygonCut::crosses;
    if (shape.bend > much_bent) result.result = PolygonCut::no_plane;
    result.at = {distinct_[fault->at[0]], distinct_[fault->at[1]]};
    return result;
  }
  flip_towards_delaunay(polygon, in_plane(shape, normal, corners, distinct_), triangles_);
  for (Face& triangle : triangles_)
    for (std::uint32_t& corner : triangle) corner = distinct_[corner];
  // Corners left out above hang between the corner at their place and the next one.
  for (std::size_t i = 0; i < distinct_.size(); ++i) {
    const bool last = i + 1 == distinct_.size();
    const std::uint32_t next = last ? distinct_[0] : distinct_[i + 1], end = last ? n : distinct_[i + 1];
    for (std::uint32_t c = distinct_[i]; c + 1 < end; ++c) triangles_.push_back({c, c + 1, next});
  }
  result.result = PolygonCut::cut;
  return result;
}

} // namespace cowgpu

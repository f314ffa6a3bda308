#include "host/plan/sample.hpp"

#include "host/error.hpp"
#include "host/geometry/orientation.hpp"
#include "host/parallel.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu::plan {
namespace {

constexpr double pi = std::numbers::pi;
// What spans are widened by, far above all rounding: of a plane's value, of angles, of a point's index.
constexpr double value_slack = 1e-14, angle_slack = 1e-11, index_slack = 1e-8;

double widened(double angle) {
  return angle * (1 + 1e-9) + angle_slack;
}

// x modulo 2 pi, in [0, 2 pi).
double turn(double x) {
  x -= 2 * pi * std::floor(x / (2 * pi));
  return x < 2 * pi ? x : 0;
}

void check_input(std::span<const Vec3> positions, std::span<const Face> faces) {
  if (faces.size() >= 0x7fffffffU)
    throw Error(Fault::bad_argument,
                fmt::format("{} triangles cannot be sampled: fewer than 2^31 are possible", faces.size()));
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const std::uint32_t v : faces[f]) {
      if (v >= positions.size())
        throw Error(Fault::bad_argument,
                    fmt::format("face {} names vertex {}, but the map has positions for {} vertices "
                                "only: it belongs to another mesh",
                                f, v, positions.size()));
      if (!(std::abs(positions[v].norm() - 1) <= 1e-9))
        throw Error(Fault::bad_argument,
                    fmt::format("vertex {} of face {} is mapped to ({}, {}, {}), which is not on the unit sphere", v, f,
                                positions[v].x(), positions[v].y(), positions[v].z()));
    }
}

} // namespace

Cap bounding_cap(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 sum = (a + b) + c;
  const double length = sum.norm();
  const auto everything = [] { return Cap{Vec3(0, 0, 1), 4}; };
  if (length < 1e-3) return everything();
  const Vec3 centre = sum / length;
  const double chord = std::max({(a - centre).norm(), (b - centre).norm(), (c - centre).norm()});
  const double angle = 2 * std::asin(std::min(1.0, chord / 2)) * (1 + 1e-9) + 1e-13;
  // A cap holds the triangles of its points only while it is convex.
  return angle < pi / 2 ? Cap{centre, angle} : everything();
}

Sample::Sample(std::span<const Vec3> positions_, std::span<const Face> faces_, const SphereGrid& grid_,
               unsigned threads)
    : positions(positions_), faces(faces_), grid(grid_), directions(grid_) {
  check_input(positions, faces);
  constexpr std::size_t chunk = 1024;
  struct Part {
    std::vector<SampleFace> upright, flipped;
    std::uint64_t flipped_faces = 0, flat_faces = 0;
  };
  std::vector<Part> parts((faces.size() + chunk - 1) / chunk);
  parallel_for(threads, parts.size(), [&](std::size_t task, unsigned) {
    Part& part = parts[task];
    for (std::size_t f = task * chunk; f < std::min(faces.size(), (task + 1) * chunk); ++f) {
      const Vec3 &a = positions[faces[f][0]], &b = positions[faces[f][1]], &c = positions[faces[f][2]];
      const int sign = orientation(a, b, c);
      part.flat_faces += sign == 0;
      part.flipped_faces += sign < 0;
      if (sign == 0) continue;
      const Cap cap = bounding_cap(a, b, c);
      const double theta = std::atan2(std::hypot(cap.centre.x(), cap.centre.y()), cap.centre.z());
      const auto first = std::lower_bound(grid.theta.begin(), grid.theta.end(), theta - cap.angle);
      const auto end = std::upper_bound(first, grid.theta.end(), theta + cap.angle);
      if (first == end) continue;
      (sign < 0 ? part.flipped : part.upright)
          .push_back({std::uint32_t(f), sign < 0, int(first - grid.theta.begin()), int(end - grid.theta.begin()) - 1});
    }
  });
  for (const Part& part : parts) {
    kept.insert(kept.end(), part.upright.begin(), part.upright.end());
    flipped_faces += part.flipped_faces;
    flat_faces += part.flat_faces;
  }
  for (const Part& part : parts) kept.insert(kept.end(), part.flipped.begin(), part.flipped.end());
}

SampleCorners Sample::corners(std::size_t rank) const {
  const SampleFace& f = kept[rank];
  const Face& face = faces[f.face];
  return {positions[face[0]], positions[face[f.flipped ? 2 : 1]], positions[face[f.flipped ? 1 : 2]]};
}

Place Sample::place(std::size_t rank, const Vec3& direction) const {
  const SampleCorners t = corners(rank);
  int least = orientation(direction, t.b, t.c);
  if (least >= 0) least = std::min(least, orientation(direction, t.c, t.a));
  if (least >= 0) least = std::min(least, orientation(direction, t.a, t.b));
  return least < 0 ? Place::outside : least == 0 ? Place::edge : Place::inside;
}

std::vector<std::vector<std::uint32_t>> Sample::bands(int rings) const {
  std::vector<std::vector<std::uint32_t>> lists(std::size_t((grid.rings + rings - 1) / rings));
  for (std::size_t rank = 0; rank < kept.size(); ++rank)
    for (int band = kept[rank].first_ring / rings; band <= kept[rank].last_ring / rings; ++band)
      lists[std::size_t(band)].push_back(std::uint32_t(rank));
  return lists;
}

void Sample::refuse(std::size_t point, std::uint64_t uncovered) const {
  const int ring = int(point / std::size_t(grid.ring_length)), j = int(point % std::size_t(grid.ring_length));
  const Vec3 d = directions(ring, j);
  throw Error(
      Fault::map_failed,
      fmt::format("no triangle of the map lies in the direction ({:.6g}, {:.6g}, {:.6g}), colatitude {:.6g} and "
                  "longitude {:.6g} degrees, ring {} point {}{}: the mapped surface does not go round the "
                  "sphere's centre, either because faces are missing or because the map tears or folds over "
                  "the centre; try another method of mapping",
                  d.x(), d.y(), d.z(), 90 - grid.latitude_degrees(ring), grid.longitude_degrees(j), ring, j,
                  uncovered > 1 ? fmt::format(", nor in {} others", uncovered - 1) : ""));
}

SphereSamples Sample::samples() const {
  SphereSamples result;
  result.rings = grid.rings;
  result.ring_length = grid.ring_length;
  result.faces.resize(grid.points());
  result.weights.resize(grid.points());
  result.flipped_faces = flipped_faces;
  result.flat_faces = flat_faces;
  return result;
}

RingScan::RingScan(const Sample& sample, std::size_t rank) : sample_(sample) {
  const SampleCorners t = sample.corners(rank);
  normals_ = {t.b.cross(t.c), t.c.cross(t.a), t.a.cross(t.b)};
  for (std::size_t k = 0; k < 3; ++k) {
    normal_rho_[k] = std::hypot(normals_[k].x(), normals_[k].y());
    normal_phi_[k] = std::atan2(normals_[k].y(), normals_[k].x());
  }
  const Cap cap = bounding_cap(t.a, t.b, t.c);
  sine_ = std::hypot(cap.centre.x(), cap.centre.y());
  theta_ = std::atan2(sine_, cap.centre.z());
  phi_ = std::atan2(cap.centre.y(), cap.centre.x());
  half_sine2_ = cap.angle > pi ? 2 : std::pow(std::sin(cap.angle / 2), 2);
}

int RingScan::spans(int ring, std::array<RingSpan, 2>& spans) const {
  const auto i = std::size_t(ring);
  const double sine = sample_.directions.sine[i], cosine = sample_.directions.cosine[i];
  // The cap: sin^2(angle / 2) >= sin^2((theta - theta_c) / 2) + sin theta sin theta_c sin^2((phi - phi_c) / 2).
  const double half = std::sin((sample_.grid.theta[i] - theta_) / 2);
  const double left = half_sine2_ - half * half, across = sine * sine_;
  if (left < 0) return 0;
  double low = -pi, high = pi; // relative to phi_
  if (left < across) {
    high = std::min(pi, widened(2 * std::asin(std::sqrt(left / across))));
    low = -high;
  }
  // The planes: height + rho cos(phi - phi_n) >= 0.
  for (std::size_t k = 0; k < 3; ++k) {
    const double height = normals_[k].z() * cosine + value_slack, rho = normal_rho_[k] * sine;
    if (height + rho < 0) return 0;
    if (height >= rho) continue;
    const double open = std::min(pi, widened(std::acos(std::clamp(-height / rho, -1.0, 1.0))));
    // Beyond the arc within `open` of the plane's middle there is a gap. An end of the interval within it moves out of it.
    const double gap = 2 * pi - 2 * open, middle = normal_phi_[k] - phi_;
    const double from_left = turn(low - (middle + open)), to_right = turn((middle - open) - high);
    if (from_left < gap) low += gap - from_left;
    if (to_right < gap) high -= gap - to_right;
    if (low > high) return 0;
  }
  const int n = sample_.grid.ring_length;
  const double points_a_radian = n / (2 * pi);
  const double first = std::ceil((phi_ + low) * points_a_radian - sample_.grid.shift - index_slack);
  const double last = std::floor((phi_ + high) * points_a_radian - sample_.grid.shift + index_slack);
  if (last < first) return 0;
  if (last - first + 1 >= n) {
    spans[0] = {0, n};
    return 1;
  }
  const int count = int(last - first) + 1;
  int begin = int(first) % n;
  if (begin < 0) begin += n;
  spans[0] = {begin, std::min(count, n - begin)};
  spans[1] = {0, count - spans[0].count};
  return spans[1].count > 0 ? 2 : 1;
}

} // namespace cowgpu::plan

#include "host/map/closest_point.hpp"

#include "host/error.hpp"
#include "host/orientation.hpp"
#include "host/parallel.hpp"
#include "host/sphere_directions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cowgpu {
namespace {

using Weights = std::array<double, 3>;

// Weights of the point of a triangle closest to p. A triangle of no area is its longest edge, as one of the regions.
Weights closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double e = d4 - d3, g = d5 - d6;
  if (va <= 0 && e >= 0 && g >= 0 && e + g > 0) return {0, 1 - e / (e + g), e / (e + g)};
  const double sum = va + vb + vc;
  if (!(sum > 0)) return {1, 0, 0}; // a point
  const double v = vb / sum, w = vc / sum;
  return {1 - v - w, v, w};
}

struct Ball {
  Vec3 centre;
  double radius;

  // Whether a point of it may be within `reach` of p.
  bool near(const Vec3& p, double reach) const {
    const double limit = (reach + radius) * (1 + 1e-12);
    return (p - centre).squaredNorm() <= limit * limit;
  }
};

// Balls round each sixteen balls in turn: neighbours in a mesh mostly stand together.
constexpr std::size_t group = 16;
std::vector<Ball> grouped(std::span<const Ball> balls) {
  std::vector<Ball> groups;
  for (std::size_t first = 0; first < balls.size(); first += group) {
    const auto part = balls.subspan(first, std::min(group, balls.size() - first));
    Ball ball{Vec3::Zero(), 0};
    for (const Ball& b : part) ball.centre += b.centre / double(part.size());
    for (const Ball& b : part) ball.radius = std::max(ball.radius, (b.centre - ball.centre).norm() + b.radius);
    groups.push_back(ball);
  }
  return groups;
}

} // namespace

SphereSamples closest_samples(std::span<const Vec3> positions, std::span<const Face> faces, const SphereGrid& grid,
                              Monitor& monitor) {
  if (faces.empty()) throw Error(Fault::bad_argument, "the closest point of a map without faces");
  SphereSamples result;
  std::vector<Ball> balls;
  std::vector<std::uint8_t> flipped;
  for (const Face& face : faces) {
    for (const std::uint32_t v : face)
      if (v >= positions.size())
        throw Error(Fault::bad_argument, fmt::format("a face names vertex {} of {}", v, positions.size()));
    const Vec3 &a = positions[face[0]], &b = positions[face[1]], &c = positions[face[2]];
    const Vec3 centre = (a + b + c) / 3;
    balls.push_back({centre, std::sqrt(std::max({(a - centre).squaredNorm(), (b - centre).squaredNorm(),
                                                 (c - centre).squaredNorm()})) *
                                 (1 + 1e-12)});
    const int sign = orientation(a, b, c);
    flipped.push_back(sign < 0);
    result.flipped_faces += sign < 0;
    result.flat_faces += sign == 0;
  }
  const std::vector<Ball> groups = grouped(balls);
  result.rings = grid.rings;
  result.ring_length = grid.ring_length;
  result.faces.resize(grid.points());
  result.weights.resize(grid.points());
  const SphereDirections directions(grid);
  parallel_for(0, std::size_t(grid.rings), [&](std::size_t ring, unsigned) {
    check_stop(monitor);
    std::uint32_t near = 0; // the last point's face is a good first guess
    for (int j = 0; j < grid.ring_length; ++j) {
      const Vec3 p = directions(int(ring), j);
      double least = INFINITY;
      std::uint32_t best = 0;
      Weights weights{};
      const auto look = [&](std::uint32_t f) {
        const Vec3 &a = positions[faces[f][0]], &b = positions[faces[f][1]], &c = positions[faces[f][2]];
        const Weights w = closest_on_triangle(p, a, b, c);
        const double distance = (w[0] * a + w[1] * b + w[2] * c - p).squaredNorm();
        if (distance > least || (distance == least && f >= best)) return;
        least = distance;
        best = f;
        weights = w;
      };
      look(near);
      double reach = std::sqrt(least);
      for (std::size_t g = 0; g < groups.size(); ++g) {
        if (!groups[g].near(p, reach)) continue;
        for (std::size_t f = g * group; f < std::min(faces.size(), (g + 1) * group); ++f) {
          if (!balls[f].near(p, reach)) continue;
          look(std::uint32_t(f));
          reach = std::sqrt(least);
        }
      }
      const std::size_t at = ring * std::size_t(grid.ring_length) + std::size_t(j);
      result.faces[at] = near = best;
      result.weights[at] = weights;
    }
  });
  std::vector<std::uint8_t> hit(faces.size(), 0);
  for (const std::uint32_t f : result.faces) {
    hit[f] = 1;
    result.flipped_points += flipped[f];
  }
  result.faces_hit = std::accumulate(hit.begin(), hit.end(), std::uint64_t(0));
  return result;
}

} // namespace cowgpu

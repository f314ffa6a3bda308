#include "host/flow/sheets.hpp"

#include "host/error.hpp"
#include "host/geometry/orientation.hpp"
#include "host/parallel.hpp"
#include "host/spectrum/surface_fields.hpp"
#include "host/sphere_directions.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu {
namespace {

constexpr double pi = std::numbers::pi;

/// A mapped triangle and a cap of the sphere that holds it.
struct Sheet {
  std::uint32_t face = 0;
  int sign = 0;
  double theta = 0, phi = 0, radius = 0;

  int first_ring(const SphereGrid& grid) const {
    return int(std::lower_bound(grid.theta.begin(), grid.theta.end(), theta - radius) - grid.theta.begin());
  }
  int end_ring(const SphereGrid& grid) const {
    return int(std::upper_bound(grid.theta.begin(), grid.theta.end(), theta + radius) - grid.theta.begin());
  }
  /// Half the range of longitudes; pi if the cap holds a pole.
  double half_width() const {
    const double s = std::sin(radius), t = std::sin(theta);
    return radius >= std::min(theta, pi - theta) || s >= t ? pi : std::asin(s / t);
  }
};

Sheet sheet_of(std::uint32_t face, const Vec3& a, const Vec3& b, const Vec3& c, int sign) {
  Sheet sheet{face, sign};
  Vec3 centre = a + b + c;
  if (centre.norm() < 1e-6) centre = (sign > 0 ? 1 : -1) * (b - a).cross(c - a);
  centre.normalize();
  sheet.theta = std::atan2(std::hypot(centre.x(), centre.y()), centre.z());
  sheet.phi = std::atan2(centre.y(), centre.x());
  for (const Vec3* corner : {&a, &b, &c})
    sheet.radius = std::max(sheet.radius, std::atan2(centre.cross(*corner).norm(), centre.dot(*corner)));
  // A cap beyond a half sphere need not hold what lies between its points.
  sheet.radius = sheet.radius < pi / 2 - 1e-6 ? sheet.radius + 1e-9 : pi;
  return sheet;
}

// The part of a small circle about p that lies in the triangle: 1 inside, by the angle at a corner.
double share(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, const int side[3]) {
  const int on = (side[0] == 0) + (side[1] == 0) + (side[2] == 0);
  if (on == 0) return 1;
  if (on == 1) return 0.5;
  // Edges ab, bc, ca: the two that hold p meet in the corner.
  const Vec3 &corner = side[1] != 0   ? a
                       : side[2] != 0 ? b
                                      : c,
             &next = side[1] != 0   ? b
                     : side[2] != 0 ? c
                                    : a,
             &last = side[1] != 0   ? c
                     : side[2] != 0 ? a
                                    : b;
  const Vec3 u = p.cross(next - corner), v = p.cross(last - corner);
  return std::atan2(u.cross(v).norm(), u.dot(v)) / (2 * pi);
}

} // namespace

std::vector<double> sheet_fields(std::span<const Vec3> vertices, std::span<const Face> faces,
                                 std::span<const Vec3> positions, const SphereGrid& grid, const Vec3& origin,
                                 bool signed_dphi, Monitor& monitor, SheetReport* report) {
  if (positions.size() != vertices.size())
    throw Error(Fault::bad_argument,
                fmt::format("the map has {} positions and the mesh {} vertices: it is of another mesh",
                            positions.size(), vertices.size()));
  SheetReport found;
  found.faces = faces.size();
  found.points = grid.points();
  std::vector<Sheet> sheets;
  std::vector<std::vector<std::uint32_t>> of_ring(std::size_t(grid.rings)); // sheets that may hold points of it
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    for (const std::uint32_t v : faces[f])
      if (v >= positions.size())
        throw Error(Fault::bad_argument,
                    fmt::format("a face names vertex {}, but there are {} vertices: pass the faces of this mesh", v,
                                positions.size()));
    const Vec3 &a = positions[faces[f][0]], &b = positions[faces[f][1]], &c = positions[faces[f][2]];
    const int sign = orientation(a, b, c);
    found.flipped_faces += sign < 0;
    found.flat_faces += sign == 0;
    if (sign == 0) continue;
    const Sheet sheet = sheet_of(f, a, b, c, sign);
    for (int ring = sheet.first_ring(grid); ring < sheet.end_ring(grid); ++ring)
      of_ring[std::size_t(ring)].push_back(std::uint32_t(sheets.size()));
    sheets.push_back(sheet);
  }
  const SphereDirections directions(grid);
  const std::size_t points = grid.points(), length = std::size_t(grid.ring_length);
  std::vector<double> values(6 * points, 0);
  struct RingCount {
    std::uint64_t folded = 0;
    std::uint32_t most = 0;
    double least = std::numeric_limits<double>::infinity(), largest = -least;
  };
  std::vector<RingCount> counts(of_ring.size());
  parallel_for(0, of_ring.size(), [&](std::size_t ring, unsigned) {
    check_stop(monitor);
    std::vector<double> degree(length, 0), size(length, 0);
    std::vector<std::uint32_t> held(length, 0);
    for (const std::uint32_t s : of_ring[ring]) {
      const Sheet& sheet = sheets[s];
      const Face& face = faces[sheet.face];
      const Vec3 &a = positions[face[0]], &b = positions[face[1]], &c = positions[face[2]];
      const double step = 2 * pi / double(length), half = sheet.half_width();
      const auto first = std::int64_t(std::ceil((sheet.phi - half) / step - grid.shift - 1e-6));
      const auto last = half >= pi ? first + std::int64_t(length) - 1
                                   : std::int64_t(std::floor((sheet.phi + half) / step - grid.shift + 1e-6));
      for (std::int64_t k = first; k <= last; ++k) {
        const auto j = std::size_t((k % std::int64_t(length) + std::int64_t(length)) % std::int64_t(length));
        const Vec3 p = directions(int(ring), int(j));
        const int side[3] = {orientation(a, b, p), orientation(b, c, p), orientation(c, a, p)};
        if (side[0] == -sheet.sign || side[1] == -sheet.sign || side[2] == -sheet.sign) continue;
        const double wc = std::abs(a.cross(b).dot(p)), wa = std::abs(b.cross(c).dot(p)),
                     wb = std::abs(c.cross(a).dot(p)), sum = wa + wb + wc,
                     weight = sheet.sign * share(p, a, b, c, side);
        const Vec3 position = (wa * vertices[face[0]] + wb * vertices[face[1]] + wc * vertices[face[2]]) / sum;
        const auto field = surface_field_values(position, origin, grid.theta[ring], grid.phi(int(j)), signed_dphi);
        for (std::size_t f = 0; f < 6; ++f) values[f * points + ring * length + j] += weight * field[f];
        degree[j] += weight;
        size[j] += std::abs(weight);
        ++held[j];
      }
    }
    RingCount& count = counts[ring];
    for (std::size_t j = 0; j < length; ++j) {
      count.folded += size[j] - std::abs(degree[j]) > 0.25;
      count.most = std::max(count.most, held[j]);
      count.least = std::min(count.least, degree[j]);
      count.largest = std::max(count.largest, degree[j]);
    }
  });
  if (report) {
    found.least_degree = counts[0].least;
    found.largest_degree = counts[0].largest;
    for (const RingCount& count : counts) {
      found.folded_points += count.folded;
      found.most_sheets = std::max(found.most_sheets, count.most);
      found.least_degree = std::min(found.least_degree, count.least);
      found.largest_degree = std::max(found.largest_degree, count.largest);
    }
    *report = found;
  }
  return values;
}

} // namespace cowgpu

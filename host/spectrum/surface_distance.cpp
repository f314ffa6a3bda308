#include "host/spectrum/surface_distance.hpp"

#include "host/backend.hpp"
#include "host/error.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

OneWayDistance one_way(std::span<const Vec3> vertices, std::span<const Face> faces, DistanceField& other,
                       std::size_t samples, Monitor& monitor) {
  std::vector<Vec3> points = area_samples(vertices, faces, samples);
  if (points.empty()) throw Error(Fault::mesh_empty, "a surface without area has no distance from another");
  std::vector<bool> used(vertices.size());
  for (const Face& face : faces)
    for (const std::uint32_t v : face) used[v] = true;
  for (std::size_t v = 0; v < vertices.size(); ++v)
    if (used[v]) points.push_back(vertices[v]);

  const std::vector<double> distance = other.closest(points, {.with_sign = false}, monitor).distance;
  OneWayDistance result;
  double sum = 0;
  for (std::size_t i = 0; i < samples; ++i) sum += distance[i] * distance[i];
  result.rms = std::sqrt(sum / double(samples));
  const auto largest = std::max_element(distance.begin(), distance.end());
  result.largest = *largest;
  result.where = points[std::size_t(largest - distance.begin())];
  return result;
}

void require_surface(std::span<const Vec3> vertices, std::span<const Face> faces) {
  if (faces.empty()) throw Error(Fault::mesh_empty, "a surface without faces has no distance from another");
  for (const Face& face : faces)
    for (const std::uint32_t v : face)
      if (!vertices[v].allFinite())
        throw Error(Fault::mesh_not_finite,
                    "a surface with coordinates that are not finite has no distance from another");
}

} // namespace

double SurfaceDistance::largest() const {
  return std::max(forth.largest, back.largest);
}
double SurfaceDistance::rms() const {
  return std::sqrt((forth.rms * forth.rms + back.rms * back.rms) / 2);
}

std::vector<Vec3> area_samples(std::span<const Vec3> vertices, std::span<const Face> faces, std::size_t count) {
  const auto doubled_area = [&](const Face& f) {
    return (vertices[f[1]] - vertices[f[0]]).cross(vertices[f[2]] - vertices[f[0]]).norm();
  };
  double total = 0;
  for (const Face& face : faces) total += doubled_area(face);
  std::vector<Vec3> points;
  if (!(total > 0) || !std::isfinite(total)) return points;
  points.reserve(count);
  double before = 0;
  for (std::size_t f = 0; f < faces.size() && points.size() < count; ++f) {
    const Vec3 &a = vertices[faces[f][0]], &b = vertices[faces[f][1]], &c = vertices[faces[f][2]];
    const double own = doubled_area(faces[f]);
    const bool last = f + 1 == faces.size(); // what rounding leaves over
    while (points.size() < count && own > 0 &&
           (last || (double(points.size()) + 0.5) / double(count) * total < before + own)) {
      const auto k = double(points.size());
      double u = std::fmod(0.5 + k * 0.7548776662466927, 1), v = std::fmod(0.5 + k * 0.5698402909980532, 1);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      points.push_back(a + u * (b - a) + v * (c - a));
    }
    before += own;
  }
  // A last face without area: the rest repeats the last point.
  while (!points.empty() && points.size() < count) points.push_back(points.back());
  return points;
}

SurfaceDistance surface_distance(std::span<const Vec3> vertices, std::span<const Face> faces,
                                 std::span<const Vec3> other_vertices, std::span<const Face> other_faces,
                                 std::size_t samples, unsigned threads, Monitor& monitor) {
  require_surface(vertices, faces);
  require_surface(other_vertices, other_faces);
  if (samples == 0) throw Error(Fault::bad_argument, "a distance takes at least one sample");
  const auto backend = make_cpu_backend(threads);
  const auto own = backend->distance_field(vertices, faces),
             other = backend->distance_field(other_vertices, other_faces);
  SurfaceDistance result;
  result.forth = one_way(vertices, faces, *other, samples, monitor);
  result.back = one_way(other_vertices, other_faces, *own, samples, monitor);
  return result;
}

} // namespace cowgpu

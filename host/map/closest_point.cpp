#include "host/map/closest_point.hpp"

#include "host/backend.hpp"
#include "host/error.hpp"
#include "host/geometry/orientation.hpp"
#include "host/sphere_directions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace cowgpu {
namespace {

// Points asked for together, about: they take 120 bytes each.
constexpr std::size_t together = std::size_t(1) << 20;

} // namespace

SphereSamples closest_samples(std::span<const Vec3> positions, std::span<const Face> faces, const SphereGrid& grid,
                              Monitor& monitor) {
  if (faces.empty())
    throw Error(Fault::bad_argument, "a map without faces has no closest point: pass the faces of its mesh");
  SphereSamples result;
  std::vector<std::uint8_t> flipped;
  for (const Face& face : faces) {
    for (const std::uint32_t v : face)
      if (v >= positions.size())
        throw Error(Fault::bad_argument,
                    fmt::format("a face names vertex {}, but there are {} vertices: pass the faces of this mesh", v,
                                positions.size()));
    const int sign = orientation(positions[face[0]], positions[face[1]], positions[face[2]]);
    flipped.push_back(sign < 0);
    result.flipped_faces += sign < 0;
    result.flat_faces += sign == 0;
  }
  result.rings = grid.rings;
  result.ring_length = grid.ring_length;
  result.faces.resize(grid.points());
  result.weights.resize(grid.points());
  const SphereDirections directions(grid);
  const auto field = make_cpu_backend()->distance_field(positions, faces);
  const std::size_t length = std::size_t(grid.ring_length), rings = std::max<std::size_t>(1, together / length);
  std::vector<Vec3> queries;
  for (std::size_t first = 0; first < std::size_t(grid.rings); first += rings) {
    queries.clear();
    for (std::size_t i = first; i < std::min(first + rings, std::size_t(grid.rings)); ++i)
      for (int j = 0; j < grid.ring_length; ++j) queries.push_back(directions(int(i), j));
    const ClosestPoints found = field->closest(queries, {.with_sign = false}, monitor);
    for (std::size_t k = 0; k < queries.size(); ++k) {
      const Vec3& w = found.barycentric[k];
      result.faces[first * length + k] = found.face[k];
      result.weights[first * length + k] = {w[0], w[1], w[2]};
    }
  }
  std::vector<std::uint8_t> hit(faces.size(), 0);
  for (const std::uint32_t f : result.faces) {
    hit[f] = 1;
    result.flipped_points += flipped[f];
  }
  result.faces_hit = std::accumulate(hit.begin(), hit.end(), std::uint64_t(0));
  return result;
}

} // namespace cowgpu

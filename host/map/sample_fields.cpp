#include "host/map/sample_fields.hpp"

#include "host/error.hpp"
#include "host/parallel.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

void check_faces(const SphereSamples& samples, std::span<const Face> faces, std::size_t vertices) {
  if (std::any_of(samples.faces.begin(), samples.faces.end(), [&](std::uint32_t f) { return f >= faces.size(); }))
    throw Error(Fault::bad_argument,
                fmt::format("the samples name faces beyond the {} given: pass the faces of the mesh that was sampled",
                            faces.size()));
  for (const Face& face : faces)
    for (const std::uint32_t v : face)
      if (v >= vertices)
        throw Error(
            Fault::bad_argument,
            fmt::format("a face names vertex {}, but there are {} vertices: pass the faces of this mesh", v, vertices));
}

// value(vertex, field) over all points; fields one after the other.
template <class Value>
std::vector<double> interpolate(const SphereSamples& samples, std::span<const Face> faces, std::size_t fields,
                                const Value& value) {
  const std::size_t points = samples.points();
  constexpr std::size_t chunk = 16384;
  std::vector<double> result(fields * points);
  parallel_for(0, (points + chunk - 1) / chunk, [&](std::size_t task, unsigned) {
    for (std::size_t p = task * chunk; p < std::min(points, (task + 1) * chunk); ++p) {
      const Face& face = faces[samples.faces[p]];
      const auto& w = samples.weights[p];
      for (std::size_t f = 0; f < fields; ++f)
        result[f * points + p] = (w[0] * value(face[0], f) + w[1] * value(face[1], f)) + w[2] * value(face[2], f);
    }
  });
  return result;
}

} // namespace

std::vector<double> sample_fields(const SphereSamples& samples, std::span<const Face> faces,
                                  std::span<const double> values, std::size_t vertices) {
  if (vertices == 0 || values.size() % vertices != 0)
    throw Error(Fault::bad_argument,
                fmt::format("{} values are not a whole number of fields on {} vertices", values.size(), vertices));
  check_faces(samples, faces, vertices);
  return interpolate(samples, faces, values.size() / vertices,
                     [&](std::uint32_t v, std::size_t f) { return values[f * vertices + v]; });
}

std::vector<double> sample_positions(const SphereSamples& samples, std::span<const Face> faces,
                                     std::span<const Vec3> vertices) {
  check_faces(samples, faces, vertices.size());
  return interpolate(samples, faces, 3, [&](std::uint32_t v, std::size_t f) { return vertices[v][Eigen::Index(f)]; });
}

} // namespace cowgpu

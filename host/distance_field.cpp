#include "host/distance_field.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace cowgpu {
namespace {

constexpr double largest_coordinate = 1e100, smallest_extent = 1e-100;

} // namespace

std::string_view name(SurfaceFeature::Kind kind) {
  switch (kind) {
  case SurfaceFeature::Kind::vertex: return "vertex";
  case SurfaceFeature::Kind::edge: return "edge";
  case SurfaceFeature::Kind::face: break;
  }
  return "face";
}

void check_distance_surface(std::span<const Vec3> vertices, std::span<const Face> faces) {
  if (faces.empty()) throw Error(Fault::mesh_empty, "a surface without faces has no distance from anything");
  Vec3 low = Vec3::Constant(largest_coordinate), high = -low;
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const std::uint32_t v : faces[f]) {
      if (v >= vertices.size())
        throw Error(Fault::mesh_index_range,
                    fmt::format("face {} names vertex {}, but there are {} vertices", f, v, vertices.size()));
      if (!vertices[v].allFinite())
        throw Error(Fault::mesh_not_finite, fmt::format("vertex {} has a coordinate that is not finite", v));
      low = low.cwiseMin(vertices[v]);
      high = high.cwiseMax(vertices[v]);
    }
  const double largest = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  const double extent = (high - low).maxCoeff();
  if (!(largest <= largest_coordinate) || (extent > 0 && extent < smallest_extent))
    throw Error(Fault::mesh_range,
                fmt::format("the largest coordinate is {:.3g} and the longest side of the box {:.3g}; distances can be "
                            "measured up to {:.0e} and from {:.0e} on: scale the mesh",
                            largest, extent, largest_coordinate, smallest_extent));
}

void check_queries(std::span<const Vec3> queries) {
  for (std::size_t i = 0; i < queries.size(); ++i)
    if (!(queries[i].cwiseAbs().maxCoeff() <= largest_coordinate) || !queries[i].allFinite())
      throw Error(Fault::bad_argument,
                  fmt::format("point {} of {} has a coordinate that is not finite or beyond {:.0e}", i, queries.size(),
                              largest_coordinate));
}

} // namespace cowgpu

// Values on a grid from values at the vertices of a mapped surface.
#pragma once

#include "host/sphere_samples.hpp"
#include "host/types.hpp"

#include <span>
#include <vector>

namespace cowgpu {

/// Interpolates linearly over the triangles: value = sum over the face's corners of weight times vertex value.
/// `values`: [field][vertex], `vertices` of them a field; the result is [field][ring][longitude]. Throws
/// Error(bad_argument) for a size that is no multiple of `vertices` or a face that names no vertex.
std::vector<double> sample_fields(const SphereSamples& samples, std::span<const Face> faces,
                                  std::span<const double> values, std::size_t vertices);

/// The same of positions: fields x, y, z.
std::vector<double> sample_positions(const SphereSamples& samples, std::span<const Face> faces,
                                     std::span<const Vec3> vertices);

} // namespace cowgpu

// The kernels sample and sample_weights: which triangle holds each point of a band of rings, and where. The mathematics
// stands in host/plan/sample.hpp, the shaders' interface in shaders/sample.h.
#pragma once

#include "engine/gpu.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::engine {

/// Points of a ring that a triangle may hold.
struct SampleSpan {
  std::uint32_t triangle, ring, first, count;
};

/// Most points of a span.
std::uint32_t sample_span_points();

/// A band of rings.
struct SampleInput {
  std::span<const SampleSpan> spans;
  std::span<const double> corners;    ///< [triangle][9], counter-clockwise
  std::span<const double> rings;      ///< [ring][2]: sin theta, cos theta
  std::span<const double> longitudes; ///< [point of a ring][2]: cos phi, sin phi
  double filter = 0;
};

struct SampleOutput {
  std::vector<std::uint32_t> owners; ///< [ring][longitude]: triangles - least triangle that holds the point; 0: none
  std::vector<std::uint32_t> folded; ///< [ring][longitude]: not 0 where several do
  std::vector<double> weights;       ///< [ring][longitude][3], as the corners stand in the input
  std::vector<std::array<std::uint32_t, 2>> open; ///< pairs (point, triangle) not decided, in no order
};

/// Bytes sample() keeps on the device.
std::uint64_t sample_device_bytes(std::uint64_t points, std::uint64_t triangles, std::uint64_t spans);

/// Throws Error(out_of_range) beyond the device's limits, Error(cut_short), Error(vulkan), Error(device_lost).
void sample(Device& device, const SampleInput& input, SampleOutput& output);

} // namespace cowgpu::engine

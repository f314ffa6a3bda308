#include "engine/kernels/sample.hpp"

#include "engine/job.hpp"
#include "shaders/sample.h"
#include "shaders/sample.hpp"
#include "shaders/sample_weights.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu::engine {
namespace {

constexpr std::uint32_t first_capacity = 1U << 16; // pairs
constexpr std::uint32_t spans_per_dispatch = 1U << 20;

template <class T>
std::span<const std::byte> push_bytes(const T& push) {
  return std::as_bytes(std::span(&push, 1));
}

std::uint64_t open_bytes(std::uint64_t capacity) {
  return 8 + 8 * capacity;
}

} // namespace

std::uint32_t sample_span_points() {
  return SAMPLE_SPAN_POINTS;
}

std::uint64_t sample_device_bytes(std::uint64_t points, std::uint64_t triangles, std::uint64_t spans) {
  return points * (4 + 4 + 24 + 32) + 72 * triangles + sizeof(SampleSpan) * spans + open_bytes(first_capacity);
}

void sample(Device& device, const SampleInput& input, SampleOutput& output) {
  static_assert(sizeof(SampleSpan) == 16);
  const auto triangles = std::uint32_t(input.corners.size() / 9), spans = std::uint32_t(input.spans.size());
  const auto ring_length = std::uint32_t(input.longitudes.size() / 2);
  const auto points = std::uint32_t(input.rings.size() / 2 * ring_length);
  output.owners.assign(points, 0);
  output.folded.assign(points, 0);
  output.weights.assign(3 * std::size_t(points), 0.0);
  output.open.clear();
  if (spans == 0) return;

  const std::uint32_t lanes = std::clamp(device.physical().subgroup_size, 8U, 64U);
  const Kernel& kernel =
      device.kernel({"sample", shaders::sample, SAMPLE_BINDINGS, sizeof(shaders::SamplePush), {lanes}});
  const Kernel& weights_kernel = device.kernel(
      {"sample_weights", shaders::sample_weights, SAMPLE_WEIGHTS_BINDINGS, sizeof(shaders::SampleWeightsPush), {64}});
  Buffer span_buffer(device, input.spans.size_bytes(), "the spans");
  Buffer corners(device, input.corners.size_bytes(), "the triangles");
  Buffer rings(device, input.rings.size_bytes(), "the rings");
  Buffer longitudes(device, input.longitudes.size_bytes(), "the longitudes");
  Buffer owners(device, 4 * std::uint64_t(points), "the points' triangles");
  Buffer folded(device, 4 * std::uint64_t(points), "the points' folds");
  Buffer weights(device, 24 * std::uint64_t(points), "the points' weights");
  span_buffer.write(std::as_bytes(input.spans));
  corners.write(std::as_bytes(input.corners));
  rings.write(std::as_bytes(input.rings));
  longitudes.write(std::as_bytes(input.longitudes));

  std::uint64_t planned = 0;
  for (const SampleSpan& span : input.spans) planned += span.count;
  // Where the list of open pairs was too short, once more with room for all of them.
  for (std::uint64_t capacity = first_capacity;;) {
    Buffer open(device, open_bytes(capacity), "the open pairs");
    owners.clear();
    folded.clear();
    open.clear();
    Job job(device);
    for (std::uint32_t first = 0; first < spans; first += spans_per_dispatch) {
      const std::uint32_t end = std::min(spans, first + spans_per_dispatch);
      const shaders::SamplePush push = {input.filter, first, end, ring_length, triangles, std::uint32_t(capacity)};
      const BufferRange ranges[SAMPLE_BINDINGS] = {{&span_buffer}, {&corners}, {&rings}, {&longitudes},
                                                   {&owners},      {&folded},  {&open}};
      job.dispatch(kernel, ranges, push_bytes(push),
                   (end - first + SAMPLE_SPANS_PER_GROUP - 1) / SAMPLE_SPANS_PER_GROUP);
    }
    const shaders::SampleWeightsPush push = {points, ring_length, triangles};
    const BufferRange ranges[SAMPLE_WEIGHTS_BINDINGS] = {{&corners}, {&rings}, {&longitudes}, {&owners}, {&weights}};
    constexpr std::uint32_t per_group = 64 * SAMPLE_WEIGHTS_POINTS;
    job.dispatch(weights_kernel, ranges, push_bytes(push), (points + per_group - 1) / per_group);
    job.run();

    std::uint32_t counts[2] = {};
    open.read(std::as_writable_bytes(std::span(counts)));
    if (counts[0] != std::uint32_t(planned))
      throw Error(Failure::cut_short, 0,
                  fmt::format("the device {} ended a loop early: it looked at {} of {} candidates; the result would be "
                              "wrong; use --device cpu and report this",
                              device.name(), counts[0], planned));
    if (counts[1] > capacity) {
      capacity = counts[1];
      continue;
    }
    output.open.resize(counts[1]);
    open.read(std::as_writable_bytes(std::span(output.open)), 8);
    break;
  }
  owners.read(std::as_writable_bytes(std::span(output.owners)));
  folded.read(std::as_writable_bytes(std::span(output.folded)));
  weights.read(std::as_writable_bytes(std::span(output.weights)));
}

} // namespace cowgpu::engine

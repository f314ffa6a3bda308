#include "engine/kernels/closest.hpp"

#include "engine/host_buffer.hpp"
#include "engine/job.hpp"
#include "shaders/closest.h"
#include "shaders/closest.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu::engine {
namespace {

constexpr std::uint32_t width = 64; // lanes a workgroup
constexpr std::uint64_t candidates_a_lane = 16;
constexpr std::uint64_t texel_bytes = 16, node_bytes = texel_bytes * CLOSEST_NODE_TEXELS,
                        triangle_bytes = texel_bytes * CLOSEST_TRIANGLE_TEXELS;
constexpr std::uint64_t query_bytes = 12 * closest_queries;
constexpr float unreachable = 1e30F;

static_assert(closest_left == CLOSEST_LEFT && most_closest_candidates == CLOSEST_LIST);
static_assert(sizeof(ClosestLane) == 8 && sizeof(ClosestCandidate) == 4);

// Steps that fit in the budget. Invocations that run in step take as long as the slowest of them: in every step a loop over
// two leaves, and loops that take waiting nodes up again, of which all of them together have put down one each.
std::uint32_t steps_within(std::uint32_t budget, std::uint32_t in_step) {
  constexpr std::uint32_t lists = (CLOSEST_ROUNDS + 1) * (CLOSEST_LIST + 2);
  return budget < lists ? 0 : (budget - lists) / (2 * CLOSEST_LEAF + 4 + in_step);
}

} // namespace

struct Closest::Batch {
  Batch(Device& device, std::uint32_t lanes)
      : capacity(lanes), queries(device, lanes * query_bytes, "the queries"),
        found(device, lanes * sizeof(ClosestLane), "the queries' candidates"),
        candidates(device, 4 + 4 * candidates_a_lane * lanes, "the candidates") {}

  std::uint32_t capacity; // lanes
  HostBuffer queries, found, candidates;
};

std::uint64_t Closest::tree_bytes(std::uint64_t nodes, std::uint64_t triangles) {
  return nodes * node_bytes + triangles * triangle_bytes;
}

std::uint64_t Closest::batch_bytes(std::uint64_t lanes) {
  return lanes * (query_bytes + sizeof(ClosestLane) + 4 * candidates_a_lane) + 64;
}

Closest::Closest(Device& device, const ClosestInput& input) : device_(device), margin_(input.margin) {
  const std::uint64_t triangles = input.triangles.size_bytes() / triangle_bytes;
  const std::uint64_t texels = std::max(input.triangles.size_bytes(), input.nodes.size_bytes()) / texel_bytes;
  if (triangles >> CLOSEST_TRIANGLE_BITS || texels > device.limits().maxTexelBufferElements)
    throw Error(
        Failure::out_of_range, 0,
        fmt::format("a tree over {} triangles is more than the device {} searches, which reads {} texels from a "
                    "buffer; use --device cpu",
                    triangles, device.name(), device.limits().maxTexelBufferElements));
  steps_ = steps_within(input.iteration_budget, device.physical().subgroup_size);
  if (steps_ < CLOSEST_STACK)
    throw Error(Failure::out_of_range, 0,
                fmt::format("{} loop iterations an invocation leave {} steps for a search; {} are the least",
                            input.iteration_budget, steps_, CLOSEST_STACK));
  kernel_ = &device.kernel({"closest",
                            shaders::closest,
                            CLOSEST_BINDINGS,
                            sizeof(shaders::ClosestPush),
                            {width},
                            {BindingKind::texel_doubles, BindingKind::texel_doubles}});
  nodes_ = std::make_unique<Buffer>(device, input.nodes.size_bytes(), "the tree");
  triangles_ = std::make_unique<Buffer>(device, input.triangles.size_bytes(), "the triangles");
  nodes_->write(std::as_bytes(input.nodes));
  triangles_->write(std::as_bytes(input.triangles));
}

Closest::~Closest() = default;

std::span<float> Closest::queries(std::uint32_t lanes) {
  if (!batch_ || batch_->capacity < lanes) {
    batch_.reset();
    batch_ = std::make_unique<Batch>(device_, lanes);
  }
  lanes_ = lanes;
  return batch_->queries.host<float>().first(3 * closest_queries * lanes);
}

void Closest::search() {
  Job job(device_);
  record(job);
  job.run();
  finish();
}

void Closest::record(Job& job) {
  const auto capacity = std::uint32_t(candidates_a_lane * batch_->capacity);
  const shaders::ClosestPush push = {margin_, unreachable, lanes_, steps_, capacity};
  const BufferRange ranges[CLOSEST_BINDINGS] = {{nodes_.get()},
                                                {triangles_.get()},
                                                {&batch_->queries.buffer()},
                                                {&batch_->found.buffer()},
                                                {&batch_->candidates.buffer()}};
  batch_->queries.send();
  batch_->candidates.host<std::uint32_t>()[0] = 0;
  batch_->candidates.send();
  job.dispatch(*kernel_, ranges, std::as_bytes(std::span(&push, 1)), (lanes_ + width - 1) / width);
}

const Buffer& Closest::lanes_buffer() const {
  return batch_->found.buffer();
}

const Buffer& Closest::candidates_buffer() const {
  return batch_->candidates.buffer();
}

void Closest::finish() {
  batch_->found.receive();
  batch_->candidates.receive();
  const auto found = lanes();
  const auto cut =
      std::count_if(found.begin(), found.end(), [](const ClosestLane& lane) { return lane.candidates == CLOSEST_CUT; });
  if (cut > 0)
    throw Error(
        Failure::cut_short, 0,
        fmt::format("the device {} ended a loop early: {} of {} searches were not finished; the result would be "
                    "wrong; use --device cpu and report this",
                    device_.name(), cut, lanes_));
}

std::span<const ClosestLane> Closest::lanes() {
  return batch_->found.host<ClosestLane>().first(lanes_);
}

std::span<const ClosestCandidate> Closest::candidates() {
  return batch_->candidates.host<ClosestCandidate>().subspan(1);
}

} // namespace cowgpu::engine

#include "engine/kernels/flow.hpp"

#include "engine/host_buffer.hpp"
#include "engine/job.hpp"
#include "shaders/flow.h"
#include "shaders/flow.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu::engine {
namespace {

constexpr std::uint32_t width = 64;                             // points a workgroup
constexpr std::uint32_t most_turns = 16, most_sheet_turns = 16; // turns of a point in one pass
constexpr std::uint64_t frame_bytes = 16 * FLOW_FRAME_TEXELS;

static_assert(sizeof(FlowTask) == sizeof(shaders::FlowEntry) && sizeof(FlowPlace) == sizeof(shaders::FlowPoint));
static_assert(std::uint32_t(FlowWhat::resume) == FLOW_RESUME && std::uint32_t(FlowAsks::last) == FLOW_LAST &&
              std::uint32_t(FlowStatus::cut) == FLOW_CUT && flow_no_face == FLOW_NO_FACE);
static_assert(FlowPlace::inside == FLOW_INSIDE && FlowPlace::tighter == FLOW_TIGHTER &&
              FlowPlace::recorded == FLOW_RECORDED && FlowPlace::on_sheet == FLOW_ON_SHEET);

} // namespace

struct Flow::Batch {
  Batch(Device& device, std::uint32_t points)
      : capacity(points), numbers(device, 8ULL * FLOW_STATE_NUMBERS * points, "the points' numbers"),
        words(device, 4ULL * FLOW_STATE_WORDS * points, "the points' words"),
        places(device, sizeof(FlowPlace) * points, "the points"),
        tasks(device, sizeof(FlowTask) * points, "the points' tasks") {}

  std::uint32_t capacity;
  Buffer numbers, words;
  HostBuffer places, tasks;
};

std::uint64_t Flow::surface_bytes(std::uint64_t faces) {
  return faces * (frame_bytes + 4);
}

std::uint64_t Flow::batch_bytes(std::uint64_t points) {
  return points * (8 * FLOW_STATE_NUMBERS + 4 * FLOW_STATE_WORDS + sizeof(FlowPlace) + sizeof(FlowTask)) + 64;
}

Flow::Flow(Device& device, const FlowInput& input) : device_(device) {
  const std::uint64_t texels = input.frames.size_bytes() / 16;
  if (texels > device.limits().maxTexelBufferElements)
    throw Error(
        Failure::out_of_range, 0,
        fmt::format("a surface of {} triangles is more than the device {} flows off, which reads {} texels from "
                    "a buffer; use --device cpu",
                    texels / FLOW_FRAME_TEXELS, device.name(), device.limits().maxTexelBufferElements));
  // However invocations run in step, a turn makes no more than this.
  if (input.iteration_budget >= FLOW_OTHER_ITERATIONS)
    turns_ = std::min(most_turns, (input.iteration_budget - FLOW_OTHER_ITERATIONS) / (FLOW_TURN_ITERATIONS + 1));
  if (turns_ == 0)
    throw Error(Failure::out_of_range, 0,
                fmt::format("{} loop iterations an invocation leave a point of a flow no turn; {} are the least",
                            input.iteration_budget, FLOW_OTHER_ITERATIONS + FLOW_TURN_ITERATIONS + 1));
  sheet_turns_ = std::min(most_sheet_turns, input.iteration_budget - FLOW_OTHER_ITERATIONS);
  const auto kernel = [&](const char* name, bool sheet) {
    return &device.kernel({name,
                           shaders::flow,
                           FLOW_BINDINGS,
                           sizeof(shaders::FlowPush),
                           {width, sheet ? 1U : 0U},
                           {BindingKind::texel_doubles}});
  };
  kernel_ = kernel("flow", false);
  sheet_kernel_ = kernel("flow_sheet", true);
  frames_ = std::make_unique<Buffer>(device, input.frames.size_bytes(), "the triangles' frames");
  face_of_ = std::make_unique<Buffer>(device, input.face_of.size_bytes(), "the triangles' faces");
  frames_->write(std::as_bytes(input.frames));
  face_of_->write(std::as_bytes(input.face_of));
}

Flow::~Flow() = default;

void Flow::reserve(std::uint32_t points) {
  if (batch_ && batch_->capacity >= points) return;
  batch_.reset();
  batch_ = std::make_unique<Batch>(device_, points);
}

std::span<FlowPlace> Flow::places() {
  return batch_->places.host<FlowPlace>();
}

std::span<FlowTask> Flow::tasks() {
  return batch_->tasks.host<FlowTask>();
}

void Flow::pass(Closest& closest, bool search, const FlowNumbers& n, std::uint32_t tasks, std::uint32_t sheets) {
  shaders::FlowPush push = {n.time,
                            n.time_reached,
                            n.scale,
                            {n.tolerance[0], n.tolerance[1]},
                            {n.longest[0], n.longest[1]},
                            {n.rounds[0], n.rounds[1]},
                            tasks - sheets,
                            batch_->capacity,
                            turns_,
                            0};
  const BufferRange ranges[FLOW_BINDINGS] = {
      {frames_.get()},  {&closest.lanes_buffer()}, {&closest.candidates_buffer()},
      {face_of_.get()}, {&batch_->tasks.buffer()}, {&batch_->numbers},
      {&batch_->words}, {&batch_->places.buffer()}};
  batch_->places.send();
  batch_->tasks.send();
  Job job(device_);
  if (search) closest.record(job);
  job.dispatch(*kernel_, ranges, std::as_bytes(std::span(&push, 1)), (push.entries + width - 1) / width);
  push.first = push.entries;
  push.entries = sheets;
  push.turns = sheet_turns_;
  job.dispatch(*sheet_kernel_, ranges, std::as_bytes(std::span(&push, 1)), (sheets + width - 1) / width);
  job.run();
  batch_->places.receive();
  std::size_t cut = 0;
  const auto all = places();
  for (const FlowTask& task : this->tasks().first(tasks)) cut += all[task.place].status == FlowStatus::cut;
  if (cut > 0)
    throw Error(
        Failure::cut_short, 0,
        fmt::format("the device {} ended a loop early, or named no candidate for a closest face: {} of {} points "
                    "were not advanced; the result would be wrong; use --device cpu and report this",
                    device_.name(), cut, tasks));
}

} // namespace cowgpu::engine

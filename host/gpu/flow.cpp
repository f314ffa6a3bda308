#include "host/gpu/flow.hpp"

#include "host/cpu/flow.hpp"
#include "host/cpu/flow_call.hpp"
#include "host/gpu/closest_faces.hpp"
#include "host/parallel.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace cowgpu::gpu {
namespace {

constexpr std::size_t most_live = std::size_t(1) << 15; // points on their way at once
constexpr std::size_t few_live = 128; // so few are the host's: a pass would cost more than their queries
constexpr std::size_t part = 256;     // points a thread takes at a time
static_assert(most_live <= ClosestFaces::batch && part % ClosestFaces::lane_queries == 0);

// The points on their way.
class Wavefront {
public:
  Wavefront(cpu::FlowCall& call, const cpu::FlowSurface& surface, ClosestFaces& faces)
      : call_(call), surface_(surface), faces_(faces) {}

  void run(Monitor& monitor, FlowReport& report) {
    const auto size = double(std::max<std::size_t>(1, call_.size()));
    for (fill(); live_.size() > few_live; fill()) {
      check_stop(monitor);
      monitor.progress("flowing points", double(next_ - live_.size()) / size);
      pass();
      ++report.passes;
      report.device_queries += live_.size();
    }
    parallel_for(0, live_.size(), [&](std::size_t i, unsigned) {
      check_stop(monitor);
      cpu::FlowRun& run = live_[i];
      while (!run.done()) run.answer(surface_.nearest(run.query(), run.warm()));
    });
    monitor.progress("flowing points", 1);
  }

private:
  // Those that ended give their places to new starts, or to the last ones.
  void fill() {
    const auto order = call_.order();
    for (std::size_t i = 0; i < live_.size();) {
      if (!live_[i].done()) {
        ++i;
      } else if (next_ < order.size()) {
        live_[i++] = cpu::FlowRun(call_, order[next_++]);
      } else {
        if (i + 1 < live_.size()) live_[i] = std::move(live_.back());
        live_.pop_back();
      }
    }
    live_.reserve(std::min(most_live, order.size()));
    while (live_.size() < most_live && next_ < order.size()) live_.emplace_back(call_, order[next_++]);
  }

  // One query of each.
  void pass() {
    queries_.resize(live_.size());
    for (std::size_t i = 0; i < live_.size(); ++i) queries_[i] = live_[i].query();
    const std::vector<std::uint32_t> order = surface_.order(queries_, 0);
    faces_.search(queries_, order);
    parallel_for(0, (order.size() + part - 1) / part, [&](std::size_t task, unsigned) {
      const std::size_t first = task * part, count = std::min(part, order.size() - first);
      std::array<Vec3, part> points;
      std::array<std::uint32_t, part> found;
      for (std::size_t i = 0; i < count; ++i) points[i] = queries_[order[first + i]];
      faces_.decide(first, std::span(points).first(count), found.data());
      for (std::size_t i = 0; i < count; ++i) live_[order[first + i]].answer(found[i]);
    });
  }

  cpu::FlowCall& call_;
  const cpu::FlowSurface& surface_;
  ClosestFaces& faces_;
  std::vector<cpu::FlowRun> live_;
  std::vector<Vec3> queries_;
  std::size_t next_ = 0; // of the call's order
};

class GpuFlow final : public DistanceFlow {
public:
  GpuFlow(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget, std::span<const Vec3> vertices,
          std::span<const Face> faces)
      : surface_(vertices, faces), faces_(std::move(gpu), iteration_budget, surface_.tree()) {}

  FlowPoints flow(std::span<const Vec3> starts, std::span<const Vec3> normals, const FlowOptions& options,
                  Monitor& monitor, FlowReport* report) override {
    cpu::FlowCall call(surface_, starts, normals, options, 0);
    faces_.device().take_profile();
    FlowReport passes;
    Wavefront(call, surface_, faces_).run(monitor, passes);
    FlowPoints points = call.finish(report);
    if (report) {
      report->passes = passes.passes;
      report->device_queries = passes.device_queries;
      for (const auto& k : faces_.device().take_profile())
        report->kernels.push_back({k.kernel, k.dispatches, k.seconds});
    }
    return points;
  }

private:
  cpu::FlowSurface surface_;
  ClosestFaces faces_;
};

} // namespace

std::unique_ptr<DistanceFlow> distance_flow(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget,
                                            std::span<const Vec3> vertices, std::span<const Face> faces) {
  return std::make_unique<GpuFlow>(std::move(gpu), iteration_budget, vertices, faces);
}

MemoryNeed distance_flow_memory(std::uint64_t vertices, std::uint64_t faces, std::uint64_t starts) {
  const std::uint64_t live = std::min<std::uint64_t>(starts, most_live);
  MemoryNeed need;
  need.device = ClosestFaces::device_bytes(faces, live);
  // The device's tree is built beside a tree of boxes, and both are given up.
  need.host = cpu::distance_flow_bytes(vertices, faces, starts) + 360 * faces + need.device +
              live * (sizeof(cpu::FlowRun) + sizeof(Vec3) + 20);
  return need;
}

} // namespace cowgpu::gpu

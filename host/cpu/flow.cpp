#include "host/cpu/flow.hpp"

#include "host/parallel.hpp"
#include "host/plan/flow_call.hpp"

#include <algorithm>
#include <optional>

namespace cowgpu::cpu {
namespace {

constexpr std::size_t batch = 512;

class CpuFlow final : public DistanceFlow {
public:
  CpuFlow(std::span<const Vec3> vertices, std::span<const Face> faces, unsigned threads)
      : vertices_(vertices), faces_(faces), threads_(threads) {}

  MemoryNeed memory(std::uint64_t starts) const override {
    return {plan::distance_flow_bytes(vertices_.size(), faces_.size(), starts), 0};
  }

  void prepare() override {
    if (!surface_) surface_.emplace(vertices_, faces_);
  }

  FlowPoints flow(std::span<const Vec3> starts, std::span<const Vec3> normals, const FlowOptions& options,
                  Monitor& monitor, FlowReport* report) override {
    prepare();
    plan::FlowCall call(*surface_, starts, normals, options, threads_);
    const std::size_t tasks = (call.size() + batch - 1) / batch;
    parallel_for(threads_, tasks, [&](std::size_t task, unsigned thread) {
      if (thread == 0) monitor.progress("flowing points", double(task) / double(tasks));
      const std::size_t first = task * batch;
      std::uint32_t near = no_face;
      for (std::size_t i = first; i < std::min(call.size(), first + batch); ++i) {
        if (i % 64 == 0) check_stop(monitor);
        plan::FlowRun run(call, call.order()[i]);
        near = surface_->nearest(run.query(), near);
        for (run.answer(near); !run.done();) run.answer(surface_->nearest(run.query(), run.warm()));
      }
    });
    monitor.progress("flowing points", 1);
    return call.finish(report);
  }

private:
  std::span<const Vec3> vertices_;
  std::span<const Face> faces_;
  unsigned threads_;
  std::optional<plan::FlowSurface> surface_;
};

} // namespace

std::unique_ptr<DistanceFlow> distance_flow(std::span<const Vec3> vertices, std::span<const Face> faces,
                                            unsigned threads) {
  return std::make_unique<CpuFlow>(vertices, faces, threads);
}

} // namespace cowgpu::cpu

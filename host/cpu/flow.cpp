#include "host/cpu/flow.hpp"

#include "host/cpu/flow_call.hpp"
#include "host/parallel.hpp"

#include <algorithm>

namespace cowgpu::cpu {
namespace {

constexpr std::size_t batch = 512;

class CpuFlow final : public DistanceFlow {
public:
  CpuFlow(std::span<const Vec3> vertices, std::span<const Face> faces, unsigned threads)
      : surface_(vertices, faces), threads_(threads) {}

  FlowPoints flow(std::span<const Vec3> starts, std::span<const Vec3> normals, const FlowOptions& options,
                  Monitor& monitor, FlowReport* report) override {
    FlowCall call(surface_, starts, normals, options, threads_);
    const std::size_t tasks = (call.size() + batch - 1) / batch;
    parallel_for(threads_, tasks, [&](std::size_t task, unsigned thread) {
      if (thread == 0) monitor.progress("flowing points", double(task) / double(tasks));
      const std::size_t first = task * batch;
      std::uint32_t near = no_face;
      for (std::size_t i = first; i < std::min(call.size(), first + batch); ++i) {
        if (i % 64 == 0) check_stop(monitor);
        FlowRun run(call, call.order()[i]);
        near = surface_.nearest(run.query(), near);
        for (run.answer(near); !run.done();) run.answer(surface_.nearest(run.query(), run.warm()));
      }
    });
    monitor.progress("flowing points", 1);
    return call.finish(report);
  }

private:
  FlowSurface surface_;
  unsigned threads_;
};

} // namespace

std::unique_ptr<DistanceFlow> distance_flow(std::span<const Vec3> vertices, std::span<const Face> faces,
                                            unsigned threads) {
  return std::make_unique<CpuFlow>(vertices, faces, threads);
}

std::uint64_t distance_flow_bytes(std::uint64_t vertices, std::uint64_t faces, std::uint64_t starts) {
  constexpr std::uint64_t frame = sizeof(plan::TriangleFrame<double>) + sizeof(Vec3);
  constexpr std::uint64_t one = 2 * sizeof(Vec3) + 2 * sizeof(double) + 2 * sizeof(std::uint32_t) + 1;
  return plan::ClosestTree::bytes(faces, vertices) + faces * frame + starts * (one + 20);
}

} // namespace cowgpu::cpu

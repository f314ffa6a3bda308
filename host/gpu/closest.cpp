#include "host/gpu/closest.hpp"

#include "host/gpu/closest_faces.hpp"
#include "host/plan/closest_call.hpp"

#include <algorithm>
#include <utility>

namespace cowgpu::gpu {
namespace {

constexpr std::size_t batch = ClosestFaces::batch;
static_assert(batch % plan::ClosestCall::part == 0);

class GpuDistanceField final : public DistanceField {
public:
  GpuDistanceField(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget, std::span<const Vec3> vertices,
                   std::span<const Face> faces)
      : tree_(vertices, faces), faces_(std::move(gpu), iteration_budget, tree_) {}

  ClosestPoints closest(std::span<const Vec3> queries, const ClosestOptions& options, Monitor& monitor,
                        ClosestReport* report) override {
    plan::ClosestCall call(tree_, queries, options, 0);
    const engine::StopScope stop(faces_.device(), [&monitor] { return monitor.stopped(); });
    faces_.device().take_profile();
    for (std::size_t begin = 0; begin < queries.size(); begin += batch) {
      check_stop(monitor);
      const std::size_t end = std::min(queries.size(), begin + batch);
      faces_.search(queries, call.order().subspan(begin, end - begin));
      call.each_part(begin, end, monitor, [&](std::span<const Vec3> points, std::size_t first, std::uint32_t* found) {
        faces_.decide(first - begin, points, found);
      });
    }
    ClosestPoints result = call.finish(report);
    if (report)
      for (const auto& k : faces_.device().take_profile())
        report->kernels.push_back({k.kernel, k.dispatches, k.seconds});
    return result;
  }

private:
  plan::ClosestTree tree_;
  ClosestFaces faces_;
};

} // namespace

std::unique_ptr<DistanceField> distance_field(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget,
                                              std::span<const Vec3> vertices, std::span<const Face> faces) {
  return std::make_unique<GpuDistanceField>(std::move(gpu), iteration_budget, vertices, faces);
}

MemoryNeed distance_field_memory(std::uint64_t vertices, std::uint64_t faces, std::uint64_t queries) {
  const std::uint64_t at_once = std::min<std::uint64_t>(queries, batch);
  MemoryNeed need;
  need.device = ClosestFaces::device_bytes(faces, at_once);
  // The device's tree is built beside a tree of boxes, and both are given up.
  need.host = plan::distance_field_bytes(vertices, faces, queries) + 360 * faces + need.device;
  return need;
}

} // namespace cowgpu::gpu

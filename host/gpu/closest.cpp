#include "host/gpu/closest.hpp"

#include "host/gpu/closest_faces.hpp"
#include "host/gpu/errors.hpp"
#include "host/plan/closest_call.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace cowgpu::gpu {
namespace {

constexpr std::size_t batch = ClosestFaces::batch;
static_assert(batch % plan::ClosestCall::part == 0);

class GpuDistanceField final : public DistanceField {
public:
  GpuDistanceField(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget, std::span<const Vec3> vertices,
                   std::span<const Face> faces)
      : gpu_(std::move(gpu)), iteration_budget_(iteration_budget), vertices_(vertices), faces_(faces) {}

  MemoryNeed memory(std::uint64_t queries) const override {
    MemoryNeed need;
    need.device = ClosestFaces::device_bytes(faces_.size(), std::min<std::uint64_t>(queries, batch));
    // The device's tree is built beside a tree of boxes, and both are given up.
    need.host =
        plan::distance_field_bytes(vertices_.size(), faces_.size(), queries) + 360 * faces_.size() + need.device;
    return need;
  }

  void prepare() override {
    if (search_) return;
    tree_.emplace(vertices_, faces_);
    translated([&] { search_.emplace(gpu_, iteration_budget_, *tree_); });
  }

  ClosestPoints closest(std::span<const Vec3> queries, const ClosestOptions& options, Monitor& monitor,
                        ClosestReport* report) override {
    prepare();
    plan::ClosestCall call(*tree_, queries, options, 0);
    const engine::StopScope stop(*gpu_, [&monitor] { return monitor.stopped(); });
    gpu_->take_profile();
    for (std::size_t begin = 0; begin < queries.size(); begin += batch) {
      check_stop(monitor);
      const std::size_t end = std::min(queries.size(), begin + batch);
      search_->search(queries, call.order().subspan(begin, end - begin));
      call.each_part(begin, end, monitor, [&](std::span<const Vec3> points, std::size_t first, std::uint32_t* found) {
        search_->decide(first - begin, points, found);
      });
    }
    ClosestPoints result = call.finish(report);
    if (report)
      for (const auto& k : gpu_->take_profile()) report->kernels.push_back({k.kernel, k.dispatches, k.seconds});
    return result;
  }

private:
  std::shared_ptr<engine::Gpu> gpu_;
  std::uint32_t iteration_budget_;
  std::span<const Vec3> vertices_;
  std::span<const Face> faces_;
  std::optional<plan::ClosestTree> tree_;
  std::optional<ClosestFaces> search_;
};

} // namespace

std::unique_ptr<DistanceField> distance_field(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget,
                                              std::span<const Vec3> vertices, std::span<const Face> faces) {
  return std::make_unique<GpuDistanceField>(std::move(gpu), iteration_budget, vertices, faces);
}

} // namespace cowgpu::gpu

#include "host/gpu/closest.hpp"

#include "engine/kernels/closest.hpp"
#include "host/cpu/closest.hpp"
#include "host/cpu/closest_call.hpp"
#include "host/cpu/closest_kernel.hpp"
#include "host/gpu/errors.hpp"
#include "host/parallel.hpp"
#include "host/plan/closest_texels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace cowgpu::gpu {
namespace {

constexpr std::size_t lane_queries = engine::closest_queries, batch = lane_queries * engine::Closest::most_lanes;
static_assert(lane_queries == cpu::most_decided && batch % cpu::ClosestCall::part == 0);

class GpuDistanceField final : public DistanceField {
public:
  GpuDistanceField(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget, std::span<const Vec3> vertices,
                   std::span<const Face> faces)
      : gpu_(std::move(gpu)), tree_(vertices, faces) {
    plan::ClosestTexels texels(tree_);
    engine_ = std::make_unique<engine::Closest>(
        gpu_->device(),
        engine::ClosestInput{texels.nodes, texels.triangles, 2 * plan::closest_margin, iteration_budget});
    slots_ = std::move(texels.slots);
  }

  ClosestPoints closest(std::span<const Vec3> queries, const ClosestOptions& options, Monitor& monitor,
                        ClosestReport* report) override {
    cpu::ClosestCall call(tree_, queries, options, 0);
    gpu_->take_profile();
    for (std::size_t begin = 0; begin < queries.size(); begin += batch) {
      check_stop(monitor);
      const std::size_t end = std::min(queries.size(), begin + batch);
      const auto ids = call.order().subspan(begin, end - begin);
      translated([&] {
        send(queries, ids);
        engine_->search();
      });
      call.each_part(begin, end, monitor, [&](std::span<const Vec3> points, std::size_t first, std::uint32_t* found) {
        for (std::size_t i = 0; i < points.size(); i += lane_queries)
          decide((first - begin + i) / lane_queries, points.subspan(i, std::min(lane_queries, points.size() - i)),
                 found + i);
      });
    }
    ClosestPoints result = call.finish(report);
    if (report)
      for (const auto& k : gpu_->take_profile()) report->kernels.push_back({k.kernel, k.dispatches, k.seconds});
    return result;
  }

private:
  void send(std::span<const Vec3> queries, std::span<const std::uint32_t> ids) {
    const std::size_t lanes = (ids.size() + lane_queries - 1) / lane_queries;
    const std::span<float> to = engine_->queries(std::uint32_t(lanes));
    constexpr std::size_t chunk = 1024;
    parallel_for(0, (lanes + chunk - 1) / chunk, [&](std::size_t task, unsigned) {
      for (std::size_t lane = task * chunk; lane < std::min(lanes, (task + 1) * chunk); ++lane)
        for (std::size_t k = 0; k < lane_queries; ++k) {
          const Vec3& q = queries[ids[std::min(lane * lane_queries + k, ids.size() - 1)]];
          // Far ones are the host's.
          const auto p = tree_.is_far(q) ? std::array<float, 3>{2, 2, 2} : tree_.local(q);
          for (std::size_t c = 0; c < 3; ++c) to[3 * lane_queries * lane + lane_queries * c + k] = p[c];
        }
    });
  }

  // Among a lane's candidates.
  void decide(std::size_t lane, std::span<const Vec3> points, std::uint32_t* faces) {
    const engine::ClosestLane found = engine_->lanes()[lane];
    if (found.candidates == engine::closest_left ||
        std::any_of(points.begin(), points.end(), [&](const Vec3& q) { return tree_.is_far(q); })) {
      for (std::size_t i = 0; i < points.size(); ++i)
        faces[i] = cpu::closest_single(tree_, points[i], std::numeric_limits<double>::infinity(), no_face);
      return;
    }
    std::array<std::uint32_t, engine::most_closest_candidates> slots, masks;
    std::size_t count = 0;
    for (const engine::ClosestCandidate c : engine_->candidates().subspan(found.first, found.candidates)) {
      slots[count] = slots_[c.triangle()];
      masks[count++] = c.queries();
    }
    cpu::closest_of(tree_, points.data(), points.size(), std::span(slots).first(count), std::span(masks).first(count),
                    faces);
    if (std::find(faces, faces + points.size(), no_face) != faces + points.size())
      throw Error(Fault::device_failed, fmt::format("the device {} named no candidate for the closest face of a point; "
                                                    "use --device cpu and report this",
                                                    gpu_->facts().name));
  }

  std::shared_ptr<engine::Gpu> gpu_;
  plan::ClosestTree tree_;
  std::vector<std::uint32_t> slots_; // in the tree, of the device's triangles
  std::unique_ptr<engine::Closest> engine_;
};

} // namespace

std::unique_ptr<DistanceField> distance_field(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget,
                                              std::span<const Vec3> vertices, std::span<const Face> faces) {
  return std::make_unique<GpuDistanceField>(std::move(gpu), iteration_budget, vertices, faces);
}

MemoryNeed distance_field_memory(std::uint64_t vertices, std::uint64_t faces, std::uint64_t queries) {
  const std::uint64_t lanes = std::min<std::uint64_t>(queries, batch) / lane_queries + 1;
  MemoryNeed need;
  need.device = engine::Closest::tree_bytes(faces, faces) + engine::Closest::batch_bytes(lanes);
  // The device's tree is built beside a tree of boxes, and both are given up.
  need.host = cpu::distance_field_bytes(vertices, faces, queries) + 360 * faces + engine::Closest::batch_bytes(lanes);
  return need;
}

} // namespace cowgpu::gpu

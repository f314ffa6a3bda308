#include "host/gpu/closest_faces.hpp"

#include "host/gpu/errors.hpp"
#include "host/parallel.hpp"
#include "host/plan/closest_kernel.hpp"
#include "host/plan/closest_texels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace cowgpu::gpu {

static_assert(ClosestFaces::lane_queries == plan::most_decided);

ClosestFaces::ClosestFaces(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget,
                           const plan::ClosestTree& tree)
    : gpu_(std::move(gpu)), tree_(tree) {
  plan::ClosestTexels texels(tree_);
  engine_ = std::make_unique<engine::Closest>(
      gpu_->device(), engine::ClosestInput{texels.nodes, texels.triangles, 2 * plan::closest_margin, iteration_budget});
  slots_ = std::move(texels.slots);
}

void ClosestFaces::put(std::span<const Vec3> queries, std::span<const std::uint32_t> ids) {
  const std::size_t lanes = (ids.size() + lane_queries - 1) / lane_queries;
  const std::span<float> to = engine_->queries(std::uint32_t(std::max<std::size_t>(1, lanes)));
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

void ClosestFaces::search(std::span<const Vec3> queries, std::span<const std::uint32_t> ids) {
  translated([&] {
    put(queries, ids);
    engine_->search();
  });
}

void ClosestFaces::decide(std::size_t first, std::span<const Vec3> points, std::uint32_t* faces) {
  for (std::size_t i = 0; i < points.size(); i += lane_queries)
    decide_lane((first + i) / lane_queries, points.subspan(i, std::min(lane_queries, points.size() - i)), faces + i);
}

// Among a lane's candidates.
void ClosestFaces::decide_lane(std::size_t lane, std::span<const Vec3> points, std::uint32_t* faces) {
  const engine::ClosestLane found = engine_->lanes()[lane];
  if (found.candidates == engine::closest_left ||
      std::any_of(points.begin(), points.end(), [&](const Vec3& q) { return tree_.is_far(q); })) {
    for (std::size_t i = 0; i < points.size(); ++i)
      faces[i] = plan::closest_single(tree_, points[i], std::numeric_limits<double>::infinity(), no_face);
    return;
  }
  std::array<std::uint32_t, engine::most_closest_candidates> slots, masks;
  std::size_t count = 0;
  for (const engine::ClosestCandidate c : engine_->candidates().subspan(found.first, found.candidates)) {
    slots[count] = slots_[c.triangle()];
    masks[count++] = c.queries();
  }
  plan::closest_of(tree_, points.data(), points.size(), std::span(slots).first(count), std::span(masks).first(count),
                   faces);
  if (std::find(faces, faces + points.size(), no_face) != faces + points.size())
    throw Error(Fault::device_failed, fmt::format("the device {} named no candidate for the closest face of a point; "
                                                  "use --device cpu and report this",
                                                  gpu_->facts().name));
}

std::uint64_t ClosestFaces::device_bytes(std::uint64_t faces, std::uint64_t queries) {
  return engine::Closest::tree_bytes(faces, faces) + engine::Closest::batch_bytes(queries / lane_queries + 1);
}

} // namespace cowgpu::gpu

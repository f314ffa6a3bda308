// Closest faces on a device, for the verbs `closest` and `flow`. The device lists the faces that may be the closest in single
// precision. Among them the host decides for `closest`, with the code of the CPU path: a query has about one candidate, and
// deciding costs 7 % of the search on lavapipe. For `flow` its shader decides, in the same way; both give the same bits.
// Searches the device gives up (too many steps or candidates), and queries too far away for single precision, are the host's.
#pragma once

#include "engine/kernels/closest.hpp"
#include "host/plan/closest_tree.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace cowgpu::gpu {

class ClosestFaces {
public:
  /// The tree outlives it. Throws engine::Error.
  ClosestFaces(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget, const plan::ClosestTree& tree);

  /// Queries a search takes at most, and those that share a lane.
  static constexpr std::size_t lane_queries = engine::closest_queries,
                               batch = lane_queries * engine::Closest::most_lanes;

  /// Searches for the queries named by `ids`, 1 to batch of them, neighbours in space next to each other. Throws Error.
  void search(std::span<const Vec3> queries, std::span<const std::uint32_t> ids);

  /// The same without the search, for kernels that go on with it (engine::Flow); `ids` may be empty. Queries so far away that
  /// single precision has nothing to decide are not to be among them.
  void put(std::span<const Vec3> queries, std::span<const std::uint32_t> ids);
  engine::Closest& kernel() { return *engine_; }
  /// In the tree, of the device's triangles.
  std::span<const std::uint32_t> slots() const { return slots_; }

  /// The closest faces of queries of the last search from `first`, a multiple of lane_queries, on; as
  /// plan::closest_single has them. Safe from several threads. Throws Error(device_failed) where the device missed one.
  void decide(std::size_t first, std::span<const Vec3> points, std::uint32_t* faces);

  engine::Gpu& device() { return *gpu_; }

  /// Device bytes for so many faces and queries at once.
  static std::uint64_t device_bytes(std::uint64_t faces, std::uint64_t queries);

private:
  void decide_lane(std::size_t lane, std::span<const Vec3> points, std::uint32_t* faces);

  std::shared_ptr<engine::Gpu> gpu_;
  const plan::ClosestTree& tree_;
  std::vector<std::uint32_t> slots_; // in the tree, of the device's triangles
  std::unique_ptr<engine::Closest> engine_;
};

} // namespace cowgpu::gpu

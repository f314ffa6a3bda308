// The kernel closest: for every query the triangles that may be the closest. The method stands in shaders/closest.comp,
// its interface in shaders/closest.h.
#pragma once

#include "engine/gpu.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace cowgpu::engine {

class Buffer;
class Job;
class Kernel;

/// A binary tree of boxes over triangles, as shaders/closest.h lays it out.
struct ClosestInput {
  std::span<const std::uint32_t> nodes;     ///< 16 words each, the root first
  std::span<const std::uint32_t> triangles; ///< 20 words each
  float margin = 0; ///< what two distances of single precision may be wrong by, for coordinates up to 1
  std::uint32_t iteration_budget = 60000; ///< loop iterations an invocation may run in one dispatch
};

/// Four queries share a lane.
inline constexpr std::size_t closest_queries = 4;

/// What a lane found.
struct ClosestLane {
  std::uint32_t first;      ///< into the candidates
  std::uint32_t candidates; ///< or closest_left: the lane gave up
};
inline constexpr std::uint32_t closest_left = 0xfffffffeU;
inline constexpr std::size_t most_closest_candidates = 64;

/// A candidate: the triangle, and by bits the lane's queries it is one for.
struct ClosestCandidate {
  std::uint32_t word;
  std::uint32_t triangle() const { return word & 0xfffffffU; }
  std::uint32_t queries() const { return word >> 28; }
};

/// A tree on a device.
class Closest {
public:
  /// Throws Error(out_of_range) for a tree beyond the device's limits or 2^28 triangles, or with a budget that no search
  /// fits in; Error(vulkan), Error(device_lost).
  Closest(Device& device, const ClosestInput& input);
  ~Closest();
  Closest(const Closest&) = delete;
  Closest& operator=(const Closest&) = delete;

  /// Lanes a batch may have.
  static constexpr std::uint32_t most_lanes = 1U << 17;

  /// Room for the queries of a batch of 1 to most_lanes lanes: [lane][x, y, z][4], numbers all finite. Throws
  /// Error(vulkan), Error(device_lost).
  std::span<float> queries(std::uint32_t lanes);

  /// Searches for the queries last put there. Throws Error(cut_short) where the device ended a loop early, Error(vulkan),
  /// Error(device_lost).
  void search();

  /// The same in two steps, for jobs that go on with what was found: records the search, and after the job has run takes
  /// it over; between the two a kernel may bind what lanes() and candidates() show.
  void record(Job& job);
  void finish();
  const Buffer& lanes_buffer() const;
  const Buffer& candidates_buffer() const;

  /// Of the last search.
  std::span<const ClosestLane> lanes();
  std::span<const ClosestCandidate> candidates();

  /// Device bytes of a tree, and of a batch of so many lanes.
  static std::uint64_t tree_bytes(std::uint64_t nodes, std::uint64_t triangles);
  static std::uint64_t batch_bytes(std::uint64_t lanes);

private:
  struct Batch;
  Device& device_;
  const Kernel* kernel_ = nullptr;
  float margin_;
  std::uint32_t steps_ = 0; // that a lane may take
  std::unique_ptr<Buffer> nodes_, triangles_;
  std::unique_ptr<Batch> batch_; // as large as was needed so far
  std::uint32_t lanes_ = 0;
};

} // namespace cowgpu::engine

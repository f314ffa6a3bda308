// What a call of the verb `closest` does beside the search for the closest faces, for both paths: the order of the queries,
// places on the faces and signs.
#pragma once

#include "host/distance_field.hpp"
#include "host/plan/closest_tree.hpp"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// Bytes of a distance field and of one call of so many queries, their result included.
std::uint64_t distance_field_bytes(std::uint64_t vertices, std::uint64_t faces, std::uint64_t queries);

class ClosestCall {
public:
  /// Sorts the queries. Throws as DistanceField::closest does. Tree and queries must outlive the call.
  ClosestCall(const ClosestTree& tree, std::span<const Vec3> queries, const ClosestOptions& options, unsigned threads);

  /// The queries along the Morton curve.
  std::span<const std::uint32_t> order() const { return order_; }

  /// Queries a part holds at most.
  static constexpr std::size_t part = 1024;

  /// The closest faces of up to a part of points that follow each other in the order, the first of them at `first`.
  using FindFaces = std::function<void(std::span<const Vec3> points, std::size_t first, std::uint32_t* faces)>;

  /// Answers the queries [begin, end) of the order, on all threads. `begin` must be a multiple of `part`. Throws
  /// Error(interrupted).
  void each_part(std::size_t begin, std::size_t end, Monitor& monitor, const FindFaces& find);

  /// The answers; fills the report but for the kernels.
  ClosestPoints finish(ClosestReport* report);

private:
  void answer(std::span<const std::uint32_t> ids, std::size_t first, const FindFaces& find);
  std::uint64_t set_signs(std::span<const Vec3> points, const double* distances, std::span<const std::uint32_t> ids);

  const ClosestTree& tree_;
  std::span<const Vec3> queries_;
  unsigned threads_;
  std::chrono::steady_clock::time_point start_;
  double sort_seconds_ = 0;
  std::vector<std::uint32_t> order_;
  ClosestPoints result_;
  std::atomic<std::uint64_t> rays_ = 0;
};

} // namespace cowgpu::plan

// The kernel potential: sums of series in irregular solid harmonics at many points. The mathematics stands in
// host/plan/potential.hpp, the shader's interface in shaders/potential.h.
#pragma once

#include "engine/gpu.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace cowgpu::engine {

class Buffer;

/// Series, as host/plan/potential.hpp lays them out.
struct PotentialInput {
  std::uint32_t top = 0;                  ///< degree the rows end with
  std::uint32_t sets = 9;                 ///< 1, 4 or 9
  std::span<const double> table;          ///< [m][l = m ... top][2 + 2 sets]
  std::uint32_t iteration_budget = 60000; ///< loop iterations an invocation may run in one dispatch
};

/// Points of a batch, four a lane.
inline constexpr std::size_t potential_points_a_lane = 4;

/// Series on a device.
class Potential {
public:
  /// Throws Error(out_of_range) where a row of the table is beyond the budget or the device's texel buffers, Error(vulkan),
  /// Error(device_lost).
  Potential(Device& device, const PotentialInput& input);
  ~Potential();
  Potential(const Potential&) = delete;
  Potential& operator=(const Potential&) = delete;

  /// Lanes a batch may have: so many that a dispatch ends within a second.
  std::uint32_t most_lanes() const;

  /// Sums for a batch of tops.size() lanes, at least 1 and at most most_lanes(): `points` is [lane][input][4] with the inputs
  /// x', y', z', its rest, q, J_00; `tops` each lane's degree, `sums` [lane][set][4]. `hook` gets the part of the table that is
  /// done. Throws Error(cut_short) where the device ended a loop early, Error(stopped), Error(vulkan), Error(device_lost).
  void sum(std::span<const double> points, std::span<const std::uint32_t> tops, std::span<double> sums,
           const Hook& hook);

  /// Device bytes of a table and a batch.
  static std::uint64_t device_bytes(std::uint32_t top, std::uint32_t sets, std::uint64_t lanes);

private:
  struct Range { // a range of orders, one dispatch
    std::uint32_t first, end;
    std::uint64_t offset, bytes;
  };
  Device& device_;
  std::uint32_t top_, sets_;
  std::vector<Range> ranges_;
  std::unique_ptr<Buffer> table_;
};

} // namespace cowgpu::engine

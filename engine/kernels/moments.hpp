// The kernels moments and moments_sum: sums of the rows t_l[m] over triangle pairs. The mathematics stands in
// host/plan/moments.hpp, the shader's interface in shaders/moments.h.
#pragma once

#include "engine/gpu.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace cowgpu::engine {

/// How the work is laid out on a device. Zeros are filled in by the kind of device.
struct MomentsShape {
  std::uint32_t lanes = 0;      ///< pairs a group: the subgroup's size
  std::uint32_t levels = 0;     ///< degrees a sweep advances; a power of two, 2 to 16
  std::uint32_t workgroups = 0; ///< workgroups, each with a partial sum; a power of two, at most 64
  bool rows_in_buffer = false;  ///< rows in device memory instead of private memory
  std::uint64_t state_budget = std::uint64_t(512) << 20; ///< bytes of rows in device memory
  std::uint32_t iteration_budget = 60000;                ///< loop iterations an invocation may run in one dispatch
};

/// Software devices keep rows in private memory; others keep them in device memory, where lanes read them together.
MomentsShape moments_shape(const GpuFacts& facts, MomentsShape wanted = {});

/// What the kernel works on.
struct MomentsInput {
  int lmax = 0;
  int column_scale = 1;                        ///< 1 or 2
  int start_exponent = 0;                      ///< rows start at 2^start_exponent
  std::span<const double> pairs;               ///< MOMENTS_INPUTS of each pair: [group][input][lane]
  std::span<const std::uint32_t> last_degrees; ///< last degree of each group, from the largest down
};

/// Bytes the kernels need on the device for `groups` groups.
std::uint64_t moments_device_bytes(const MomentsShape& shape, const GpuFacts& facts, int lmax, std::uint64_t groups);

/// Adds up t_l[m] 2^start_exponent for l = 1 ... lmax over all pairs. `sums` has (lmax+1)(lmax+2) doubles: real and
/// imaginary parts, sorted by l, then m; degree 0 is left alone. Dispatches are bounded by the shape's iteration budget;
/// the order of all additions depends on the input and the shape alone. Throws Error(out_of_range) for a shape the device
/// cannot take, Error(cut_short) if the device ended a loop early, Error(vulkan), Error(device_lost), Error(stopped).
void moments(Device& device, const MomentsShape& shape, const MomentsInput& input, std::span<double> sums,
             const Hook& hook);

} // namespace cowgpu::engine

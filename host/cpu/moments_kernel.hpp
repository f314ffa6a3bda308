// The SIMD kernel of the CPU path of `moments`, compiled once per instruction set.
#pragma once

#include "host/plan/moments.hpp"

#include <hwy/aligned_allocator.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace cowgpu::cpu {

/// Degrees that one sweep over the orders m advances.
inline constexpr int degrees_per_sweep = 4;

/// Layout of a partial sum. Sweep n (from 0) makes degrees 4n+1 ... 4n+4; its column ix holds 8 doubles: real and
/// imaginary part of order m = ix - 4 - j of degree 4n+1+j, j = 0 ... 3. Columns of other orders hold scratch.
struct PartialLayout {
  explicit PartialLayout(int lmax);
  std::size_t sweeps() const { return offset.size() - 1; }
  std::size_t size() const { return offset.back(); } ///< doubles

  std::vector<std::size_t> offset; ///< where each sweep begins, and the end
};

/// Rows and phases of one group; reused from group to group.
struct MomentsWorkspace {
  explicit MomentsWorkspace(int lmax);
  static std::size_t bytes(int lmax);
  hwy::AlignedFreeUniquePtr<double[]> rows;   ///< 6 vectors a column
  hwy::AlignedFreeUniquePtr<double[]> phases; ///< 4 vectors a column
};

/// Pairs per SIMD group on this machine: 8, 4, 2 or 1.
int moments_lanes();

/// Name of the instruction set in use ("AVX3", "AVX2", "SSE4", ...).
std::string simd_name();

/// Adds the rows t_l[m] of one group to `partial`, degrees 1 to the group's last.
void accumulate_group(const plan::Moments& plan, std::size_t group, const PartialLayout& layout,
                      MomentsWorkspace& workspace, double* partial);

} // namespace cowgpu::cpu

// The stage `ring_fourier` on the CPU: discrete Fourier transforms along rings of any length, compiled once per
// instruction set. Each SIMD lane holds one pair of rings, north + i south, so that one complex transform serves both.
#pragma once

#include <hwy/aligned_allocator.h>

#include <array>
#include <cstddef>
#include <vector>

namespace cowgpu::cpu {

/// Pairs of rings in a block, whatever the number of lanes.
inline constexpr int pairs_of_block = 8;

/// Tables of a transform of one length: Stockham's autosort algorithm with radices 8, 4, 2, 3, 5, and a radix of its own
/// for every other prime p, which costs p operations a point.
struct RingFourier {
  /// `length` >= 1.
  explicit RingFourier(int length);

  struct Pass {
    int radix;
    int length;                  ///< length of the transforms it begins: radix times what is left
    int stride;                  ///< the product of the radices before
    std::vector<double> twiddle; ///< [p][k-1][2] = exp(-2 pi i p k / length), p < length / radix, 0 < k < radix
    std::vector<double> circle;  ///< [j][2] = cos and sin of 2 pi j / radix; empty for the radices above
  };
  int length = 1;
  std::vector<Pass> passes;
  int largest_prime = 0; ///< with a pass of its own; 0: none
};

/// Scratch memory of one thread.
struct RingWork {
  explicit RingWork(const RingFourier& fourier);
  static std::size_t most_bytes(int length); ///< for any factors of the length

  hwy::AlignedFreeUniquePtr<double[]> one, other; ///< rows of the transform
  hwy::AlignedFreeUniquePtr<double[]> radix;      ///< sums and differences of a large prime's inputs
};

/// What a block of eight pairs of rings brings along, each [8].
struct RingBlock {
  std::array<const double*, 8> north{}, south{}; ///< values of the rings; null: there is no such ring
  std::array<double, 8> weight{};                ///< both rings are multiplied by this
  std::array<double, 8> x{};                     ///< cos theta of the northern ring
};

/// F_m = weight sum_j f_j exp(-2 pi i m j / n) of both rings, 2 lmax < n, to cells[m * stride]: re and im of N + S, re and
/// im of x (N - S), each [8]; 0 where there is no northern ring.
void rings_to_orders(const RingFourier& fourier, const RingBlock& block, int lmax, double* cells, std::size_t stride,
                     RingWork& work);

/// f_j = weight (F_0 + sum_{m=1..lmax} 2 Re F_m exp(2 pi i m j / n)), F = E + O north, E - O south of the equator, from
/// cells[m * stride]: re E, im E, re O, im O, each [8]; im F_0 counts as 0. Rings that are not there are not written.
struct RingTargets {
  std::array<double*, 8> north{}, south{};
  std::array<double, 8> weight{};
};
void orders_to_rings(const RingFourier& fourier, const RingTargets& block, int lmax, const double* cells,
                     std::size_t stride, RingWork& work);

} // namespace cowgpu::cpu

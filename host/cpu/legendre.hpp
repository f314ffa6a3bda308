// The stages `legendre_synthesis` and `legendre_analysis` on the CPU, compiled once per instruction set; the mathematics
// stands in host/plan/legendre.hpp.
#pragma once

#include "host/plan/legendre.hpp"

#include <hwy/aligned_allocator.h>

#include <complex>
#include <cstddef>
#include <span>

namespace cowgpu::cpu {

/// Fields that share one run of the recurrence; more are transformed in several runs.
inline constexpr int most_fields_together = 3;

/// What stands between the Legendre and the Fourier stage: for each order, field and block of pairs of rings
///   [4][block_pairs] doubles: re E, im E, re O, im O in synthesis (north and south are E + O and E - O),
///                             re and im of N + S, re and im of x (N - S) in analysis.
struct SpectrumLayout {
  static constexpr std::size_t cell = 4 * plan::block_pairs; ///< doubles of one order, field and block

  SpectrumLayout(const plan::Legendre& plan, int fields_)
      : fields(fields_), blocks(plan.blocks), orders(plan.lmax + 1),
        // One cell more: rows whose distance is a power of two would share a few sets of the cache.
        row(cell * (std::size_t(fields_) * std::size_t(plan.blocks) + 1)) {}

  std::size_t at(int m, int field, int block) const {
    return std::size_t(m) * row + cell * (std::size_t(field) * std::size_t(blocks) + std::size_t(block));
  }
  std::size_t size() const { return std::size_t(orders) * row; } ///< doubles

  int fields, blocks, orders;
  std::size_t row; ///< doubles from one order to the next
};

/// Scratch memory of one thread.
struct LegendreWork {
  explicit LegendreWork(const plan::Legendre& plan);
  static std::size_t bytes(const plan::Legendre& plan);

  hwy::AlignedFreeUniquePtr<double[]> sums;  ///< q_k or r_k of all fields
  hwy::AlignedFreeUniquePtr<double[]> state; ///< lambda_{k-1}, lambda_k of every pair
  hwy::AlignedFreeUniquePtr<double[]> chunk; ///< what has to stay in the first-level cache
};

/// One order m of `fields` fields, 1 to most_fields_together: from coefficients, a_lm of field f at
/// coefficients[f * stride + l - m], l = m ... lmax, to cells [field][block]. All cells are written.
void legendre_synthesis(const plan::Legendre& plan, const plan::Seeds& seeds, int m, int fields,
                        const std::complex<double>* coefficients, std::size_t stride, LegendreWork& work,
                        double* cells);

/// The other direction. In the padding of the last block the cells must be 0.
void legendre_analysis(const plan::Legendre& plan, const plan::Seeds& seeds, int m, int fields, const double* cells,
                       LegendreWork& work, std::complex<double>* coefficients, std::size_t stride);

} // namespace cowgpu::cpu

// The recursion's values and all sums stay in registers.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/plan/solid_sums_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/plan/solid_sums_kernel.hpp"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::plan::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
constexpr D d;
constexpr std::size_t lanes = hn::MaxLanes(d);

template <std::size_t Sets>
HWY_INLINE void sum_lanes(int order, const double* coefficients, const double* points, std::size_t count,
                          std::size_t first, double* sums) {
  const HarmonicFactors& factors = harmonic_factors();
  const V x = hn::Load(d, points + first), y = hn::Load(d, points + count + first);
  const V z = hn::Load(d, points + 2 * count + first);
  const V r2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
  V sum[Sets];
  for (V& one : sum) one = hn::Zero(d);
  V start_c = hn::Set(d, 1), start_s = hn::Zero(d);
  for (int m = 0; m <= order; ++m) {
    V c = start_c, s = start_s, last_c = hn::Zero(d), last_s = hn::Zero(d);
    for (int l = m;; ++l) {
      const double* cosine = coefficients + Sets * cosine_index(l, m);
      for (std::size_t i = 0; i < Sets; ++i) sum[i] = hn::MulAdd(hn::Set(d, cosine[i]), c, sum[i]);
      if (m > 0) {
        const double* sine = coefficients + Sets * sine_index(l, m);
        for (std::size_t i = 0; i < Sets; ++i) sum[i] = hn::MulAdd(hn::Set(d, sine[i]), s, sum[i]);
      }
      if (l == order) break;
      const std::size_t row = std::size_t(l + 1), column = std::size_t(m);
      const V rise = hn::Mul(hn::Set(d, factors.rise[row][column]), z);
      const V fall = hn::Mul(hn::Set(d, factors.fall[row][column]), r2);
      const V next_c = hn::NegMulAdd(fall, last_c, hn::Mul(rise, c));
      const V next_s = hn::NegMulAdd(fall, last_s, hn::Mul(rise, s));
      last_c = c;
      last_s = s;
      c = next_c;
      s = next_s;
    }
    if (m == order) break;
    const V factor = hn::Set(d, factors.diagonal[std::size_t(m + 1)]);
    const V turned = hn::NegMulAdd(y, start_s, hn::Mul(x, start_c));
    start_s = hn::Mul(factor, hn::MulAdd(x, start_s, hn::Mul(y, start_c)));
    start_c = hn::Mul(factor, turned);
  }
  for (std::size_t i = 0; i < Sets; ++i) hn::StoreU(sum[i], d, sums + i * count + first);
}

void SumHarmonics(int order, std::size_t sets, const double* coefficients, const double* points, std::size_t count,
                  double* sums) {
  for (std::size_t first = 0; first < count; first += lanes) switch (sets) {
    case 4: sum_lanes<4>(order, coefficients, points, count, first, sums); break;
    case 5: sum_lanes<5>(order, coefficients, points, count, first, sums); break;
    default: sum_lanes<10>(order, coefficients, points, count, first, sums); break;
    }
}

} // namespace cowgpu::plan::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cowgpu::plan {
HWY_EXPORT(SumHarmonics);

void sum_harmonics(int order, std::size_t sets, const double* coefficients, const double* points, std::size_t count,
                   double* sums) {
  HWY_DYNAMIC_DISPATCH(SumHarmonics)(order, sets, coefficients, points, count, sums);
}
} // namespace cowgpu::plan
#endif

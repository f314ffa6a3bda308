// Lanes are points. The recursion's values and all sums stay in registers; a row of the table is read once for them.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/cpu/potential_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/cpu/lanes-inl.hpp"
#include "host/cpu/potential.hpp"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::cpu::HWY_NAMESPACE {

template <std::size_t Sets>
HWY_INLINE void sum_lanes(const plan::PotentialSeries& series, const plan::PotentialPoints& points, std::size_t first,
                          int top, double* sums) {
  constexpr std::size_t stride = 2 + 2 * Sets;
  const V x = hn::LoadU(d, &points.x[first]), y = hn::LoadU(d, &points.y[first]);
  const V z = hn::LoadU(d, &points.z[first]), q = hn::LoadU(d, &points.q[first]);
  V start_re = hn::LoadU(d, &points.start[first]), start_im = hn::Zero(d);
  V sum[Sets];
  for (std::size_t s = 0; s < Sets; ++s) sum[s] = hn::Zero(d);
  const double* row = series.table.data();
  for (int m = 0; m <= top; ++m) {
    V re = start_re, im = start_im, last_re = hn::Zero(d), last_im = hn::Zero(d);
    const double* entry = row;
    for (int l = m; l <= top; ++l, entry += stride) {
      for (std::size_t s = 0; s < Sets; ++s) {
        sum[s] = hn::MulAdd(hn::Set(d, entry[2 + 2 * s]), re, sum[s]);
        sum[s] = hn::MulAdd(hn::Set(d, entry[3 + 2 * s]), im, sum[s]);
      }
      const V a = hn::Mul(hn::Set(d, entry[0]), z), b = hn::Mul(hn::Set(d, entry[1]), q);
      const V next_re = hn::NegMulAdd(b, last_re, hn::Mul(a, re)), next_im = hn::NegMulAdd(b, last_im, hn::Mul(a, im));
      last_re = re;
      last_im = im;
      re = next_re;
      im = next_im;
    }
    row += stride * std::size_t(series.top - m + 1);
    const V factor = hn::Set(d, row[-std::ptrdiff_t(stride)]);
    const V fx = hn::Mul(factor, x), fy = hn::Mul(factor, y);
    const V turned = hn::NegMulAdd(fy, start_im, hn::Mul(fx, start_re));
    start_im = hn::MulAdd(fy, start_re, hn::Mul(fx, start_im));
    start_re = turned;
    // On and next to the axis few orders are left.
    if (hn::AllTrue(d, hn::And(hn::Eq(start_re, hn::Zero(d)), hn::Eq(start_im, hn::Zero(d))))) break;
  }
  for (std::size_t s = 0; s < Sets; ++s) hn::StoreU(sum[s], d, sums + s * points.padded() + first);
}

void SumPotential(const plan::PotentialSeries& series, const plan::PotentialPoints& points, std::size_t first, int top,
                  double* sums) {
  for (std::size_t lane = 0; lane < potential_group; lane += lanes) switch (series.sets) {
    case 1: sum_lanes<1>(series, points, first + lane, top, sums); break;
    case 4: sum_lanes<4>(series, points, first + lane, top, sums); break;
    default: sum_lanes<9>(series, points, first + lane, top, sums); break;
    }
}

} // namespace cowgpu::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cowgpu::cpu {
HWY_EXPORT(SumPotential);

void sum_potential(const plan::PotentialSeries& series, const plan::PotentialPoints& points, std::size_t first, int top,
                   double* sums) {
  HWY_DYNAMIC_DISPATCH(SumPotential)(series, points, first, top, sums);
}
} // namespace cowgpu::cpu
#endif

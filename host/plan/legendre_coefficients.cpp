// Between coefficients and the steps of the recurrence: a vector is a complex number.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/plan/legendre_coefficients.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/plan/legendre.hpp"

#include <hwy/highway.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::plan::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 2>;
using V = hn::Vec<D>;
constexpr D d;
constexpr std::size_t lanes = hn::MaxLanes(d);

// One step, from a_l, a_{l+1}, a_{l+2} at `from`.
template <bool Odd, bool Next>
HWY_INLINE void prepare_step(double alpha, const double* e, const double* from, double* q) {
  const V factor = hn::Set(d, alpha), here = hn::Mul(factor, hn::Set(d, e[1]));
  const V above = hn::Mul(factor, hn::Set(d, e[2]));
  for (std::size_t i = 0; i < 2; i += lanes) {
    const V even = hn::Mul(here, hn::LoadU(d, from + i));
    hn::StoreU(Next ? hn::MulAdd(above, hn::LoadU(d, from + 4 + i), even) : even, d, q + i);
    hn::StoreU(Odd ? hn::Mul(factor, hn::LoadU(d, from + 2 + i)) : hn::Zero(d), d, q + 2 + i);
  }
}

void Prepare(const double* alpha, const double* e, std::size_t steps, const double* from, bool last_odd, double* q,
             std::size_t stride) {
  const std::size_t last = steps - 1;
  for (std::size_t k = 0; k < last; ++k, q += stride) prepare_step<true, true>(alpha[k], e + 2 * k, from + 4 * k, q);
  if (last_odd)
    prepare_step<true, false>(alpha[last], e + 2 * last, from + 4 * last, q);
  else
    prepare_step<false, false>(alpha[last], e + 2 * last, from + 4 * last, q);
}

void Finish(const double* alpha, const double* e, std::size_t steps, const double* r, std::size_t stride, double* to,
            bool last_odd) {
  V before[2 / lanes]; // alpha_{k-1} re_{k-1}
  for (V& b : before) b = hn::Zero(d);
  for (std::size_t k = 0; k < steps; ++k, r += stride, to += 4) {
    const V factor = hn::Set(d, alpha[k]), below = hn::Set(d, e[2 * k]), above = hn::Set(d, e[2 * k + 1]);
    for (std::size_t i = 0; i < 2; i += lanes) {
      const V here = hn::Mul(factor, hn::LoadU(d, r + i));
      hn::StoreU(hn::MulAdd(above, here, hn::Mul(below, before[i / lanes])), d, to + i);
      before[i / lanes] = here;
      if (k + 1 < steps || last_odd) hn::StoreU(hn::Mul(factor, hn::LoadU(d, r + 2 + i)), d, to + 2 + i);
    }
  }
}

} // namespace cowgpu::plan::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cowgpu::plan {

HWY_EXPORT(Prepare);
HWY_EXPORT(Finish);

// std::complex guarantees that its numbers are pairs of doubles.

void prepare_synthesis(const Legendre& plan, int m, std::span<const std::complex<double>> coefficients, double* q,
                       std::size_t stride) {
  const std::size_t order = std::size_t(m), steps = std::size_t(plan.steps(m));
  HWY_DYNAMIC_DISPATCH(Prepare)
  (&plan.alpha[plan.offset[order]], &plan.e[plan.e_offset[order]], steps,
   reinterpret_cast<const double*>(coefficients.data()), coefficients.size() == 2 * steps, q, stride);
  if (m == 0)
    for (std::size_t k = 0; k < steps; ++k) q[k * stride + 1] = q[k * stride + 3] = 0;
  for (std::size_t k = steps; k < std::size_t(plan.padded_steps(m)); ++k) std::fill_n(q + k * stride, 4, 0.0);
}

void finish_analysis(const Legendre& plan, int m, const double* r, std::size_t stride,
                     std::span<std::complex<double>> coefficients) {
  const std::size_t order = std::size_t(m), steps = std::size_t(plan.steps(m));
  HWY_DYNAMIC_DISPATCH(Finish)
  (&plan.alpha[plan.offset[order]], &plan.e[plan.e_offset[order]], steps, r, stride,
   reinterpret_cast<double*>(coefficients.data()), coefficients.size() == 2 * steps);
  if (m == 0)
    for (auto& a : coefficients) a = a.real();
}

} // namespace cowgpu::plan
#endif // HWY_ONCE

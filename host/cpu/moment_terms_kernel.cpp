// Lanes are triangles. One pass over the orders advances all three rows of a block by a degree: v by C, e by B, q by A.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/cpu/moment_terms_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/cpu/lanes-inl.hpp"
#include "host/cpu/moment_terms_kernel.hpp"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::cpu::HWY_NAMESPACE {

struct Complex {
  V re, im;
};

HWY_INLINE Complex load(const double* p) {
  return {hn::Load(d, p), hn::Load(d, p + lanes)};
}

HWY_INLINE void store(const Complex& c, double* p) {
  hn::Store(c.re, d, p);
  hn::Store(c.im, d, p + lanes);
}

struct Direction {
  V x, y, z;
};

struct Gradient {
  V same, above, below;
};

// The gradient along `to` of the row's entries m, m+1 and m-1, added to `sum`.
HWY_INLINE Complex raised(const Direction& to, const Gradient& f, const Complex& same, const Complex& above,
                          const Complex& below, const Complex& sum) {
  const V z = hn::Mul(f.same, to.z), ax = hn::Mul(f.above, to.x), ay = hn::Mul(f.above, to.y),
          bx = hn::Mul(f.below, to.x), by = hn::Mul(f.below, to.y);
  Complex r;
  r.re =
      hn::MulAdd(z, same.re,
                 hn::MulAdd(ax, above.re,
                            hn::MulAdd(ay, above.im, hn::MulAdd(bx, below.re, hn::NegMulAdd(by, below.im, sum.re)))));
  r.im =
      hn::MulAdd(z, same.im,
                 hn::MulAdd(ax, above.im,
                            hn::NegMulAdd(ay, above.re, hn::MulAdd(bx, below.im, hn::MulAdd(by, below.re, sum.im)))));
  return r;
}

double RaiseTerms(int l, const TermFactors& factors, const double* corners, double* rows, double* sums) {
  constexpr std::size_t column = 6 * lanes, row = 2 * lanes;
  const auto corner = [&](std::size_t k) HWY_ATTR {
    const double* p = corners + 3 * k * lanes;
    return Direction{hn::Load(d, p), hn::Load(d, p + lanes), hn::Load(d, p + 2 * lanes)};
  };
  const Direction a = corner(0), b = corner(1), c = corner(2);
  // Column -1 is minus the conjugate of column 1.
  Complex same[3], below[3];
  for (std::size_t k = 0; k < 3; ++k) {
    same[k] = load(rows + k * row);
    below[k] = load(rows + column + k * row);
    below[k].re = hn::Neg(below[k].re);
  }
  const Complex none = {hn::Zero(d), hn::Zero(d)};
  V squares = hn::Zero(d), zonal = hn::Zero(d);
  for (int first = 0; first <= l; first += term_orders) {
    V t[2 * term_orders];
    for (int j = 0; j < term_orders; ++j) {
      const int m = first + j;
      double* p = rows + std::size_t(m) * column;
      const Gradient f = {hn::Set(d, factors.same[m]), hn::Set(d, factors.above[m]), hn::Set(d, factors.below[m])};
      const Complex above[3] = {load(p + column), load(p + column + row), load(p + column + 2 * row)};
      const Complex v = raised(c, f, same[0], above[0], below[0], none);
      const Complex e = raised(b, f, same[1], above[1], below[1], v);
      const Complex q = raised(a, f, same[2], above[2], below[2], e);
      store(v, p);
      store(e, p + row);
      store(q, p + 2 * row);
      t[2 * j] = q.re;
      t[2 * j + 1] = q.im;
      squares = hn::MulAdd(q.re, q.re, hn::MulAdd(q.im, q.im, squares));
      if (m == 0) zonal = squares;
      for (std::size_t k = 0; k < 3; ++k) {
        below[k] = same[k];
        same[k] = above[k];
      }
    }
    add_lane_sums(t, sums + 2 * std::size_t(first));
  }
  return hn::GetLane(hn::SumOfLanes(d, hn::Sub(hn::Add(squares, squares), zonal)));
}

std::size_t TermLanes() {
  return lanes;
}

} // namespace cowgpu::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cowgpu::cpu {

HWY_EXPORT(RaiseTerms);
HWY_EXPORT(TermLanes);

std::size_t term_lanes() {
  return HWY_DYNAMIC_DISPATCH(TermLanes)();
}

std::size_t term_column_doubles() {
  return 6 * term_lanes();
}

double raise_terms(int l, const TermFactors& factors, const double* corners, double* rows, double* sums) {
  return HWY_DYNAMIC_DISPATCH(RaiseTerms)(l, factors, corners, rows, sums);
}

} // namespace cowgpu::cpu
#endif

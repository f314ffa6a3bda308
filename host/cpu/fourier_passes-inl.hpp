// Butterflies and passes of the Fourier transform, compiled once per instruction set: include after
// hwy/foreach_target.h.
#if defined(COWGPU_HOST_CPU_FOURIER_PASSES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef COWGPU_HOST_CPU_FOURIER_PASSES_INL
#undef COWGPU_HOST_CPU_FOURIER_PASSES_INL
#else
#define COWGPU_HOST_CPU_FOURIER_PASSES_INL
#endif

#include "host/cpu/lanes-inl.hpp"
#include "host/cpu/ring_fourier.hpp"

#include <hwy/highway.h>

#include <cstddef>
#include <numbers>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::cpu::HWY_NAMESPACE {

constexpr std::size_t point = 2 * lanes; // doubles of one

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
HWY_INLINE Complex add(const Complex& a, const Complex& b) {
  return {hn::Add(a.re, b.re), hn::Add(a.im, b.im)};
}
HWY_INLINE Complex sub(const Complex& a, const Complex& b) {
  return {hn::Sub(a.re, b.re), hn::Sub(a.im, b.im)};
}
// a - i b and a + i b.
HWY_INLINE Complex sub_i(const Complex& a, const Complex& b) {
  return {hn::Add(a.re, b.im), hn::Sub(a.im, b.re)};
}
HWY_INLINE Complex add_i(const Complex& a, const Complex& b) {
  return {hn::Sub(a.re, b.im), hn::Add(a.im, b.re)};
}
HWY_INLINE Complex multiply(const Complex& a, const double* factor) {
  const V c = hn::Set(d, factor[0]), s = hn::Set(d, factor[1]);
  return {hn::NegMulAdd(a.im, s, hn::Mul(a.re, c)), hn::MulAdd(a.re, s, hn::Mul(a.im, c))};
}
// a + factor b.
HWY_INLINE Complex add_scaled(const Complex& a, V factor, const Complex& b) {
  return {hn::MulAdd(factor, b.re, a.re), hn::MulAdd(factor, b.im, a.im)};
}

HWY_INLINE void butterfly2(Complex* x) {
  const Complex difference = sub(x[0], x[1]);
  x[0] = add(x[0], x[1]);
  x[1] = difference;
}

HWY_INLINE void butterfly4(Complex* x) {
  const Complex a = add(x[0], x[2]), b = sub(x[0], x[2]), c = add(x[1], x[3]), e = sub(x[1], x[3]);
  x[0] = add(a, c);
  x[1] = sub_i(b, e);
  x[2] = sub(a, c);
  x[3] = add_i(b, e);
}

HWY_INLINE void butterfly8(Complex* x) {
  Complex even[4] = {x[0], x[2], x[4], x[6]}, odd[4] = {x[1], x[3], x[5], x[7]};
  butterfly4(even);
  butterfly4(odd);
  const V half = hn::Set(d, std::numbers::sqrt2 / 2);
  const Complex turned1 = {hn::Add(odd[1].re, odd[1].im), hn::Sub(odd[1].im, odd[1].re)};
  const Complex turned3 = {hn::Sub(odd[3].im, odd[3].re),
                           hn::Add(odd[3].re, odd[3].im)}; // with the sign of the imaginary part changed
  x[0] = add(even[0], odd[0]);
  x[4] = sub(even[0], odd[0]);
  x[1] = add_scaled(even[1], half, turned1);
  x[5] = {hn::NegMulAdd(half, turned1.re, even[1].re), hn::NegMulAdd(half, turned1.im, even[1].im)};
  x[2] = sub_i(even[2], odd[2]);
  x[6] = add_i(even[2], odd[2]);
  x[3] = {hn::MulAdd(half, turned3.re, even[3].re), hn::NegMulAdd(half, turned3.im, even[3].im)};
  x[7] = {hn::NegMulAdd(half, turned3.re, even[3].re), hn::MulAdd(half, turned3.im, even[3].im)};
}

HWY_INLINE void butterfly3(Complex* x) {
  const Complex sum = add(x[1], x[2]), difference = sub(x[1], x[2]);
  const Complex middle = add_scaled(x[0], hn::Set(d, -0.5), sum);
  const V s = hn::Set(d, std::numbers::sqrt3 / 2);
  const Complex turned = {hn::Mul(s, difference.re), hn::Mul(s, difference.im)};
  x[0] = add(x[0], sum);
  x[1] = sub_i(middle, turned);
  x[2] = add_i(middle, turned);
}

HWY_INLINE void butterfly5(Complex* x) {
  constexpr double c1 = 0.30901699437494742410, c2 = -0.80901699437494742410; // cos(2 pi / 5), cos(4 pi / 5)
  constexpr double s1 = 0.95105651629515357212, s2 = 0.58778525229247312917;
  const Complex sum1 = add(x[1], x[4]), sum2 = add(x[2], x[3]), dif1 = sub(x[1], x[4]), dif2 = sub(x[2], x[3]);
  const V vc1 = hn::Set(d, c1), vc2 = hn::Set(d, c2), vs1 = hn::Set(d, s1), vs2 = hn::Set(d, s2);
  const Complex a1 = add_scaled(add_scaled(x[0], vc1, sum1), vc2, sum2);
  const Complex a2 = add_scaled(add_scaled(x[0], vc2, sum1), vc1, sum2);
  const Complex b1 = {hn::MulAdd(vs2, dif2.re, hn::Mul(vs1, dif1.re)), hn::MulAdd(vs2, dif2.im, hn::Mul(vs1, dif1.im))};
  const Complex b2 = {hn::NegMulAdd(vs1, dif2.re, hn::Mul(vs2, dif1.re)),
                      hn::NegMulAdd(vs1, dif2.im, hn::Mul(vs2, dif1.im))};
  x[0] = add(x[0], add(sum1, sum2));
  x[1] = sub_i(a1, b1);
  x[4] = add_i(a1, b1);
  x[2] = sub_i(a2, b2);
  x[3] = add_i(a2, b2);
}

template <int Radix>
HWY_INLINE void butterfly(Complex* x) {
  if constexpr (Radix == 2) butterfly2(x);
  if constexpr (Radix == 3) butterfly3(x);
  if constexpr (Radix == 4) butterfly4(x);
  if constexpr (Radix == 5) butterfly5(x);
  if constexpr (Radix == 8) butterfly8(x);
}

/// Calls body(radix as a constant) for the radices with a butterfly; false for others.
template <class Body>
HWY_INLINE bool with_radix(int radix, const Body& body) {
  switch (radix) {
  case 2: body(std::integral_constant<int, 2>()); return true;
  case 3: body(std::integral_constant<int, 3>()); return true;
  case 4: body(std::integral_constant<int, 4>()); return true;
  case 5: body(std::integral_constant<int, 5>()); return true;
  case 8: body(std::integral_constant<int, 8>()); return true;
  default: return false;
  }
}

template <int Radix>
void run_pass(const RingFourier::Pass& pass, const double* from, double* to) {
  const std::size_t length = std::size_t(pass.length / Radix), stride = std::size_t(pass.stride);
  const double* twiddle = pass.twiddle.data();
  for (std::size_t p = 0; p < length; ++p, twiddle += 2 * (Radix - 1))
    for (std::size_t q = 0; q < stride; ++q) {
      Complex x[Radix];
      for (std::size_t k = 0; k < Radix; ++k) x[k] = load(from + (q + stride * (p + k * length)) * point);
      butterfly<Radix>(x);
      double* out = to + (q + stride * Radix * p) * point;
      store(x[0], out);
      for (std::size_t k = 1; k < Radix; ++k)
        store(p == 0 ? x[k] : multiply(x[k], twiddle + 2 * (k - 1)), out + k * stride * point);
    }
}

// A prime of any size: with s_j = x_j + x_{r-j}, d_j = x_j - x_{r-j}, 0 < j < r/2, outputs k and r - k are A - i B and
// A + i B, A = x_0 + sum s_j cos(2 pi j k / r), B = sum d_j sin(2 pi j k / r).
void run_large_prime(const RingFourier::Pass& pass, const double* from, double* to, double* sums) {
  const std::size_t radix = std::size_t(pass.radix), half = radix / 2;
  const std::size_t length = std::size_t(pass.length) / radix, stride = std::size_t(pass.stride);
  double* differences = sums + half * point;
  for (std::size_t p = 0; p < length; ++p) {
    const double* twiddle = &pass.twiddle[p * 2 * (radix - 1)];
    for (std::size_t q = 0; q < stride; ++q) {
      const auto input = [&](std::size_t k) HWY_ATTR { return load(from + (q + stride * (p + k * length)) * point); };
      double* out = to + (q + stride * radix * p) * point;
      const Complex first = input(0);
      Complex total = first;
      for (std::size_t j = 1; j <= half; ++j) {
        const Complex a = input(j), b = input(radix - j), sum = add(a, b);
        store(sum, sums + (j - 1) * point);
        store(sub(a, b), differences + (j - 1) * point);
        total = add(total, sum);
      }
      store(total, out);
      for (std::size_t k = 1; k <= half; ++k) {
        Complex a = first, b = {hn::Zero(d), hn::Zero(d)};
        for (std::size_t j = 0, at = k; j < half; ++j, at = at + k < radix ? at + k : at + k - radix) {
          a = add_scaled(a, hn::Set(d, pass.circle[2 * at]), load(sums + j * point));
          b = add_scaled(b, hn::Set(d, pass.circle[2 * at + 1]), load(differences + j * point));
        }
        store(multiply(sub_i(a, b), twiddle + 2 * (k - 1)), out + k * stride * point);
        store(multiply(add_i(a, b), twiddle + 2 * (radix - k - 1)), out + (radix - k) * stride * point);
      }
    }
  }
}

} // namespace cowgpu::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

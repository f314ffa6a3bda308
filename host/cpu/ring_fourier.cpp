// A row of the transform is [j][2][lanes]: real and imaginary part of point j of as many pairs of rings as there are
// lanes. Passes are decimation in frequency: output k of a butterfly is multiplied by exp(-2 pi i p k / length). The
// inverse transform is the forward one with real and imaginary parts exchanged on both sides.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/cpu/ring_fourier.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/cpu/lanes-inl.hpp"
#include "host/cpu/ring_fourier.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <numbers>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::cpu::HWY_NAMESPACE {

constexpr std::size_t pairs = pairs_of_block;
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

// Transforms work.one, or leaves the result in work.other; returns where it is.
double* run(const RingFourier& fourier, RingWork& work) {
  double *from = work.one.get(), *to = work.other.get();
  for (const RingFourier::Pass& pass : fourier.passes) {
    switch (pass.radix) {
    case 2: run_pass<2>(pass, from, to); break;
    case 3: run_pass<3>(pass, from, to); break;
    case 4: run_pass<4>(pass, from, to); break;
    case 5: run_pass<5>(pass, from, to); break;
    case 8: run_pass<8>(pass, from, to); break;
    default: run_large_prime(pass, from, to, work.radix.get());
    }
    std::swap(from, to);
  }
  return from;
}

// The first `count` of `lanes` doubles; the others are 0.
HWY_INLINE V load_some(const double* from, std::size_t count) {
  HWY_ALIGN double values[lanes] = {};
  std::copy_n(from, count, values);
  return hn::Load(d, values);
}
HWY_INLINE void store_some(V v, double* to, std::size_t count) {
  HWY_ALIGN double values[lanes];
  hn::Store(v, d, values);
  std::copy_n(values, count, to);
}

void RingsToOrders(const RingFourier& fourier, const RingBlock& block, int lmax, double* cells, std::size_t stride,
                   RingWork& work) {
  const std::size_t n = std::size_t(fourier.length);
  for (std::size_t part = 0; part < pairs; part += lanes) {
    for (std::size_t j = 0; j < n; j += lanes) {
      const std::size_t count = std::min(lanes, n - j);
      V north[lanes], south[lanes];
      const auto load_ring = [&](const double* ring) HWY_ATTR {
        return ring == nullptr ? hn::Zero(d) : count == lanes ? hn::LoadU(d, ring + j) : load_some(ring + j, count);
      };
      for (std::size_t i = 0; i < lanes; ++i) {
        north[i] = load_ring(block.north[part + i]);
        south[i] = load_ring(block.south[part + i]);
      }
      transpose(north);
      transpose(south);
      for (std::size_t i = 0; i < count; ++i) store({north[i], south[i]}, work.one.get() + (j + i) * point);
    }
    const double* row = run(fourier, work);
    // Of z = north + i south: north_m = (z_m + conj z_{n-m}) / 2, south_m = (z_m - conj z_{n-m}) / 2i.
    const V weight = hn::Mul(hn::Set(d, 0.5), hn::LoadU(d, &block.weight[part]));
    const V weight_x = hn::Mul(weight, hn::LoadU(d, &block.x[part]));
    double* to = cells + part;
    for (std::size_t m = 0; m <= std::size_t(lmax); ++m, to += stride) {
      const Complex z = load(row + m * point), mirror = load(row + (m == 0 ? 0 : n - m) * point);
      const V north_re = hn::Add(z.re, mirror.re), north_im = hn::Sub(z.im, mirror.im);
      const V south_re = hn::Add(z.im, mirror.im), south_im = hn::Sub(mirror.re, z.re);
      hn::Store(hn::Mul(weight, hn::Add(north_re, south_re)), d, to);
      hn::Store(hn::Mul(weight, hn::Add(north_im, south_im)), d, to + pairs);
      hn::Store(hn::Mul(weight_x, hn::Sub(north_re, south_re)), d, to + 2 * pairs);
      hn::Store(hn::Mul(weight_x, hn::Sub(north_im, south_im)), d, to + 3 * pairs);
    }
  }
}

void OrdersToRings(const RingFourier& fourier, const RingTargets& block, int lmax, const double* cells,
                   std::size_t stride, RingWork& work) {
  const std::size_t n = std::size_t(fourier.length);
  for (std::size_t part = 0; part < pairs; part += lanes) {
    double* row = work.one.get();
    const V weight = hn::LoadU(d, &block.weight[part]);
    const double* from = cells + part;
    for (std::size_t m = 0; m <= std::size_t(lmax); ++m, from += stride) {
      const V even_re = hn::Mul(weight, hn::Load(d, from)), odd_re = hn::Mul(weight, hn::Load(d, from + 2 * pairs));
      V even_im = hn::Mul(weight, hn::Load(d, from + pairs)), odd_im = hn::Mul(weight, hn::Load(d, from + 3 * pairs));
      if (m == 0) even_im = odd_im = hn::Zero(d);
      const V north_re = hn::Add(even_re, odd_re), south_re = hn::Sub(even_re, odd_re);
      const V north_im = hn::Add(even_im, odd_im), south_im = hn::Sub(even_im, odd_im);
      // conj north_m + i conj south_m at n - m, north_m + i south_m at m; parts exchanged for the inverse transform.
      if (m > 0) store({hn::Sub(south_re, north_im), hn::Add(north_re, south_im)}, row + (n - m) * point);
      store({hn::Add(north_im, south_re), hn::Sub(north_re, south_im)}, row + m * point);
    }
    for (std::size_t m = std::size_t(lmax) + 1; m + std::size_t(lmax) < n; ++m)
      store({hn::Zero(d), hn::Zero(d)}, row + m * point);
    row = run(fourier, work);
    for (std::size_t j = 0; j < n; j += lanes) {
      const std::size_t count = std::min(lanes, n - j);
      V north[lanes], south[lanes];
      for (std::size_t i = 0; i < lanes; ++i) {
        const Complex z = load(row + std::min(j + i, n - 1) * point);
        north[i] = z.im;
        south[i] = z.re;
      }
      transpose(north);
      transpose(south);
      const auto store_ring = [&](V values, double* ring) HWY_ATTR {
        if (ring == nullptr) return;
        if (count == lanes)
          hn::StoreU(values, d, ring + j);
        else
          store_some(values, ring + j, count);
      };
      for (std::size_t i = 0; i < lanes; ++i) {
        store_ring(north[i], block.north[part + i]);
        store_ring(south[i], block.south[part + i]);
      }
    }
  }
}

} // namespace cowgpu::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cowgpu::cpu {

HWY_EXPORT(RingsToOrders);
HWY_EXPORT(OrdersToRings);

namespace {

std::vector<int> radices(int length) {
  std::vector<int> found;
  while (length % 8 == 0 && length != 16) {
    found.push_back(8);
    length /= 8;
  }
  for (const int radix : {4, 2, 3, 5})
    for (; length % radix == 0; length /= radix) found.push_back(radix);
  for (int prime = 7; length > 1; prime += 2) {
    if (prime * prime > length) prime = length; // what is left is a prime
    for (; length % prime == 0; length /= prime) found.push_back(prime);
  }
  return found;
}

bool is_large_prime(int radix) {
  return radix > 5 && radix != 8;
}

// cos and -sin or sin of 2 pi j / n, correctly rounded or nearly.
std::vector<std::array<double, 2>> circle(int n) {
  std::vector<std::array<double, 2>> values(static_cast<std::size_t>(n));
  for (int j = 0; j < n; ++j) {
    const long double angle = 2 * std::numbers::pi_v<long double> * j / n;
    values[std::size_t(j)] = {double(std::cos(angle)), double(std::sin(angle))};
  }
  return values;
}

} // namespace

RingFourier::RingFourier(int length_) : length(length_) {
  const auto turns = circle(length);
  int left = length, stride = 1;
  for (const int radix : radices(length)) {
    Pass pass{radix, left, stride, {}, {}};
    left /= radix;
    pass.twiddle.reserve(std::size_t(left) * std::size_t(radix - 1) * 2);
    for (int p = 0; p < left; ++p)
      for (int k = 1; k < radix; ++k) {
        const auto& turn = turns[std::size_t(p) * std::size_t(k) * std::size_t(stride)];
        pass.twiddle.push_back(turn[0]);
        pass.twiddle.push_back(-turn[1]);
      }
    if (is_large_prime(radix)) {
      for (int j = 0; j < radix; ++j)
        pass.circle.insert(pass.circle.end(), turns[std::size_t(j) * std::size_t(length / radix)].begin(),
                           turns[std::size_t(j) * std::size_t(length / radix)].end());
      largest_prime = std::max(largest_prime, radix);
    }
    passes.push_back(std::move(pass));
    stride *= radix;
  }
}

namespace {

// A row of `points` points, however many lanes there are.
constexpr std::size_t row_doubles(int points) {
  return std::size_t(points) * 2 * pairs_of_block;
}

} // namespace

RingWork::RingWork(const RingFourier& fourier)
    : one(hwy::AllocateAligned<double>(row_doubles(fourier.length))),
      other(hwy::AllocateAligned<double>(row_doubles(fourier.length))),
      radix(hwy::AllocateAligned<double>(row_doubles(std::max(fourier.largest_prime, 1)))) {
  if (!one || !other || !radix) throw std::bad_alloc();
}

std::size_t RingWork::most_bytes(int length) {
  return 3 * row_doubles(length) * sizeof(double);
}

void rings_to_orders(const RingFourier& fourier, const RingBlock& block, int lmax, double* cells, std::size_t stride,
                     RingWork& work) {
  HWY_DYNAMIC_DISPATCH(RingsToOrders)(fourier, block, lmax, cells, stride, work);
}

void orders_to_rings(const RingFourier& fourier, const RingTargets& block, int lmax, const double* cells,
                     std::size_t stride, RingWork& work) {
  HWY_DYNAMIC_DISPATCH(OrdersToRings)(fourier, block, lmax, cells, stride, work);
}

} // namespace cowgpu::cpu
#endif // HWY_ONCE

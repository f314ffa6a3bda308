// A row of the transform is [j][2][lanes]: real and imaginary part of point j of as many pairs of rings as there are
// lanes. Passes are decimation in frequency: output k of a butterfly is multiplied by exp(-2 pi i p k / length). The
// inverse transform is the forward one with real and imaginary parts exchanged on both sides.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/cpu/ring_fourier.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/cpu/fourier_passes-inl.hpp"
#include "host/cpu/lanes-inl.hpp"
#include "host/cpu/ring_fourier.hpp"

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <numbers>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::cpu::HWY_NAMESPACE {

constexpr std::size_t pairs = pairs_of_block;
// Orders whose cells are fetched ahead of their use: they lie too far apart for the processor to foresee.
constexpr std::size_t ahead = 8;

// Transforms work.one; the result is there again.
const double* run(const RingFourier& fourier, RingWork& work) {
  for (const RingFourier::Pass& pass : fourier.passes) {
    const double* from = work.one.get();
    double* to = work.other.get();
    if (!with_radix(pass.radix, [&](auto radix) HWY_ATTR { run_pass<decltype(radix)::value>(pass, from, to); }))
      run_large_prime(pass, from, to, work.radix.get());
    std::swap(work.one, work.other);
  }
  return work.one.get();
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

// Rings are read and written some lines at a time, and the northern ones apart from the southern: rings whose distance is
// a power of two share a few sets of the first-level cache.
constexpr std::size_t stretch = 32; // points

// Points begin ... end - 1 of `lanes` rings to the real parts of a row, or, with the row moved on by `lanes` doubles, to
// its imaginary parts.
HWY_INLINE void gather(const double* const* rings, std::size_t begin, std::size_t end, double* row) {
  for (std::size_t j = begin; j < end; j += lanes) {
    const std::size_t count = std::min(lanes, end - j);
    V v[lanes];
    for (std::size_t i = 0; i < lanes; ++i)
      v[i] = rings[i] == nullptr ? hn::Zero(d)
             : count == lanes    ? hn::LoadU(d, rings[i] + j)
                                 : load_some(rings[i] + j, count);
    transpose(v);
    for (std::size_t i = 0; i < lanes; ++i) hn::Store(v[i], d, row + (j + i) * point);
  }
}

HWY_INLINE void scatter(const double* row, std::size_t begin, std::size_t end, double* const* rings) {
  for (std::size_t j = begin; j < end; j += lanes) {
    const std::size_t count = std::min(lanes, end - j);
    V v[lanes];
    for (std::size_t i = 0; i < lanes; ++i) v[i] = hn::Load(d, row + (j + i) * point);
    transpose(v);
    for (std::size_t i = 0; i < lanes; ++i)
      if (rings[i] != nullptr) {
        if (count == lanes)
          hn::StoreU(v[i], d, rings[i] + j);
        else
          store_some(v[i], rings[i] + j, count);
      }
  }
}

// Of z = north + i south: north_m = (z_m + conj z_{n-m}) / 2, south_m = (z_m - conj z_{n-m}) / 2i.
struct OrderSink {
  double* cells;
  std::size_t stride;
  V weight, weight_x; // half of them

  HWY_INLINE void put(std::size_t m, const Complex& z, const Complex& mirror) const {
    double* to = cells + m * stride;
    const V north_re = hn::Add(z.re, mirror.re), north_im = hn::Sub(z.im, mirror.im);
    const V south_re = hn::Add(z.im, mirror.im), south_im = hn::Sub(mirror.re, z.re);
    hn::Store(hn::Mul(weight, hn::Add(north_re, south_re)), d, to);
    hn::Store(hn::Mul(weight, hn::Add(north_im, south_im)), d, to + pairs);
    hn::Store(hn::Mul(weight_x, hn::Sub(north_re, south_re)), d, to + 2 * pairs);
    hn::Store(hn::Mul(weight_x, hn::Sub(north_im, south_im)), d, to + 3 * pairs);
  }
};

// Point m of the spectrum is north_m + i south_m, point n - m conj north_m + i conj south_m; real and imaginary parts
// are exchanged for the inverse transform.
struct OrderSource {
  const double* cells;
  std::size_t stride;
  V weight;

  HWY_INLINE void get(std::size_t m, Complex& z, Complex& mirror) const {
    const double* from = cells + m * stride;
    for (std::size_t i = 0; i < 4; ++i) hwy::Prefetch(from + ahead * stride + i * pairs);
    const V even_re = hn::Mul(weight, hn::Load(d, from)), odd_re = hn::Mul(weight, hn::Load(d, from + 2 * pairs));
    const V even_im = hn::Mul(weight, hn::Load(d, from + pairs));
    const V odd_im = hn::Mul(weight, hn::Load(d, from + 3 * pairs));
    const V north_re = hn::Add(even_re, odd_re), south_re = hn::Sub(even_re, odd_re);
    const V north_im = hn::Add(even_im, odd_im), south_im = hn::Sub(even_im, odd_im);
    mirror = {hn::Sub(south_re, north_im), hn::Add(north_re, south_im)};
    z = {hn::Add(north_im, south_re), hn::Sub(north_re, south_im)};
  }
  // Order 0, whose imaginary parts do not count.
  HWY_INLINE Complex first() const {
    const V even = hn::Mul(weight, hn::Load(d, cells)), odd = hn::Mul(weight, hn::Load(d, cells + 2 * pairs));
    return {hn::Sub(even, odd), hn::Add(even, odd)};
  }
};

void RingsToOrders(const RingFourier& fourier, const RingBlock& block, int lmax, double* cells, std::size_t stride,
                   RingWork& work) {
  const std::size_t n = std::size_t(fourier.length), orders = std::size_t(lmax) + 1;
  for (std::size_t part = 0; part < pairs; part += lanes) {
    double* values = work.one.get();
    for (std::size_t j = 0; j < n; j += stretch) {
      gather(&block.north[part], j, std::min(n, j + stretch), values);
      gather(&block.south[part], j, std::min(n, j + stretch), values + lanes);
    }
    const double* row = run(fourier, work);
    const V weight = hn::Mul(hn::Set(d, 0.5), hn::LoadU(d, &block.weight[part]));
    const OrderSink sink = {cells + part, stride, weight, hn::Mul(weight, hn::LoadU(d, &block.x[part]))};
    for (std::size_t m = 0; m < orders; ++m)
      sink.put(m, load(row + m * point), load(row + (m == 0 ? 0 : n - m) * point));
  }
}

void OrdersToRings(const RingFourier& fourier, const RingTargets& block, int lmax, const double* cells,
                   std::size_t stride, RingWork& work) {
  const std::size_t n = std::size_t(fourier.length), orders = std::size_t(lmax) + 1;
  for (std::size_t part = 0; part < pairs; part += lanes) {
    const OrderSource source = {cells + part, stride, hn::LoadU(d, &block.weight[part])};
    double* spectrum = work.one.get();
    store(source.first(), spectrum);
    for (std::size_t m = 1; m < orders; ++m) {
      Complex z, mirror;
      source.get(m, z, mirror);
      store(z, spectrum + m * point);
      store(mirror, spectrum + (n - m) * point);
    }
    for (std::size_t m = orders; m + orders <= n; ++m) store({hn::Zero(d), hn::Zero(d)}, spectrum + m * point);
    const double* row = run(fourier, work);
    for (std::size_t j = 0; j < n; j += stretch) {
      scatter(row + lanes, j, std::min(n, j + stretch), &block.north[part]);
      scatter(row, j, std::min(n, j + stretch), &block.south[part]);
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

// A row of `points` points, however many lanes there are, with room for a last group of points that is not full.
constexpr std::size_t row_doubles(int points) {
  return (std::size_t(points) + pairs_of_block) * 2 * pairs_of_block;
}

} // namespace

RingWork::RingWork(const RingFourier& fourier)
    : one(hwy::AllocateAligned<double>(row_doubles(fourier.length))),
      other(hwy::AllocateAligned<double>(row_doubles(fourier.length))),
      radix(hwy::AllocateAligned<double>(row_doubles(fourier.largest_prime))) {
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

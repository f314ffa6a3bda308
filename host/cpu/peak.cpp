#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/cpu/peak.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/cpu/peak.hpp"

#include "host/clock.hpp"
#include "host/parallel.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::cpu::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Twelve independent chains hide the latency of two multiply-add units. Returns flops; the sum keeps the work alive.
double MultiplyAdds(std::size_t rounds, double* sum) {
  const hn::CappedTag<double, 8> d;
  const auto factor = hn::Set(d, 0.999), term = hn::Set(d, 0.001);
  auto a = hn::Set(d, 0.1), b = hn::Set(d, 0.2), c = hn::Set(d, 0.3), e = hn::Set(d, 0.4), f = hn::Set(d, 0.5),
       g = hn::Set(d, 0.6), h = hn::Set(d, 0.7), i = hn::Set(d, 0.8), j = hn::Set(d, 0.9), k = hn::Set(d, 1.1),
       l = hn::Set(d, 1.2), m = hn::Set(d, 1.3);
  for (std::size_t round = 0; round < rounds; ++round) {
    a = hn::MulAdd(a, factor, term);
    b = hn::MulAdd(b, factor, term);
    c = hn::MulAdd(c, factor, term);
    e = hn::MulAdd(e, factor, term);
    f = hn::MulAdd(f, factor, term);
    g = hn::MulAdd(g, factor, term);
    h = hn::MulAdd(h, factor, term);
    i = hn::MulAdd(i, factor, term);
    j = hn::MulAdd(j, factor, term);
    k = hn::MulAdd(k, factor, term);
    l = hn::MulAdd(l, factor, term);
    m = hn::MulAdd(m, factor, term);
  }
  const auto all = hn::Add(hn::Add(hn::Add(a, b), hn::Add(c, e)),
                           hn::Add(hn::Add(hn::Add(f, g), hn::Add(h, i)), hn::Add(hn::Add(j, k), hn::Add(l, m))));
  *sum += hn::GetLane(all);
  return 2.0 * 12 * double(hn::Lanes(d)) * double(rounds);
}

} // namespace cowgpu::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cowgpu::cpu {
HWY_EXPORT(MultiplyAdds);

double peak(unsigned threads) {
  if (threads == 0) threads = all_threads();
  constexpr std::size_t rounds = 1 << 19;
  double best = 0;
  for (int run = 0; run < 6; ++run) {
    std::vector<double> sums(threads, 0.0), flops(threads, 0.0);
    const auto start = Clock::now();
    parallel_for(threads, threads, [&](std::size_t task, unsigned) {
      flops[task] = HWY_DYNAMIC_DISPATCH(MultiplyAdds)(rounds, &sums[task]);
    });
    const double seconds = seconds_since(start);
    double total = 0;
    for (unsigned t = 0; t < threads; ++t) total += sums[t] > 0 ? flops[t] : 0;
    best = std::max(best, total / seconds);
  }
  return best;
}
} // namespace cowgpu::cpu
#endif

// Where the Legendre recurrence starts on each ring. Values far below the range of doubles are carried as
// mantissa * 2^(768 scale), scale = 0, -1, ...; mantissas are rescaled between segments.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/plan/legendre_seeds.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/parallel.hpp"
#include "host/plan/legendre.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::plan::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, block_pairs>;
using V = hn::Vec<D>;
constexpr D d;
constexpr std::size_t lanes = hn::MaxLanes(d);

// Runs one order on one block through a segment; `state` is [previous, current][pair]. Returns the largest mantissa of
// |alpha_k lambda_k| seen on each pair in `largest`.
void run_segment(const Legendre& plan, int m, int block, int begin, int end, double* state, double* largest) {
  const std::size_t at = plan.offset[std::size_t(m)];
  const double* a = &plan.a[at];
  const double* b = block < plan.polar_blocks ? &plan.b_polar[at] : &plan.b[at];
  const double* alpha = &plan.alpha[at];
  const double* t_all = &plan.t[std::size_t(block) * block_pairs];
  for (std::size_t i = 0; i < block_pairs; i += lanes) {
    const V t = hn::LoadU(d, t_all + i);
    V previous = hn::LoadU(d, state + i), current = hn::LoadU(d, state + block_pairs + i), most = hn::Zero(d);
    for (int k = begin; k < end; ++k) {
      most = hn::Max(most, hn::Mul(hn::Abs(current), hn::Set(d, std::fabs(alpha[k]))));
      const V next = hn::MulAdd(hn::MulAdd(hn::Set(d, a[k]), t, hn::Set(d, b[k])), current, previous);
      previous = current;
      current = next;
    }
    hn::StoreU(previous, d, state + i);
    hn::StoreU(current, d, state + block_pairs + i);
    hn::StoreU(most, d, largest + i);
  }
}

} // namespace cowgpu::plan::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cowgpu::plan {

HWY_EXPORT(run_segment);

namespace {

constexpr double unit = 0x1p768, one_unit_less = 0x1p-768, rescale_above = 0x1p600, too_small = 0x1p-900;
constexpr int chunk = 16; // orders for which a task multiplies sin theta up

// lambda_{k-1}, lambda_k of one order on the pairs of a block.
struct State {
  std::array<double, 2 * block_pairs> value;
  std::array<int, block_pairs> scale;
};

// P_mm as a mantissa above too_small and a scale.
void start(State& state, std::size_t pair, long double p) {
  int scale = 0;
  while (p != 0 && std::fabs(p) < too_small) {
    p *= unit;
    --scale;
  }
  state.value[pair] = 0;
  state.value[block_pairs + pair] = double(p);
  state.scale[pair] = scale;
}

double scaled(double mantissa, int scale) {
  return scale == 0 ? mantissa : scale == -1 ? mantissa * one_unit_less : 0;
}

bool rescale(State& state) {
  bool alive = false;
  for (std::size_t i = 0; i < block_pairs; ++i) {
    double &previous = state.value[i], &current = state.value[block_pairs + i];
    if (state.scale[i] < 0 && std::max(std::fabs(previous), std::fabs(current)) > rescale_above) {
      previous *= one_unit_less;
      current *= one_unit_less;
      ++state.scale[i];
    }
    alive = alive || current != 0 || previous != 0;
  }
  return alive;
}

void record(const State& state, double* values) {
  for (std::size_t i = 0; i < 2 * block_pairs; ++i) {
    const double value = scaled(state.value[i], state.scale[i % block_pairs]);
    values[i] = std::fabs(value) < too_small ? 0 : value;
  }
}

// One group of orders m0 ... m1-1 on one block; `powers` holds P_mm [m - m0][pair]. Starts no later than `latest`.
std::uint32_t find_start(const Legendre& plan, const Seeds& seeds, int m0, int m1, int block, std::uint32_t latest,
                         const std::vector<long double>& powers, std::vector<State>& now, std::vector<State>& before,
                         double* values) {
  const auto orders = std::size_t(m1 - m0), value_stride = std::size_t(plan.blocks) * 2 * block_pairs;
  for (std::size_t j = 0; j < orders; ++j)
    for (std::size_t i = 0; i < block_pairs; ++i)
      start(now[j], i, powers[j * std::size_t(plan.blocks) * block_pairs + std::size_t(block) * block_pairs + i]);
  for (std::uint32_t segment = 0; int(segment) * seeds.segment < plan.padded_steps(m0); ++segment) {
    bool found = segment == latest, alive = false;
    for (std::size_t j = 0; j < orders; ++j) {
      const int m = m0 + int(j), begin = int(segment) * seeds.segment;
      const int end = std::min(begin + seeds.segment, plan.steps(m));
      before[j] = now[j];
      if (begin >= end) continue;
      std::array<double, block_pairs> largest;
      HWY_DYNAMIC_DISPATCH(run_segment)(plan, m, block, begin, end, now[j].value.data(), largest.data());
      for (std::size_t i = 0; i < block_pairs; ++i) found = found || scaled(largest[i], now[j].scale[i]) > significant;
      alive = rescale(now[j]) || alive;
    }
    if (found) {
      for (std::size_t j = 0; j < orders; ++j) record(before[j], values + j * value_stride);
      return segment;
    }
    if (!alive) break;
  }
  return Seeds::never;
}

} // namespace

Seeds seeds(const Legendre& plan, int orders, int segment, unsigned threads) {
  const int lmax = plan.lmax;
  const auto padded = std::size_t(plan.blocks) * block_pairs;
  Seeds seeds;
  seeds.orders = orders;
  seeds.segment = segment;
  seeds.groups = lmax / orders + 1;
  seeds.start.assign(std::size_t(seeds.groups) * std::size_t(plan.blocks), Seeds::never);
  seeds.values.assign(std::size_t(lmax + 1) * padded * 2, 0);

  const int groups_a_task = std::max(1, chunk / orders);
  const auto tasks = std::size_t((seeds.groups + groups_a_task - 1) / groups_a_task);
  parallel_for(threads, tasks, [&](std::size_t task, unsigned) {
    const int first = int(task) * groups_a_task * orders, last = std::min(first + groups_a_task * orders, lmax + 1);
    std::vector<long double> power(padded), powers(std::size_t(orders) * padded);
    long double factor = std::sqrt(1 / (4 * std::numbers::pi_v<long double>));
    for (int q = 1; q <= first; ++q) factor *= -std::sqrt((2 * q + 1.0L) / (2 * q));
    for (std::size_t i = 0; i < std::size_t(plan.pairs); ++i)
      power[i] = factor * std::pow(plan.sine[i], (long double)first);
    std::vector<State> now(powers.size() / padded), before(now.size());
    for (int m0 = first; m0 < last; m0 += orders) {
      const int m1 = std::min(m0 + orders, lmax + 1);
      for (int m = m0; m < m1; ++m) {
        std::copy(power.begin(), power.end(), powers.begin() + std::ptrdiff_t(std::size_t(m - m0) * padded));
        const long double next = -std::sqrt((2 * m + 3.0L) / (2 * m + 2));
        for (std::size_t i = 0; i < std::size_t(plan.pairs); ++i) power[i] *= next * plan.sine[i];
      }
      std::uint32_t latest = Seeds::never;
      for (int block = 0; block < plan.blocks; ++block) {
        const std::size_t at = std::size_t(m0 / orders) * std::size_t(plan.blocks) + std::size_t(block);
        double* values =
            &seeds.values[(std::size_t(m0) * std::size_t(plan.blocks) + std::size_t(block)) * 2 * block_pairs];
        latest = seeds.start[at] = find_start(plan, seeds, m0, m1, block, latest, powers, now, before, values);
      }
    }
  });
  return seeds;
}

} // namespace cowgpu::plan
#endif // HWY_ONCE

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/spectrum/directions.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/spectrum/directions.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
constexpr D d;
constexpr std::size_t width = hn::MaxLanes(d);
constexpr std::size_t row = 32; // directions of a block, stride of all arrays over them

template <int n>
void run_vectors(const double* a, const double* b, int count, const double* t, double* previous, double* current,
                 const double* live, double* panel) {
  V t_[n], before[n], now[n], keep[n];
  for (int i = 0; i < n; ++i) {
    t_[i] = hn::Load(d, t + std::size_t(i) * width);
    before[i] = hn::Load(d, previous + std::size_t(i) * width);
    now[i] = hn::Load(d, current + std::size_t(i) * width);
    keep[i] = hn::Load(d, live + std::size_t(i) * width);
  }
  for (int k = 0; k < count; ++k) {
    const V a_k = hn::Set(d, a[k]), b_k = hn::Set(d, b[k]);
    for (int i = 0; i < n; ++i) {
      hn::Store(hn::Mul(keep[i], now[i]), d, panel + std::size_t(k) * row + std::size_t(i) * width);
      const V next = hn::MulAdd(hn::MulAdd(a_k, t_[i], b_k), now[i], before[i]);
      before[i] = now[i];
      now[i] = next;
    }
  }
  for (int i = 0; i < n; ++i) {
    hn::Store(before[i], d, previous + std::size_t(i) * width);
    hn::Store(now[i], d, current + std::size_t(i) * width);
  }
}

// The recurrence on the first `used` lanes; panel[k][lane] = lambda_k live.
void run_steps(const double* a, const double* b, int count, std::size_t used, const double* t, double* previous,
               double* current, const double* live, double* panel) {
  std::size_t i = 0;
  for (; i + 4 * width <= used; i += 4 * width)
    run_vectors<4>(a, b, count, t + i, previous + i, current + i, live + i, panel + i);
  for (; i < used; i += width) run_vectors<1>(a, b, count, t + i, previous + i, current + i, live + i, panel + i);
}

template <int n>
void add_vectors(const double* panel, const double* q, int count, double* sums) {
  V sum[4][n];
  for (std::size_t c = 0; c < 4; ++c)
    for (int i = 0; i < n; ++i) sum[c][i] = hn::Load(d, sums + c * row + std::size_t(i) * width);
  for (int k = 0; k < count; ++k, panel += row, q += 4)
    for (int i = 0; i < n; ++i) {
      const V lambda = hn::Load(d, panel + std::size_t(i) * width);
      for (int c = 0; c < 4; ++c) sum[c][i] = hn::MulAdd(lambda, hn::Set(d, q[c]), sum[c][i]);
    }
  for (std::size_t c = 0; c < 4; ++c)
    for (int i = 0; i < n; ++i) hn::Store(sum[c][i], d, sums + c * row + std::size_t(i) * width);
}

// sums[c][lane] += sum_k panel[k][lane] q[k][c].
void add_steps(const double* panel, const double* q, int count, std::size_t used, double* sums) {
  std::size_t i = 0;
  for (; i + 2 * width <= used; i += 2 * width) add_vectors<2>(panel + i, q, count, sums + i);
  for (; i < used; i += width) add_vectors<1>(panel + i, q, count, sums + i);
}

} // namespace cowgpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "host/error.hpp"
#include "host/parallel.hpp"
#include "host/spectrum/derivatives.hpp"
#include "host/sphere_grid.hpp"

#include <fmt/format.h>

#include <atomic>
#include <numbers>
#include <numeric>

namespace cowgpu {

HWY_EXPORT(run_steps);
HWY_EXPORT(add_steps);

namespace {

constexpr std::size_t lanes = 32, few_lanes = 8; // lanes of a block, if there are many directions and if there are few
constexpr int panel_steps = 64, segment = 8;     // steps k between sums, between looks at the range
constexpr int phase_table = 32;                  // exp(i m phi) = coarse[m / 32] fine[m % 32]
constexpr double unit = 0x1p768, one_unit_less = 0x1p-768, rescale_above = 0x1p600, too_small = 0x1p-900;

// exp(i m phi), m phi taken with twice the digits.
std::complex<double> phase(const Direction& direction, int m) {
  const double angle = m * direction.phi;
  const double rest = std::fma(double(m), direction.phi, -angle) + m * direction.phi_remainder;
  const double c = std::cos(angle), s = std::sin(angle);
  return {c - rest * s, s + rest * c};
}

// Adds Re(sum turn) to a field, and its derivative by phi where there is a place for it.
void add_order(int m, std::complex<double> sum, std::complex<double> turn, double& value, double* d_phi) {
  value += sum.real() * turn.real() - sum.imag() * turn.imag();
  if (d_phi) *d_phi -= m * (sum.real() * turn.imag() + sum.imag() * turn.real());
}

// From the sums of the fields, of their X and Y in turn and of their d_phi.
template <class Sum>
void store(const Direction& direction, std::size_t index, std::size_t directions, std::size_t fields,
           DirectionValues& result, const Sum& sum) {
  const std::complex<double> meridian = phase(direction, 1);
  for (std::size_t f = 0, to = index; f < fields; ++f, to += directions) {
    result.values[to] = sum(f);
    if (result.d_phi.empty()) continue;
    result.d_theta[to] = meridian.real() * sum(fields + 2 * f) + meridian.imag() * sum(fields + 2 * f + 1);
    result.d_phi[to] = sum(3 * fields + f);
  }
}

} // namespace

// Directions side by side, all nearer to the poles or all nearer to the equator.
struct DirectionSynthesis::Block {
  using Lanes = std::array<double, lanes>;
  std::size_t used = 0; // lanes at work, a multiple of few_lanes
  std::array<std::size_t, lanes> index;
  std::size_t count = 0; // directions
  bool polar = false;
  alignas(64) Lanes x, t, previous, current, live, cosine, sine;
  alignas(64) std::array<Lanes, panel_steps> panel;
  std::array<std::array<std::complex<double>, lanes>, phase_table> fine;
  std::array<std::complex<double>, lanes> coarse;
  std::array<long double, lanes> power, sine_theta; // P_mm
  std::array<int, lanes> scale;
  struct alignas(64) Sums {
    std::array<Lanes, 4> value; // E and O, real and imaginary
  };
  std::vector<Sums> sums;     // sums of each field
  std::vector<Lanes> results; // results of each field, then d_phi

  // P_mm as a mantissa above too_small and a scale.
  void start() {
    for (std::size_t i = 0; i < lanes; ++i) {
      long double p = power[i];
      scale[i] = 0;
      while (p != 0 && std::fabs(p) < too_small) {
        p *= unit;
        --scale[i];
      }
      previous[i] = 0;
      current[i] = double(p);
    }
  }
  bool all_live() {
    bool all = true;
    for (std::size_t i = 0; i < used; ++i) {
      live[i] = scale[i] == 0 ? 1 : 0;
      all = all && scale[i] == 0;
    }
    return all;
  }
  void rescale() {
    for (std::size_t i = 0; i < used; ++i)
      if (scale[i] < 0 && std::max(std::fabs(previous[i]), std::fabs(current[i])) > rescale_above) {
        previous[i] *= one_unit_less;
        current[i] *= one_unit_less;
        ++scale[i];
      }
  }
};

Direction direction(double theta, double phi) {
  if (!(std::fabs(theta) <= 1e6) || !(std::fabs(phi) <= 1e6))
    throw Error(Fault::bad_argument,
                fmt::format("the direction at theta {} and phi {} is out of range: radians up to 1e6 are possible",
                            theta, phi));
  return {std::cos((long double)theta), std::sin((long double)theta), phi, 0};
}

Direction direction(const Vec3& r) {
  const long double x = r.x(), y = r.y(), z = r.z(), rho = std::hypot(x, y), length = std::hypot(rho, z);
  if (!(length > 0) || !std::isfinite(length))
    throw Error(
        Fault::bad_argument,
        fmt::format("({}, {}, {}) is not a direction: it must have a finite length above 0", r.x(), r.y(), r.z()));
  const long double phi = std::atan2(y, x);
  return {z / length, rho / length, double(phi), double(phi - double(phi))};
}

DirectionSynthesis::DirectionSynthesis(const SphereCoefficients& coefficients, bool derivatives, unsigned threads)
    : cap_(std::clamp(coefficients.lmax, 0, largest_grid_degree)), fields_(coefficients.fields),
      summed_(coefficients.fields * (derivatives ? 3 : 1)), derivatives_(derivatives), threads_(threads) {
  const int lmax = coefficients.lmax;
  if (lmax < 0 || lmax > largest_grid_degree || fields_ < 0)
    throw Error(Fault::bad_argument,
                fmt::format("{} fields cannot be synthesised to degree {}: degrees 0 to {} are possible", fields_, lmax,
                            largest_grid_degree));
  plan_ = plan::recurrence(lmax, threads);
  steps_.resize(plan_.offset.back() * 4 * std::size_t(summed_));
  const auto prepare = [&](const SphereCoefficients& a, int first) {
    parallel_for(threads, std::size_t(lmax) + 1, [&](std::size_t task, unsigned) {
      const int m = int(task);
      const auto padded = std::size_t(plan_.padded_steps(m));
      for (int f = 0; f < a.fields; ++f)
        plan::prepare_synthesis(
            plan_, m, a.field(f).subspan(SphereCoefficients::index(lmax, m, m), std::size_t(lmax + 1 - m)),
            &steps_[4 * (plan_.offset[task] * std::size_t(summed_) + std::size_t(first + f) * padded)], 4);
    });
  };
  prepare(coefficients, 0);
  cap_.add(coefficients);
  if (derivatives) {
    const SphereCoefficients both = tilts(coefficients);
    prepare(both, fields_);
    cap_.add(both);
  }
  plan_.alpha = {};
  plan_.e = {};
}

DirectionValues DirectionSynthesis::at(std::span<const Direction> directions, Monitor& monitor) const {
  const std::size_t n = directions.size();
  DirectionValues result;
  result.values.resize(std::size_t(fields_) * n);
  if (derivatives_) result.d_theta.resize(result.values.size());
  if (derivatives_) result.d_phi.resize(result.values.size());
  if (result.values.empty()) return result;

  // Neighbours in latitude side by side, from the equator to the poles: the longest first.
  const auto sine = [&](std::size_t i) { return std::fabs(directions[i].sine); };
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return sine(i) > sine(j) || (sine(i) == sine(j) && i < j); });
  const auto first_below = [&](long double limit) {
    return std::size_t(
        std::partition_point(order.begin(), order.end(), [&](std::size_t i) { return sine(i) > limit; }) -
        order.begin());
  };
  const std::size_t cap = first_below(cap_.sine()); // from here on
  const std::size_t polar = std::min(cap, first_below(std::numbers::sqrt2_v<long double> / 2));
  const unsigned threads = threads_ ? threads_ : all_threads();
  const std::size_t size = n >= 2 * lanes * threads ? lanes : few_lanes;
  const auto blocks = [size](std::size_t count) { return (count + size - 1) / size; };
  const std::size_t equatorial = blocks(polar), lower = equatorial + blocks(cap - polar), tasks = lower + (n - cap);

  std::vector<Block> spaces(std::min<std::size_t>(threads, tasks));
  std::atomic<std::size_t> finished{0};
  parallel_for(threads, tasks, [&](std::size_t task, unsigned thread) {
    check_stop(monitor);
    if (task >= lower) {
      evaluate_polar(order[cap + (task - lower)], directions, result);
    } else {
      Block& block = spaces[thread];
      block.polar = task >= equatorial;
      const std::size_t first = block.polar ? polar + (task - equatorial) * size : task * size;
      block.count = std::min(size, (block.polar ? cap : polar) - first);
      block.used = (block.count + few_lanes - 1) / few_lanes * few_lanes;
      std::copy_n(order.begin() + std::ptrdiff_t(first), block.count, block.index.begin());
      evaluate(block, directions, result);
    }
    const std::size_t now = ++finished;
    if (thread == 0) monitor.progress("synthesis at directions", double(now) / double(tasks));
  });
  return result;
}

void DirectionSynthesis::evaluate(Block& block, std::span<const Direction> directions, DirectionValues& result) const {
  const std::size_t n = directions.size(), fields = std::size_t(fields_), summed = std::size_t(summed_);
  block.x.fill(0);
  block.t.fill(0);
  block.power.fill(0);
  block.sine_theta.fill(0);
  for (std::size_t i = 0; i < block.count; ++i) {
    const Direction& at = directions[block.index[i]];
    block.x[i] = double(at.cosine);
    block.t[i] = double(block.polar ? -at.sine * at.sine : at.cosine * at.cosine);
    block.sine_theta[i] = at.sine;
    block.power[i] = 1 / std::sqrt(4 * std::numbers::pi_v<long double>);
    for (int m = 0; m < phase_table; ++m) block.fine[std::size_t(m)][i] = phase(at, m);
  }
  block.sums.resize(summed);
  block.results.assign(summed + (derivatives_ ? fields : 0), {});

  for (int m = 0; m <= plan_.lmax; ++m) {
    if (m % phase_table == 0)
      for (std::size_t i = 0; i < block.count; ++i) block.coarse[i] = phase(directions[block.index[i]], m);
    if (std::all_of(block.power.begin(), block.power.end(), [](long double p) { return p == 0; })) break;
    block.start();
    for (auto& sums : block.sums)
      for (auto& part : sums.value) part.fill(0);

    const std::size_t offset = plan_.offset[std::size_t(m)];
    const double* a = &plan_.a[offset];
    const double* b = block.polar ? &plan_.b_polar[offset] : &plan_.b[offset];
    const int steps = plan_.steps(m), padded = plan_.padded_steps(m);
    for (int first = 0; first < steps; first += panel_steps) {
      const int count = std::min(panel_steps, steps - first);
      bool some = false;
      for (int k = 0, part = 0; k < count; k += part) {
        part = block.all_live() ? count - k : std::min(segment, count - k);
        some = some || *std::max_element(block.live.begin(), block.live.begin() + std::ptrdiff_t(block.used)) > 0;
        HWY_DYNAMIC_DISPATCH(run_steps)
        (a + first + k, b + first + k, part, block.used, block.t.data(), block.previous.data(), block.current.data(),
         block.live.data(), block.panel[std::size_t(k)].data());
        block.rescale();
      }
      if (!some) continue;
      for (std::size_t f = 0; f < summed; ++f) HWY_DYNAMIC_DISPATCH(add_steps)
      (block.panel[0].data(), &steps_[4 * (offset * summed + f * std::size_t(padded) + std::size_t(first))], count,
       block.used, block.sums[f].value[0].data());
    }

    const double twice = m == 0 ? 1 : 2;
    const long double next = -std::sqrt((2 * m + 3.0L) / (2 * m + 2));
    for (std::size_t i = 0; i < block.count; ++i) {
      // A lane that never came into the range of doubles will not at higher orders either.
      block.power[i] *= block.scale[i] < 0 ? 0 : next * block.sine_theta[i];
      const std::complex<double> turn = twice * block.coarse[i] * block.fine[std::size_t(m % phase_table)][i];
      for (std::size_t f = 0; f < summed; ++f) {
        const auto& s = block.sums[f].value;
        const double re = s[0][i] + block.x[i] * s[2][i], im = s[1][i] + block.x[i] * s[3][i];
        const bool with_phi = derivatives_ && f < fields;
        add_order(m, {re, im}, turn, block.results[f][i], with_phi ? &block.results[summed + f][i] : nullptr);
      }
    }
  }

  for (std::size_t i = 0; i < block.count; ++i)
    store(directions[block.index[i]], block.index[i], n, fields, result,
          [&](std::size_t f) { return block.results[f][i]; });
}

void DirectionSynthesis::evaluate_polar(std::size_t index, std::span<const Direction> directions,
                                        DirectionValues& result) const {
  const Direction& at = directions[index];
  const std::size_t fields = std::size_t(fields_), summed = std::size_t(summed_);
  std::vector<std::complex<double>> sums(summed);
  std::vector<double> results(summed + fields);
  for (int m = 0; m < cap_.orders(); ++m) {
    cap_.sum(m, at.cosine, at.sine, sums.data());
    const std::complex<double> turn = (m == 0 ? 1.0 : 2.0) * phase(at, m);
    for (std::size_t f = 0; f < summed; ++f)
      add_order(m, sums[f], turn, results[f], f < fields ? &results[summed + f] : nullptr);
  }
  store(at, index, directions.size(), fields, result, [&](std::size_t f) { return results[f]; });
}

} // namespace cowgpu
#endif // HWY_ONCE

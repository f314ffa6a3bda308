#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/spectrum/quarter_turn.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/parallel.hpp"
#include "host/spectrum/quarter_turn.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, QuarterTurn::lanes>;
using V = hn::Vec<D>;
using Row = QuarterTurn::Row;
constexpr D d;
constexpr std::size_t width = hn::MaxLanes(d);

// Advances a row by one degree.
HWY_INLINE void advance(V step, V factor, V& previous, V& current) {
  const V next = hn::MulSub(hn::Mul(step, factor), current, previous);
  previous = current;
  current = next;
}

// Runs one row from degree `begin` to before `end`. Lanes are counted where `live` is 1, not where it is 0.
void run(const QuarterTurn::Tables& t, int block, Row& row, int begin, int end, const double* live) {
  constexpr std::size_t lanes = QuarterTurn::lanes;
  for (std::size_t i = 0; i < lanes; i += width) {
    const double* factor = t.row(t.factor.get(), block, begin) + i;
    const double* a[2] = {t.row(t.even.get(), block, begin) + i, t.row(t.odd.get(), block, begin) + i};
    V previous = hn::LoadU(d, row.previous.data() + i), current = hn::LoadU(d, row.current.data() + i);
    const V keep = hn::LoadU(d, live + i);
    for (int l = begin; l < end; ++l) {
      const std::size_t at = std::size_t(l - begin) * lanes;
      double* sum = row.sums + std::size_t(l) * lanes + i;
      const V value = hn::Mul(keep, current), packed = hn::Load(d, a[(l + row.m) % 2] + at);
      hn::Store(hn::MulAdd(value, packed, hn::Load(d, sum)), d, sum);
      advance(hn::Set(d, row.step[l]), hn::Load(d, factor + at), previous, current);
    }
    hn::StoreU(previous, d, row.previous.data() + i);
    hn::StoreU(current, d, row.current.data() + i);
  }
}

// Adds to sum[4][2] the sums over the even and over the odd lanes of each of four vectors; `i` is their first lane.
HWY_INLINE void add_lanes(const V* v, [[maybe_unused]] std::size_t i, double* sum) {
  if constexpr (width == 8) {
#if HWY_TARGET != HWY_SCALAR
    const V x = hn::Add(hn::ConcatLowerLower(d, v[2], v[0]), hn::ConcatUpperUpper(d, v[2], v[0]));
    const V y = hn::Add(hn::ConcatLowerLower(d, v[3], v[1]), hn::ConcatUpperUpper(d, v[3], v[1]));
    const V all =
        hn::Add(hn::OddEvenBlocks(hn::SwapAdjacentBlocks(y), x), hn::OddEvenBlocks(y, hn::SwapAdjacentBlocks(x)));
    hn::Store(hn::Add(hn::Load(d, sum), all), d, sum);
  } else if constexpr (width == 4) {
    for (std::size_t j = 0; j < 4; j += 2) {
      const V both = hn::Add(hn::ConcatLowerLower(d, v[j + 1], v[j]), hn::ConcatUpperUpper(d, v[j + 1], v[j]));
      hn::Store(hn::Add(hn::Load(d, sum + 2 * j), both), d, sum + 2 * j);
    }
  } else if constexpr (width == 2) {
    for (std::size_t j = 0; j < 4; ++j) hn::Store(hn::Add(hn::Load(d, sum + 2 * j), v[j]), d, sum + 2 * j);
  } else {
#endif
    for (std::size_t j = 0; j < 4; ++j) sum[2 * j + i % 2] += hn::GetLane(v[j]);
  }
}

// Runs four rows of consecutive orders from degree `begin` to the last. sums[l][4][2]: over even and odd lanes.
void run_group(const QuarterTurn::Tables& t, int block, Row* rows, int begin, double* sums) {
  constexpr std::size_t lanes = QuarterTurn::lanes;
  constexpr int n = QuarterTurn::group;
  static_assert(n == 4, "add_lanes spells out four vectors");
  for (std::size_t i = 0; i < lanes; i += width) {
    const double* factor = t.row(t.factor.get(), block, begin) + i;
    const double* same = t.row(t.even.get(), block, begin) + i;
    const double* other = t.row(t.odd.get(), block, begin) + i;
    if ((begin + rows[0].m) % 2) std::swap(same, other);
    V previous[n], current[n];
    for (int j = 0; j < n; ++j) {
      previous[j] = hn::LoadU(d, rows[j].previous.data() + i);
      current[j] = hn::LoadU(d, rows[j].current.data() + i);
    }
    const double* step[n] = {rows[0].step, rows[1].step, rows[2].step, rows[3].step};
    const auto one_degree = [&](int l, const double* first, const double* second) HWY_ATTR {
      const std::size_t at = std::size_t(l - begin) * lanes;
      const V f = hn::Load(d, factor + at), a[2] = {hn::Load(d, first + at), hn::Load(d, second + at)};
      V products[n];
      for (int j = 0; j < n; ++j) {
        products[j] = hn::Mul(current[j], a[j % 2]);
        advance(hn::Set(d, step[j][l]), f, previous[j], current[j]);
      }
      add_lanes(products, i, sums + std::size_t(l) * 2 * n);
    };
    int l = begin;
    for (; l < t.lmax; l += 2) {
      one_degree(l, same, other);
      one_degree(l + 1, other, same);
    }
    if (l == t.lmax) one_degree(l, same, other);
  }
}

// Takes up lanes that start at degree l; true while others are still to come.
bool start_lanes(Row& row, int first, int lmax, int l) {
  bool more = false;
  for (int i = 0; i < QuarterTurn::lanes && first + i <= lmax; ++i) {
    const int from = std::max(row.m, first + i);
    more = more || from > l;
    if (from != l) continue;
    const auto lane = std::size_t(i), at = std::size_t(first + i);
    row.current[lane] = row.start[at];
    row.scale[lane] = row.start_scale[at];
  }
  return more;
}

// Runs a row until all its lanes have started and are in the range of doubles; returns the degree it has come to.
int run_up(const QuarterTurn::Tables& t, int block, Row& row) {
  const int first = block * QuarterTurn::lanes;
  int l = std::max(row.m, first);
  row.previous.fill(0);
  row.current.fill(0);
  row.scale.fill(0);
  for (bool more = true; l <= t.lmax;) {
    more = more && start_lanes(row, first, t.lmax, l);
    HWY_ALIGN double live[QuarterTurn::lanes];
    bool all_live = true;
    for (std::size_t i = 0; i < QuarterTurn::lanes; ++i) {
      live[i] = row.scale[i] == 0 ? 1 : 0;
      all_live = all_live && row.scale[i] == 0;
    }
    if (all_live && !more) break;
    const int end = more ? l + 1 : std::min(l + 8, t.lmax + 1);
    run(t, block, row, l, end, live);
    l = end;
    for (std::size_t i = 0; i < QuarterTurn::lanes; ++i)
      if (row.scale[i] < 0 && std::fabs(row.current[i]) > QuarterTurn::rescale_above) {
        row.previous[i] *= QuarterTurn::unit;
        row.current[i] *= QuarterTurn::unit;
        ++row.scale[i];
      }
  }
  return l;
}

// Four rows at most: m = m_0, m_0 + 1, ...
void turn_rows(const QuarterTurn::Tables& t, int block, Row* rows, int count, double* sums) {
  HWY_ALIGN static constexpr double all[QuarterTurn::lanes] = {1, 1, 1, 1, 1, 1, 1, 1};
  std::array<int, QuarterTurn::group> reached{};
  int together = 0;
  for (int j = 0; j < count; ++j) {
    reached[std::size_t(j)] = run_up(t, block, rows[j]);
    together = std::max(together, reached[std::size_t(j)]);
  }
  if (count < QuarterTurn::group) together = t.lmax + 1;
  for (int j = 0; j < count; ++j)
    if (reached[std::size_t(j)] < together) run(t, block, rows[j], reached[std::size_t(j)], together, all);
  if (together <= t.lmax) run_group(t, block, rows, together, sums);
}

// All rows of a task block by block, so that what a block reads stays in the cache.
void turn(const QuarterTurn::Tables& t, Row* rows, int count, double* group_sums) {
  const std::size_t stride = std::size_t(t.lmax + 1) * 2 * QuarterTurn::group;
  for (int block = 0; block < t.blocks; ++block)
    for (int first = 0, g = 0; first < count; first += QuarterTurn::group, ++g)
      turn_rows(t, block, rows + first, std::min(QuarterTurn::group, count - first),
                group_sums + std::size_t(g) * stride);
}

} // namespace cowgpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "host/sphere_coefficients.hpp"

namespace cowgpu {

HWY_EXPORT(turn);

namespace {

constexpr int start_exponent = 16000; // exponent of the squares of start values while they are multiplied up

// w_l(m)^2, l = m, m + 1, ...
class Scale {
public:
  explicit Scale(int m) : m_(m), l_(m), square_(1 / std::sqrt(2 * m + 1.0L)) {}
  long double square() const { return square_; }
  void next() {
    ++l_;
    square_ = 1 / (square_ * ((long double)(l_ - m_) * (l_ + m_)));
  }

private:
  int m_, l_;
  long double square_;
};

struct Workspace {
  hwy::AlignedFreeUniquePtr<double[]> sums, group_sums;
  std::vector<double> step, out, start;
  std::vector<int> start_scale;

  explicit Workspace(int lmax) {
    const auto all = std::size_t(lmax + 1) * QuarterTurn::task_orders;
    sums = hwy::AllocateAligned<double>(all * QuarterTurn::lanes);
    group_sums = hwy::AllocateAligned<double>(all * 2);
    step.resize(all);
    out.resize(all);
    start.resize(all);
    start_scale.resize(all);
  }
};

// value * 2^exponent as a mantissa within doubles and a power of QuarterTurn::unit.
void set_start(long double value, int exponent, double& mantissa, int& scale) {
  int own = 0;
  const long double fraction = std::frexp(value, &own);
  exponent += own;
  scale = std::min(0, (exponent - 384) / 768);
  mantissa = double(std::ldexp(fraction, exponent - 768 * scale));
}

} // namespace

QuarterTurn::QuarterTurn(int lmax, unsigned threads) : threads_(threads) {
  Tables& t = tables_;
  t.lmax = lmax;
  t.blocks = lmax / lanes + 1;
  t.offset.assign(std::size_t(t.blocks) + 1, 0);
  for (int block = 0; block < t.blocks; ++block)
    t.offset[std::size_t(block) + 1] = t.offset[std::size_t(block)] + std::size_t(lmax + 1 - block * lanes) * lanes;
  for (auto* array : {&t.factor, &t.even, &t.odd}) {
    *array = hwy::AllocateAligned<double>(t.offset.back());
    std::fill_n(array->get(), t.offset.back(), 0.0);
  }
  long double v = 1;
  Scale zero(0);
  for (int l = 0; l <= lmax; ++l) {
    v_.push_back(double(v));
    x_.push_back(l == 0 ? 0 : double((2 * l + 1) * v * v / ((long double)l * (l + 1))));
    v = (l + 1) / v;
    zero_.push_back(std::sqrt(double(zero.square())));
    zero.next();
  }
  parallel_for(threads_, std::size_t(t.blocks), [&](std::size_t block, unsigned) {
    const int first = int(block) * lanes;
    double* factor = t.factor.get() + t.offset[block];
    for (int m = first; m <= std::min(first + lanes - 1, lmax); ++m) {
      Scale scale(m);
      for (int l = m; l <= lmax; ++l, scale.next())
        factor[(l - first) * lanes + m - first] = double(m * scale.square());
    }
  });
}

void QuarterTurn::pack(std::span<const std::complex<double>> coefficients) {
  const int lmax = tables_.lmax;
  parallel_for(threads_, std::size_t(tables_.blocks), [&](std::size_t block, unsigned) {
    const int first = int(block) * lanes;
    double* even = tables_.even.get() + tables_.offset[block];
    double* odd = tables_.odd.get() + tables_.offset[block];
    for (int m = first; m <= std::min(first + lanes - 1, lmax); ++m) {
      Scale scale(m);
      for (int l = m; l <= lmax; ++l, scale.next()) {
        const std::complex<double> a = coefficients[SphereCoefficients::index(lmax, l, m)];
        const auto at = std::ptrdiff_t(l - first) * lanes + m - first;
        const double w = std::sqrt(double(scale.square())) * (m == 0 ? 1 : 2);
        const double re = w * a.real(), im = m == 0 ? 0 : w * a.imag();
        even[at] = m % 2 ? im : re;
        odd[at] = m % 2 ? re : im;
      }
    }
  });
}

void QuarterTurn::apply(std::span<std::complex<double>> coefficients, Monitor& monitor, double done, double share) {
  const int lmax = tables_.lmax;
  const auto stride = std::size_t(lmax + 1);
  pack(coefficients);

  // w_m(m') for m' <= m and w_m'(m) for m' > m, and the sums' factors.
  const auto set_row = [&](Row& row, Workspace& space, std::size_t j) {
    const int m = row.m;
    double* step = space.step.data() + j * stride;
    double* out = space.out.data() + j * stride;
    double* start = space.start.data() + j * stride;
    int* start_scale = space.start_scale.data() + j * stride;
    row.step = step;
    row.sums = space.sums.get() + j * stride * lanes;
    row.start = start;
    row.start_scale = start_scale;
    std::fill_n(row.sums, stride * lanes, 0.0);
    const long double first = std::ldexp(1.0L, start_exponent - 2 * m); // squares of d, over 2^start_exponent
    Scale scale(m);
    const double w_m = std::sqrt(double(scale.square()));
    long double square = first;
    for (int l = m; l <= lmax; ++l, scale.next()) {
      const double w = std::sqrt(double(scale.square()));
      step[l] = double(-m * (x_[std::size_t(l)] * scale.square()));
      out[l] = w * v_[std::size_t(l)];
      const double own = 1 / std::sqrt(std::sqrt(2 * l + 1.0)); // w_l(l)
      set_start(std::sqrt(square) / (own * out[l]), -start_exponent / 2, start[l], start_scale[l]);
      square *= (l + 1) * (2 * l + 1.0L) / (2 * (long double)(l + 1 - m) * (l + 1 + m));
    }
    square = first;
    for (int other = m - 1; other >= 0; --other) {
      square *= (long double)(m + other + 1) / (m - other);
      double w_other = 0; // w_m(other)
      if (other > 0) {
        const double factor = tables_.row(tables_.factor.get(), other / lanes, m)[other % lanes];
        w_other = std::sqrt(factor / other);
      } else {
        w_other = zero_[std::size_t(m)];
      }
      const double sign = (m - other) % 2 ? -1 : 1;
      set_start(sign * std::sqrt(square) / (w_other * w_m * v_[std::size_t(m)]), -start_exponent / 2, start[other],
                start_scale[other]);
    }
  };

  const std::size_t tasks = std::size_t(lmax) / task_orders + 1;
  const unsigned threads = threads_ ? threads_ : all_threads();
  std::vector<Workspace> spaces;
  for (unsigned i = 0; i < std::min<std::size_t>(threads, tasks); ++i) spaces.emplace_back(lmax);
  std::atomic<std::size_t> finished{0};
  parallel_for(threads, tasks, [&](std::size_t task, unsigned thread) {
    check_stop(monitor);
    Workspace& space = spaces[thread];
    std::array<Row, task_orders> rows;
    const int first = int(task) * task_orders, count = std::min<int>(task_orders, lmax + 1 - first);
    std::fill_n(space.group_sums.get(), stride * task_orders * 2, 0.0);
    for (int j = 0; j < count; ++j) {
      rows[std::size_t(j)].m = first + j;
      set_row(rows[std::size_t(j)], space, std::size_t(j));
    }
    HWY_DYNAMIC_DISPATCH(turn)(tables_, rows.data(), count, space.group_sums.get());
    for (int j = 0; j < count; ++j) {
      const Row& row = rows[std::size_t(j)];
      const double* out = space.out.data() + std::size_t(j) * stride;
      const double* group_sums = space.group_sums.get() + std::size_t(j / group) * stride * 2 * group;
      for (int l = row.m; l <= lmax; ++l) {
        const double* s = row.sums + std::ptrdiff_t(l) * lanes;
        const double* more = group_sums + (l * group + j % group) * 2;
        double even = more[0] + ((s[0] + s[2]) + (s[4] + s[6])), odd = more[1] + ((s[1] + s[3]) + (s[5] + s[7]));
        if ((l + row.m) % 2) std::swap(even, odd);
        coefficients[SphereCoefficients::index(lmax, l, row.m)] = {out[l] * even, row.m == 0 ? 0 : out[l] * odd};
      }
    }
    const std::size_t now = ++finished;
    if (thread == 0) monitor.progress("rotation", done + share * double(now) / double(tasks));
  });
}

} // namespace cowgpu
#endif // HWY_ONCE

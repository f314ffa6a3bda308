// Lanes are pairs of rings. A few vectors of them run the recurrence in registers: in synthesis over all k, their sums in
// registers as well; in analysis of one field through a chunk of k, the rings' values in registers and the sums of every
// k, still one per lane, in the first-level cache. With several fields, analysis writes lambda of a panel of rings and a
// segment of k to the cache and multiplies that by the matrix of the rings' values.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/cpu/legendre.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/cpu/lanes-inl.hpp"
#include "host/cpu/legendre.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <cstring>
#include <new>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::cpu::HWY_NAMESPACE {

constexpr std::size_t pairs = plan::block_pairs, cell = SpectrumLayout::cell;
constexpr std::size_t parts = pairs / lanes; // vectors of a block
constexpr bool many_registers = lanes == 8;  // 32, else 16
constexpr std::size_t segment = 8;           // steps k between two looks at the starts

// Vectors of rings that share every broadcast coefficient: as many as registers allow.
constexpr std::size_t synthesis_vectors(int fields) {
  return many_registers ? (fields == 1 ? 4 : 2) : (fields == 1 ? 2 : 1);
}
constexpr std::size_t analysis_vectors = many_registers ? 4 : 2;
constexpr std::size_t recurrence_vectors = many_registers ? 8 : 4;

// Analysis of one field: steps of a chunk, whose sums take 24 KiB.
constexpr std::size_t chunk_steps = 3072 / (4 * lanes);
// Analysis of several: vectors of a panel, and where its parts stand in the chunk.
constexpr std::size_t panel_vectors = 40 * parts;
static_assert((segment + 2) * panel_vectors * lanes <= 3200);

// One order on the blocks that share a form of the recurrence. Vectors are counted from the first block of all.
struct Rows {
  const double *a, *b, *t, *x;
  const std::uint32_t* start;
  const double* seeds; // [block][2][pairs]
  std::size_t blocks;  // blocks of the plan
  std::uint32_t segments;

  std::uint32_t start_of(std::size_t vector) const { return start[vector / parts]; }
  const double* seed(std::size_t vector) const { return seeds + vector / parts * 2 * pairs + vector % parts * lanes; }
};

// What is left over by groups of N vectors: body(rest as a constant, first), unless there is none.
template <std::size_t N, class Body>
HWY_INLINE void for_rest(std::size_t first, std::size_t rest, const Body& body) {
  if constexpr (N > 1) {
    if (rest == N - 1)
      body(std::integral_constant<std::size_t, N - 1>(), first);
    else
      for_rest<N - 1>(first, rest, body);
  }
}

template <int Fields, std::size_t N>
HWY_INLINE void synthesise_vectors(const Rows& rows, std::size_t vector, const double* q, double* cells) {
  constexpr std::size_t sums = 4 * std::size_t(Fields);
  V previous[N], current[N], t[N], sum[sums][N];
  for (std::size_t v = 0; v < N; ++v) {
    previous[v] = current[v] = hn::Zero(d);
    t[v] = hn::LoadU(d, rows.t + (vector + v) * lanes);
    for (std::size_t u = 0; u < sums; ++u) sum[u][v] = hn::Zero(d);
  }
  const std::uint32_t last = rows.start_of(vector);
  for (std::uint32_t g = rows.start_of(vector + N - 1); g < rows.segments; ++g) {
    if (g <= last)
      for (std::size_t v = 0; v < N; ++v)
        if (rows.start_of(vector + v) == g) {
          previous[v] = hn::LoadU(d, rows.seed(vector + v));
          current[v] = hn::LoadU(d, rows.seed(vector + v) + pairs);
        }
    const double *a = rows.a + g * segment, *b = rows.b + g * segment, *factor = q + g * segment * sums;
    for (std::size_t k = 0; k < segment; k += 2, factor += 2 * sums) {
      for (std::size_t u = 0; u < sums; ++u) {
        const V w = hn::Set(d, factor[u]);
        for (std::size_t v = 0; v < N; ++v) sum[u][v] = hn::MulAdd(current[v], w, sum[u][v]);
      }
      const V a0 = hn::Set(d, a[k]), b0 = hn::Set(d, b[k]);
      for (std::size_t v = 0; v < N; ++v) previous[v] = hn::MulAdd(hn::MulAdd(a0, t[v], b0), current[v], previous[v]);
      for (std::size_t u = 0; u < sums; ++u) {
        const V w = hn::Set(d, factor[sums + u]);
        for (std::size_t v = 0; v < N; ++v) sum[u][v] = hn::MulAdd(previous[v], w, sum[u][v]);
      }
      const V a1 = hn::Set(d, a[k + 1]), b1 = hn::Set(d, b[k + 1]);
      for (std::size_t v = 0; v < N; ++v) current[v] = hn::MulAdd(hn::MulAdd(a1, t[v], b1), previous[v], current[v]);
    }
  }
  for (std::size_t v = 0; v < N; ++v) {
    const V x = hn::LoadU(d, rows.x + (vector + v) * lanes);
    const std::size_t block = (vector + v) / parts, part = (vector + v) % parts;
    for (std::size_t f = 0; f < std::size_t(Fields); ++f) {
      double* to = cells + (f * rows.blocks + block) * cell + part * lanes;
      hn::Store(sum[4 * f][v], d, to);
      hn::Store(sum[4 * f + 1][v], d, to + pairs);
      hn::Store(hn::Mul(sum[4 * f + 2][v], x), d, to + 2 * pairs);
      hn::Store(hn::Mul(sum[4 * f + 3][v], x), d, to + 3 * pairs);
    }
  }
}

template <int Fields>
void synthesise(const Rows& rows, std::size_t first, std::size_t end, const double* q, double* cells) {
  constexpr std::size_t together = synthesis_vectors(Fields);
  const std::size_t rest = (end - first) % together;
  for_rest<together>(first, rest, [&](auto n, std::size_t vector) HWY_ATTR {
    synthesise_vectors<Fields, decltype(n)::value>(rows, vector, q, cells);
  });
  for (std::size_t vector = first + rest; vector < end; vector += together)
    synthesise_vectors<Fields, together>(rows, vector, q, cells);
}

// Adds the segments [begin, end) of N vectors to sums[k - 8 begin][4], each a vector; the first ones are not added to
// anything.
template <std::size_t N, bool First>
HWY_INLINE void analyse_vectors(const Rows& rows, std::size_t vector, std::uint32_t begin, std::uint32_t end,
                                const double* cells, double* state, double* sums) {
  const std::uint32_t first = std::max(begin, rows.start_of(vector + N - 1)), last = rows.start_of(vector);
  if (first >= end) return;
  V previous[N], current[N], f[4][N];
  HWY_ALIGN double t[N * lanes];
  for (std::size_t v = 0; v < N; ++v) {
    const bool started = rows.start_of(vector + v) < begin;
    double* from = state + (vector + v) * 2 * lanes;
    previous[v] = started ? hn::Load(d, from) : hn::Zero(d);
    current[v] = started ? hn::Load(d, from + lanes) : hn::Zero(d);
    hn::Store(hn::LoadU(d, rows.t + (vector + v) * lanes), d, t + v * lanes);
    const double* values = cells + (vector + v) / parts * cell + (vector + v) % parts * lanes;
    for (std::size_t u = 0; u < 4; ++u) f[u][v] = hn::Load(d, values + u * pairs);
  }
  for (std::uint32_t g = first; g < end; ++g) {
    if (g <= last)
      for (std::size_t v = 0; v < N; ++v)
        if (rows.start_of(vector + v) == g) {
          previous[v] = hn::LoadU(d, rows.seed(vector + v));
          current[v] = hn::LoadU(d, rows.seed(vector + v) + pairs);
        }
    const double *a = rows.a + g * segment, *b = rows.b + g * segment;
    double* sum = sums + (g - begin) * segment * 4 * lanes;
    for (std::size_t k = 0; k < segment; k += 2, sum += 8 * lanes) {
      for (std::size_t u = 0; u < 4; ++u) {
        V s = First ? hn::Mul(current[0], f[u][0]) : hn::MulAdd(current[0], f[u][0], hn::Load(d, sum + u * lanes));
        for (std::size_t v = 1; v < N; ++v) s = hn::MulAdd(current[v], f[u][v], s);
        hn::Store(s, d, sum + u * lanes);
      }
      const V a0 = hn::Set(d, a[k]), b0 = hn::Set(d, b[k]);
      for (std::size_t v = 0; v < N; ++v)
        previous[v] = hn::MulAdd(hn::MulAdd(a0, hn::Load(d, t + v * lanes), b0), current[v], previous[v]);
      for (std::size_t u = 0; u < 4; ++u) {
        V s = First ? hn::Mul(previous[0], f[u][0])
                    : hn::MulAdd(previous[0], f[u][0], hn::Load(d, sum + (4 + u) * lanes));
        for (std::size_t v = 1; v < N; ++v) s = hn::MulAdd(previous[v], f[u][v], s);
        hn::Store(s, d, sum + (4 + u) * lanes);
      }
      const V a1 = hn::Set(d, a[k + 1]), b1 = hn::Set(d, b[k + 1]);
      for (std::size_t v = 0; v < N; ++v)
        current[v] = hn::MulAdd(hn::MulAdd(a1, hn::Load(d, t + v * lanes), b1), previous[v], current[v]);
    }
  }
  for (std::size_t v = 0; v < N; ++v) {
    hn::Store(previous[v], d, state + (vector + v) * 2 * lanes);
    hn::Store(current[v], d, state + ((vector + v) * 2 + 1) * lanes);
  }
}

// Sums of one field for the segments [begin, end) over the vectors [first, last), from the equator to the poles: the
// first group has the earliest start, and what it leaves untouched has no sum.
void analyse_one(const Rows& rows, std::size_t first, std::size_t last, std::uint32_t begin, std::uint32_t end,
                 const double* cells, double* state, double* sums, bool& fresh) {
  constexpr std::size_t together = analysis_vectors;
  const auto run = [&](auto n, std::size_t vector) HWY_ATTR {
    if (fresh)
      analyse_vectors<decltype(n)::value, true>(rows, vector, begin, end, cells, state, sums);
    else
      analyse_vectors<decltype(n)::value, false>(rows, vector, begin, end, cells, state, sums);
    fresh = false;
  };
  const std::size_t rest = (last - first) % together;
  for (std::size_t vector = last; vector >= first + together; vector -= together)
    run(std::integral_constant<std::size_t, together>(), vector - together);
  for_rest<together>(first, rest, run);
}

// One segment of N vectors: lambda to panel[k][vector], whose rows are panel_vectors long.
template <std::size_t N>
HWY_INLINE void fill_panel(const Rows& rows, std::size_t vector, std::uint32_t g, double* state, double* panel) {
  V previous[N], current[N], t[N];
  for (std::size_t v = 0; v < N; ++v) {
    const std::uint32_t start = rows.start_of(vector + v);
    double* from = state + v * 2 * lanes;
    const double* seed = rows.seed(vector + v);
    previous[v] = start < g ? hn::Load(d, from) : start == g ? hn::LoadU(d, seed) : hn::Zero(d);
    current[v] = start < g ? hn::Load(d, from + lanes) : start == g ? hn::LoadU(d, seed + pairs) : hn::Zero(d);
    t[v] = hn::LoadU(d, rows.t + (vector + v) * lanes);
  }
  const double *a = rows.a + g * segment, *b = rows.b + g * segment;
  constexpr std::size_t row = panel_vectors * lanes;
  for (std::size_t k = 0; k < segment; k += 2, panel += 2 * row) {
    const V a0 = hn::Set(d, a[k]), b0 = hn::Set(d, b[k]);
    for (std::size_t v = 0; v < N; ++v) {
      hn::Store(current[v], d, panel + v * lanes);
      previous[v] = hn::MulAdd(hn::MulAdd(a0, t[v], b0), current[v], previous[v]);
    }
    const V a1 = hn::Set(d, a[k + 1]), b1 = hn::Set(d, b[k + 1]);
    for (std::size_t v = 0; v < N; ++v) {
      hn::Store(previous[v], d, panel + row + v * lanes);
      current[v] = hn::MulAdd(hn::MulAdd(a1, t[v], b1), previous[v], current[v]);
    }
  }
  for (std::size_t v = 0; v < N; ++v) {
    hn::Store(previous[v], d, state + v * 2 * lanes);
    hn::Store(current[v], d, state + (v * 2 + 1) * lanes);
  }
}

// Tile of the product of panel and values: `Steps` steps by `Columns` of the 4 * fields columns, from `column` on.
template <int Fields>
struct Tile {
  static constexpr std::size_t columns = Fields == 3 && many_registers ? 6 : 4;
  static constexpr std::size_t steps = many_registers ? 4 : 2;
  static constexpr std::size_t count = 4 * std::size_t(Fields) / columns; // that cover all columns
};

// sums[tile][k][column in the tile] += panel times values, for the vectors [first, end) of the panel that begins at
// vector `origin`.
template <int Fields, std::size_t Number>
HWY_INLINE void multiply(std::size_t origin, std::size_t first, std::size_t end, const double* panel,
                         const double* cells, std::size_t field_stride, double* sums) {
  using T = Tile<Fields>;
  constexpr std::size_t row = panel_vectors * lanes;
  for (std::size_t k = 0; k < segment; k += T::steps) {
    V sum[T::steps * T::columns];
    for (auto& s : sum) s = hn::Zero(d);
    const double* lambda = panel + k * row + (first - origin) * lanes;
    for (std::size_t vector = first; vector < end; ++vector, lambda += lanes) {
      const double* values = cells + vector / parts * cell + vector % parts * lanes;
      V l[T::steps];
      for (std::size_t j = 0; j < T::steps; ++j) l[j] = hn::Load(d, lambda + j * row);
      for (std::size_t c = 0; c < T::columns; ++c) {
        const std::size_t column = Number * T::columns + c;
        const V f = hn::Load(d, values + column / 4 * field_stride + column % 4 * pairs);
        for (std::size_t j = 0; j < T::steps; ++j)
          sum[j * T::columns + c] = hn::MulAdd(l[j], f, sum[j * T::columns + c]);
      }
    }
    for (std::size_t i = 0; i < T::steps * T::columns; i += 8) add_lane_sums(sum + i, sums + k * T::columns + i);
  }
}

template <int Fields>
void analyse_panels(const Rows& rows, std::size_t begin, std::size_t end, const double* cells, double* chunk,
                    double* sums, std::size_t tile_stride) {
  double *panel = chunk, *state = chunk + segment * panel_vectors * lanes;
  const std::size_t field_stride = rows.blocks * cell;
  for (std::size_t origin = begin; origin < end; origin += panel_vectors) {
    const std::size_t stop = std::min(end, origin + panel_vectors);
    std::size_t first = stop; // vectors from here on have started
    for (std::uint32_t g = rows.start_of(stop - 1); g < rows.segments; ++g) {
      while (first > origin && rows.start_of(first - 1) <= g) --first;
      std::size_t vector = first;
      const auto fill = [&](auto n) HWY_ATTR {
        fill_panel<decltype(n)::value>(rows, vector, g, state + (vector - origin) * 2 * lanes,
                                       panel + (vector - origin) * lanes);
        vector += decltype(n)::value;
      };
      while (vector + recurrence_vectors <= stop) fill(std::integral_constant<std::size_t, recurrence_vectors>());
      if (vector + 4 <= stop) fill(std::integral_constant<std::size_t, 4>());
      if (vector + 2 <= stop) fill(std::integral_constant<std::size_t, 2>());
      if (vector < stop) fill(std::integral_constant<std::size_t, 1>());
      double* to = sums + g * segment * Tile<Fields>::columns;
      multiply<Fields, 0>(origin, first, stop, panel, cells, field_stride, to);
      if constexpr (Tile<Fields>::count > 1)
        multiply<Fields, 1>(origin, first, stop, panel, cells, field_stride, to + tile_stride);
      if constexpr (Tile<Fields>::count > 2)
        multiply<Fields, 2>(origin, first, stop, panel, cells, field_stride, to + 2 * tile_stride);
    }
  }
}

Rows rows_of(const plan::Legendre& plan, const plan::Seeds& seeds, int m, bool polar) {
  const std::size_t order = std::size_t(m), blocks = std::size_t(plan.blocks), at = plan.offset[order];
  return {&plan.a[at],
          polar ? &plan.b_polar[at] : &plan.b[at],
          plan.t.data(),
          plan.x.data(),
          &seeds.start[order * blocks],
          &seeds.values[order * blocks * 2 * pairs],
          blocks,
          std::uint32_t(plan.padded_steps(m) / int(segment))};
}

// Calls body(rows, first vector, end) for the polar blocks and for the others.
template <class Body>
HWY_INLINE void for_both_forms(const plan::Legendre& plan, const plan::Seeds& seeds, int m, const Body& body) {
  const std::size_t polar = std::size_t(plan.polar_blocks) * parts, end = std::size_t(plan.blocks) * parts;
  body(rows_of(plan, seeds, m, false), polar, end);
  body(rows_of(plan, seeds, m, true), 0, polar);
}

void Synthesise(const plan::Legendre& plan, const plan::Seeds& seeds, int m, int fields, const double* q,
                double* cells) {
  for_both_forms(plan, seeds, m, [&](const Rows& rows, std::size_t first, std::size_t end) HWY_ATTR {
    if (fields == 1)
      synthesise<1>(rows, first, end, q, cells);
    else if (fields == 2)
      synthesise<2>(rows, first, end, q, cells);
    else
      synthesise<3>(rows, first, end, q, cells);
  });
}

void AnalyseOne(const plan::Legendre& plan, const plan::Seeds& seeds, int m, const double* cells, LegendreWork& work) {
  const auto segments = std::uint32_t(plan.padded_steps(m) / int(segment));
  constexpr auto chunk_segments = std::uint32_t(chunk_steps / segment);
  const std::size_t blocks = std::size_t(plan.blocks);
  const std::uint32_t start = std::min(segments, seeds.start[(std::size_t(m) + 1) * blocks - 1]); // the equator's
  double *chunk = work.chunk.get(), *sums = work.sums.get();
  std::memset(sums, 0, start * segment * 4 * sizeof(double));
  for (std::uint32_t begin = start; begin < segments; begin += chunk_segments) {
    const std::uint32_t end = std::min(segments, begin + chunk_segments);
    bool fresh = true;
    for_both_forms(plan, seeds, m, [&](const Rows& rows, std::size_t first, std::size_t last) HWY_ATTR {
      analyse_one(rows, first, last, begin, end, cells, work.state.get(), chunk, fresh);
    });
    double* to = sums + begin * segment * 4;
    for (std::size_t i = 0; i < (end - begin) * segment * 4; i += 8) {
      V sum[8];
      for (std::size_t j = 0; j < 8; ++j) sum[j] = hn::Load(d, chunk + (i + j) * lanes);
      store_lane_sums(sum, to + i);
    }
  }
}

// Leaves sums [tile][k][column of the tile] and returns the columns of a tile.
template <int Fields>
std::size_t analyse_several(const plan::Legendre& plan, const plan::Seeds& seeds, int m, const double* cells,
                            LegendreWork& work) {
  constexpr std::size_t columns = Tile<Fields>::columns;
  std::fill_n(work.sums.get(), std::size_t(plan.padded_steps(m)) * 4 * Fields, 0.0);
  for_both_forms(plan, seeds, m, [&](const Rows& rows, std::size_t first, std::size_t end) HWY_ATTR {
    analyse_panels<Fields>(rows, first, end, cells, work.chunk.get(), work.sums.get(),
                           std::size_t(plan.padded_steps(m)) * columns);
  });
  return columns;
}

std::size_t AnalyseSeveral(const plan::Legendre& plan, const plan::Seeds& seeds, int m, int fields, const double* cells,
                           LegendreWork& work) {
  return fields == 2 ? analyse_several<2>(plan, seeds, m, cells, work)
                     : analyse_several<3>(plan, seeds, m, cells, work);
}

} // namespace cowgpu::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cowgpu::cpu {

HWY_EXPORT(Synthesise);
HWY_EXPORT(AnalyseOne);
HWY_EXPORT(AnalyseSeveral);

namespace {

// Doubles of LegendreWork's arrays.
std::size_t sums_doubles(const plan::Legendre& plan) {
  return std::size_t(plan.padded_steps(0)) * 4 * (most_fields_together + 1);
}
std::size_t state_doubles(const plan::Legendre& plan) {
  return std::size_t(plan.blocks) * 2 * plan::block_pairs;
}
constexpr std::size_t chunk_doubles = 3200; // a panel of 40 blocks with its state; 3072 for sums

} // namespace

LegendreWork::LegendreWork(const plan::Legendre& plan)
    : sums(hwy::AllocateAligned<double>(sums_doubles(plan))), state(hwy::AllocateAligned<double>(state_doubles(plan))),
      chunk(hwy::AllocateAligned<double>(chunk_doubles)) {
  if (!sums || !state || !chunk) throw std::bad_alloc();
}

std::size_t LegendreWork::bytes(const plan::Legendre& plan) {
  return (sums_doubles(plan) + state_doubles(plan) + chunk_doubles) * sizeof(double);
}

void legendre_synthesis(const plan::Legendre& plan, const plan::Seeds& seeds, int m, int fields,
                        const std::complex<double>* coefficients, std::size_t stride, LegendreWork& work,
                        double* cells) {
  const std::size_t count = std::size_t(plan.lmax - m) + 1;
  for (std::size_t f = 0; f < std::size_t(fields); ++f)
    plan::prepare_synthesis(plan, m, {coefficients + f * stride, count}, work.sums.get() + 4 * f,
                            4 * std::size_t(fields));
  HWY_DYNAMIC_DISPATCH(Synthesise)(plan, seeds, m, fields, work.sums.get(), cells);
}

void legendre_analysis(const plan::Legendre& plan, const plan::Seeds& seeds, int m, int fields, const double* cells,
                       LegendreWork& work, std::complex<double>* coefficients, std::size_t stride) {
  const std::size_t count = std::size_t(plan.lmax - m) + 1, steps = std::size_t(plan.padded_steps(m));
  double* sums = work.sums.get();
  std::size_t columns = 4; // columns of a tile
  if (fields == 1)
    HWY_DYNAMIC_DISPATCH(AnalyseOne)(plan, seeds, m, cells, work);
  else
    columns = HWY_DYNAMIC_DISPATCH(AnalyseSeveral)(plan, seeds, m, fields, cells, work);
  for (std::size_t f = 0; f < std::size_t(fields); ++f) {
    const std::size_t first = 4 * f / columns, last = (4 * f + 3) / columns; // tiles of the field's even and odd parts
    const double *even = sums + first * steps * columns + 4 * f % columns,
                 *odd = sums + last * steps * columns + (4 * f + 2) % columns;
    std::size_t distance = columns;
    if (first != last) { // a field in two tiles is put together behind them
      double* both = sums + steps * 4 * std::size_t(fields);
      for (std::size_t k = 0; k < steps; ++k) {
        std::copy_n(even + k * columns, 2, both + 4 * k);
        std::copy_n(odd + k * columns, 2, both + 4 * k + 2);
      }
      even = both;
      distance = 4;
    }
    plan::finish_analysis(plan, m, even, distance, {coefficients + f * stride, count});
  }
}

} // namespace cowgpu::cpu
#endif // HWY_ONCE

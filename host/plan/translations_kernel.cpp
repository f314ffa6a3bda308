// Lanes are the densities of several pairs, side by side: four vectors of them, which a row of a constant matrix multiplies at
// once.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/plan/translations_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/plan/translations_kernel.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::plan::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>; // at most twice the densities
using V = hn::Vec<D>;
constexpr D d;
constexpr std::size_t lanes = hn::MaxLanes(d);
using Part = hn::CappedTag<double, densities>; // of one pair
constexpr Part part;
constexpr std::size_t vectors = 4, batch = vectors * lanes / densities, width = vectors * lanes;
static_assert(width <= translation_width);

// Rows of a block whose sums stay in registers.
constexpr int rows_at_once = lanes == 8 ? 6 : 3;

HWY_INLINE V load(const double* from, std::size_t v) {
  return hn::Load(d, from + v * lanes);
}
HWY_INLINE void store(V value, double* to, std::size_t v) {
  hn::Store(value, d, to + v * lanes);
}

template <int Rows>
HWY_INLINE void multiply_rows(const double* matrix, std::size_t count, std::size_t columns, const double* in,
                              std::size_t stride, const std::uint16_t* rows, double* out) {
  V sums[Rows][vectors];
  for (auto& row : sums)
    for (V& sum : row) sum = hn::Zero(d);
  for (std::size_t c = 0; c < columns; ++c, matrix += count, in += stride) {
    V x[vectors];
    for (std::size_t v = 0; v < vectors; ++v) x[v] = load(in, v);
    for (int r = 0; r < Rows; ++r) {
      const V factor = hn::Set(d, matrix[r]);
      for (std::size_t v = 0; v < vectors; ++v) sums[r][v] = hn::MulAdd(factor, x[v], sums[r][v]);
    }
  }
  for (int r = 0; r < Rows; ++r)
    for (std::size_t v = 0; v < vectors; ++v) store(sums[r][v], out + width * rows[r], v);
}

void multiply(const Translations::Block& block, const double* matrix, const double* in, double* out) {
  const double* entries = matrix + block.matrix;
  const double* x = in + width * block.first;
  const std::size_t stride = width * block.stride;
  for (int row = 0; row < block.count; row += rows_at_once) {
    const int left = std::min(block.count - row, rows_at_once);
    const std::uint16_t* rows = block.rows.data() + row;
    const double* from = entries + row;
    switch (left) {
    case 1: multiply_rows<1>(from, block.count, block.columns, x, stride, rows, out); break;
    case 2: multiply_rows<2>(from, block.count, block.columns, x, stride, rows, out); break;
    case 3: multiply_rows<3>(from, block.count, block.columns, x, stride, rows, out); break;
    case 4: multiply_rows<std::min(4, rows_at_once)>(from, block.count, block.columns, x, stride, rows, out); break;
    case 5: multiply_rows<std::min(5, rows_at_once)>(from, block.count, block.columns, x, stride, rows, out); break;
    default: multiply_rows<rows_at_once>(from, block.count, block.columns, x, stride, rows, out);
    }
  }
}

// The densities of a vector's pairs at `offset`, and adding to them.
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
HWY_INLINE V gather(const double* const* from, std::size_t v, std::size_t offset) {
  return hn::Combine(d, hn::LoadU(part, from[2 * v + 1] + offset), hn::LoadU(part, from[2 * v] + offset));
}
HWY_INLINE void scatter(V value, double* const* to, std::size_t pairs, std::size_t v, std::size_t offset) {
  // Half by half: both pairs may have one target.
  if (2 * v < pairs) {
    double* at = to[2 * v] + offset;
    hn::StoreU(hn::Add(hn::LoadU(part, at), hn::LowerHalf(value)), part, at);
  }
  if (2 * v + 1 < pairs) {
    double* at = to[2 * v + 1] + offset;
    hn::StoreU(hn::Add(hn::LoadU(part, at), hn::UpperHalf(part, value)), part, at);
  }
}
#else
static_assert(lanes <= densities);
HWY_INLINE V gather(const double* const* from, std::size_t v, std::size_t offset) {
  return hn::LoadU(d, from[v * lanes / densities] + offset + v * lanes % densities);
}
HWY_INLINE void scatter(V value, double* const* to, std::size_t pairs, std::size_t v, std::size_t offset) {
  if (v * lanes / densities >= pairs) return;
  double* at = to[v * lanes / densities] + offset + v * lanes % densities;
  hn::StoreU(hn::Add(hn::LoadU(d, at), value), d, at);
}
#endif

// cos(m angle), sin(m angle) of both turns, and what coefficients of degree m are multiplied with at the beginning and the end.
struct Powers {
  double *cos_turn, *sin_turn, *cos_tilt, *sin_tilt, *before, *after;
};

HWY_INLINE void fill_powers(Translation kind, int order, const TranslationPair* pairs, std::size_t count,
                            const Powers& to) {
  HWY_ALIGN double turn_x[width], turn_y[width], tilt_x[width], tilt_y[width], length[width];
  for (std::size_t i = 0; i < batch; ++i) {
    const Vec3 shift = i < count ? pairs[i].shift : Vec3(0, 0, 1);
    const double across = std::sqrt(shift[0] * shift[0] + shift[1] * shift[1]);
    const double far = std::sqrt(across * across + shift[2] * shift[2]);
    const bool turned = across > 1e-30 * far;
    for (std::size_t k = densities * i; k < densities * (i + 1); ++k) {
      turn_x[k] = turned ? shift[1] / across : 1;
      turn_y[k] = turned ? -shift[0] / across : 0;
      tilt_x[k] = shift[2] / far;
      tilt_y[k] = turned ? across / far : 0;
      length[k] = far;
    }
  }
  for (std::size_t v = 0; v < vectors; ++v) {
    const V one = hn::Set(d, 1), ax = load(turn_x, v), ay = load(turn_y, v), bx = load(tilt_x, v), by = load(tilt_y, v);
    const V far = load(length, v), inverse = hn::Div(one, far);
    // Multipoles come in r^-l and go out in r^j; locals come in r^l and go out in r^-j, one more power of r below for those
    // that were multipoles.
    const V step_before = kind == Translation::local_to_local ? far : inverse;
    const V step_after = kind == Translation::multipole_to_multipole ? far : inverse;
    V cx = one, cy = hn::Zero(d), ex = one, ey = hn::Zero(d), before = one;
    V after = kind == Translation::multipole_to_local ? inverse : one;
    for (int m = 0; m <= order; ++m) {
      const std::size_t at = width * std::size_t(m);
      store(cx, to.cos_turn + at, v);
      store(cy, to.sin_turn + at, v);
      store(ex, to.cos_tilt + at, v);
      store(ey, to.sin_tilt + at, v);
      store(before, to.before + at, v);
      store(after, to.after + at, v);
      const V next_cx = hn::NegMulAdd(cy, ay, hn::Mul(cx, ax)), next_ex = hn::NegMulAdd(ey, by, hn::Mul(ex, bx));
      cy = hn::MulAdd(cx, ay, hn::Mul(cy, ax));
      ey = hn::MulAdd(ex, by, hn::Mul(ey, bx));
      cx = next_cx;
      ex = next_ex;
      before = hn::Mul(before, step_before);
      after = hn::Mul(after, step_after);
    }
  }
}

// Harmonics of degree l in coordinates turned by the angle of cos_m, sin_m (or back), in place.
template <bool Back>
HWY_INLINE void turn(int l, const double* cos_m, const double* sin_m, double* x) {
  for (int m = 1; m <= l; ++m)
    for (std::size_t v = 0; v < vectors; ++v) {
      double *cosine = x + width * std::size_t(m), *sine = x + width * std::size_t(l + m);
      const V c = load(cosine, v), s = load(sine, v);
      const V co = load(cos_m + width * std::size_t(m), v), si = load(sin_m + width * std::size_t(m), v);
      store(Back ? hn::NegMulAdd(s, si, hn::Mul(c, co)) : hn::MulAdd(s, si, hn::Mul(c, co)), cosine, v);
      store(Back ? hn::MulAdd(c, si, hn::Mul(s, co)) : hn::NegMulAdd(c, si, hn::Mul(s, co)), sine, v);
    }
}

void translate_batch(const Translations& translations, Translation kind, int order, const TranslationPair* pairs,
                     std::size_t count, double* room) {
  static constexpr double nothing[densities * (largest_expansion_order + 1) * (largest_expansion_order + 1)] = {};
  const double* from[batch];
  double* to[batch];
  for (std::size_t i = 0; i < batch; ++i) {
    from[i] = i < count ? pairs[i].from : nothing;
    to[i] = i < count ? pairs[i].to : nullptr;
  }
  const std::size_t degrees = std::size_t(order + 1);
  const auto take = [&room](std::size_t harmonic_count) {
    double* const taken = room;
    room += width * harmonic_count;
    return taken;
  };
  const std::size_t all = harmonics(translations.order());
  double *const upright = take(all), *const shifted = take(all);
  double *const a = take(2 * degrees), *const b = take(2 * degrees);
  const Powers powers = {take(degrees), take(degrees), take(degrees), take(degrees), take(degrees), take(degrees)};
  fill_powers(kind, order, pairs, count, powers);

  const double* const exchange = translations.exchange_matrix();
  for (int l = 0; l <= order; ++l) {
    const Translations::Exchange& blocks = translations.exchanges()[std::size_t(l)];
    const std::size_t first = densities * std::size_t(l * l);
    for (std::size_t v = 0; v < vectors; ++v) {
      const V before = load(powers.before + width * std::size_t(l), v);
      store(hn::Mul(before, gather(from, v, first)), a, v);
      for (int m = 1; m <= l; ++m) {
        const V c = hn::Mul(before, gather(from, v, first + densities * std::size_t(m)));
        const V s = hn::Mul(before, gather(from, v, first + densities * std::size_t(l + m)));
        const V co = load(powers.cos_turn + width * std::size_t(m), v);
        const V si = load(powers.sin_turn + width * std::size_t(m), v);
        store(hn::MulAdd(s, si, hn::Mul(c, co)), a + width * std::size_t(m), v);
        store(hn::NegMulAdd(c, si, hn::Mul(s, co)), a + width * std::size_t(l + m), v);
      }
    }
    for (const auto& block : blocks.flat) multiply(block, exchange, a, b);
    turn<false>(l, powers.cos_tilt, powers.sin_tilt, b);
    for (const auto& block : blocks.upright) multiply(block, exchange, b, upright);
  }
  const Translations::Shift& shift = translations.shift(kind, order);
  for (const auto& block : shift.blocks) multiply(block, shift.matrix.data(), upright, shifted);
  for (int l = 0; l <= order; ++l) {
    const Translations::Exchange& blocks = translations.exchanges()[std::size_t(l)];
    const std::size_t first = densities * std::size_t(l * l);
    for (const auto& block : blocks.flat) multiply(block, exchange, shifted + width * std::size_t(l * l), a);
    turn<true>(l, powers.cos_tilt, powers.sin_tilt, a);
    for (const auto& block : blocks.flat) multiply(block, exchange, a, b);
    for (std::size_t v = 0; v < vectors; ++v) {
      const V after = load(powers.after + width * std::size_t(l), v);
      scatter(hn::Mul(after, load(b, v)), to, count, v, first);
      for (int m = 1; m <= l; ++m) {
        const V c = load(b + width * std::size_t(m), v), s = load(b + width * std::size_t(l + m), v);
        const V co = hn::Mul(after, load(powers.cos_turn + width * std::size_t(m), v));
        const V si = hn::Mul(after, load(powers.sin_turn + width * std::size_t(m), v));
        scatter(hn::NegMulAdd(s, si, hn::Mul(c, co)), to, count, v, first + densities * std::size_t(m));
        scatter(hn::MulAdd(c, si, hn::Mul(s, co)), to, count, v, first + densities * std::size_t(l + m));
      }
    }
  }
}

void Translate(const Translations& translations, Translation kind, int order, const TranslationPair* pairs,
               std::size_t count, double* room) {
  for (std::size_t i = 0; i < count; i += batch)
    translate_batch(translations, kind, order, pairs + i, std::min(batch, count - i), room);
}

} // namespace cowgpu::plan::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cowgpu::plan {
HWY_EXPORT(Translate);

void translate(const Translations& translations, Translation kind, int order, std::span<const TranslationPair> pairs,
               double* room) {
  HWY_DYNAMIC_DISPATCH(Translate)(translations, kind, order, pairs.data(), pairs.size(), room);
}
} // namespace cowgpu::plan
#endif

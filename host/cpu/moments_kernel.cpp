// Lanes are pairs of triangles. A sweep runs once over the orders m and advances every row by four degrees: level j
// works one column behind level j-1, so that a row's values are loaded and stored once per sweep and pass from level to
// level in registers. A column's eight sums (four degrees, real and imaginary) are added over the lanes together.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/cpu/moments_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/cpu/lanes-inl.hpp"
#include "host/cpu/moments_kernel.hpp"

#include <hwy/highway.h>

#include <cmath>
#include <cstring>
#include <new>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::cpu::HWY_NAMESPACE {

constexpr int levels = degrees_per_sweep;
static_assert(levels == 4, "the kernel spells out four levels");

// One column of the rows: v of both outer vertices (moduli), e, t.
struct Column {
  V vc, vd, er, ei, tr, ti;
};
constexpr std::size_t column_doubles = 6 * lanes;

HWY_INLINE Column load_column(const double* p) {
  return {hn::Load(d, p),
          hn::Load(d, p + lanes),
          hn::Load(d, p + 2 * lanes),
          hn::Load(d, p + 3 * lanes),
          hn::Load(d, p + 4 * lanes),
          hn::Load(d, p + 5 * lanes)};
}

HWY_INLINE void store_column(const Column& c, double* p) {
  hn::Store(c.vc, d, p);
  hn::Store(c.vd, d, p + lanes);
  hn::Store(c.er, d, p + 2 * lanes);
  hn::Store(c.ei, d, p + 3 * lanes);
  hn::Store(c.tr, d, p + 4 * lanes);
  hn::Store(c.ti, d, p + 5 * lanes);
}

// Directions of a group: x and y over twice the column scale, z. Of the outer vertices only modulus and height.
struct Directions {
  V ax, ay, az, bx, by, bz, c_rho, c_z, d_rho, d_z;
};

// det exp(i m phi) of both outer vertices.
struct Phase {
  V c_cos, c_sin, d_cos, d_sin;
};

// (direction . D) at one column: z same + (x - iy) above - (x + iy) below, x and y over two. `below` comes multiplied by
// the square of the column scale. The newest operand, `add`, is added last.
HWY_INLINE V combine_re(V x, V y, V z, V same, V above_re, V above_im, V below_re, V below_im) {
  return hn::MulAdd(y, hn::Add(above_im, below_im), hn::MulAdd(x, hn::Sub(above_re, below_re), hn::Mul(z, same)));
}
HWY_INLINE V combine_im(V x, V y, V z, V same, V above_re, V above_im, V below_re, V below_im) {
  return hn::NegMulAdd(y, hn::Add(above_re, below_re), hn::MulAdd(x, hn::Sub(above_im, below_im), hn::Mul(z, same)));
}

template <bool Scaled>
HWY_INLINE V scaled(V below) {
  if constexpr (Scaled) return hn::Mul(below, hn::Set(d, 4.0));
  return below;
}

// One level at one column: from three columns of degree l-1 to one of degree l.
template <bool Scaled>
HWY_INLINE Column advance(const Directions& g, const Phase& f, const Column& below, const Column& same,
                          const Column& above) {
  Column out;
  out.vc = hn::MulAdd(g.c_rho, hn::Sub(above.vc, scaled<Scaled>(below.vc)), hn::Mul(g.c_z, same.vc));
  out.vd = hn::MulAdd(g.d_rho, hn::Sub(above.vd, scaled<Scaled>(below.vd)), hn::Mul(g.d_z, same.vd));
  const V ber = scaled<Scaled>(below.er), bei = scaled<Scaled>(below.ei);
  out.er = hn::MulAdd(out.vd, f.d_cos,
                      hn::MulAdd(out.vc, f.c_cos, combine_re(g.bx, g.by, g.bz, same.er, above.er, above.ei, ber, bei)));
  out.ei = hn::MulAdd(out.vd, f.d_sin,
                      hn::MulAdd(out.vc, f.c_sin, combine_im(g.bx, g.by, g.bz, same.ei, above.er, above.ei, ber, bei)));
  const V btr = scaled<Scaled>(below.tr), bti = scaled<Scaled>(below.ti);
  out.tr = hn::Add(combine_re(g.ax, g.ay, g.az, same.tr, above.tr, above.ti, btr, bti), out.er);
  out.ti = hn::Add(combine_im(g.ax, g.ay, g.az, same.ti, above.tr, above.ti, btr, bti), out.ei);
  return out;
}

// Three columns of each level's input; the column c of a level sits in slot c mod 3.
struct Window {
  Column level[levels][3];
};

// Works on column `ix` of level 0, ix - j of level j. Phase is ix mod 3, so that every slot is a register.
template <bool Scaled, int Phase3>
HWY_INLINE void step(const Directions& g, Window& w, double* row, const double* phase, double* sums) {
  w.level[0][(Phase3 + 1) % 3] = load_column(row + column_doubles);
  V t[2 * levels];
  const auto at_level = [&](auto level) HWY_ATTR {
    constexpr int j = decltype(level)::value;
    constexpr int same = (Phase3 - j + 30) % 3, above = (same + 1) % 3, below = (same + 2) % 3;
    const double* f = phase - j * std::ptrdiff_t(4 * lanes);
    const Phase turn = {hn::Load(d, f), hn::Load(d, f + lanes), hn::Load(d, f + 2 * lanes), hn::Load(d, f + 3 * lanes)};
    const Column out = advance<Scaled>(g, turn, w.level[j][below], w.level[j][same], w.level[j][above]);
    t[2 * j] = out.tr;
    t[2 * j + 1] = out.ti;
    if constexpr (j + 1 < levels)
      w.level[j + 1][same] = out;
    else
      store_column(out, row - j * std::ptrdiff_t(column_doubles));
  };
  at_level(std::integral_constant<int, 0>{});
  at_level(std::integral_constant<int, 1>{});
  at_level(std::integral_constant<int, 2>{});
  at_level(std::integral_constant<int, 3>{});
  add_lane_sums(t, sums);
}

// Column -m is (-1)^m scale^-2m times the conjugate of column m; the outer rows are real.
void mirror(double* origin, double inverse_square) {
  double factor = 1;
  for (int m = 1; m <= levels; ++m) {
    factor *= -inverse_square;
    const V plus = hn::Set(d, factor), minus = hn::Set(d, -factor);
    const Column c = load_column(origin + m * std::ptrdiff_t(column_doubles));
    store_column({hn::Mul(c.vc, plus), hn::Mul(c.vd, plus), hn::Mul(c.er, plus), hn::Mul(c.ei, minus),
                  hn::Mul(c.tr, plus), hn::Mul(c.ti, minus)},
                 origin - m * std::ptrdiff_t(column_doubles));
  }
}

template <bool Scaled>
void sweeps(const Directions& g, int last, double* rows, const double* phases, double* sums,
            const PartialLayout& layout) {
  double* const origin = rows + 2 * levels * column_doubles; // column of m = 0
  const V zero = hn::Zero(d);
  const Column nothing = {zero, zero, zero, zero, zero, zero};
  for (int first = 1, n = 0; first <= last; first += levels, ++n) {
    Window w;
    for (auto& level : w.level) level[0] = level[1] = level[2] = nothing;
    // ix counts columns from m = -levels; level 0 starts at ix = 1, with its neighbours below and itself loaded.
    double* row = origin - levels * std::ptrdiff_t(column_doubles);
    w.level[0][0] = load_column(row);
    w.level[0][1] = load_column(row + column_doubles);
    row += column_doubles;
    const double* phase = phases + 4 * lanes * levels; // phases of ix = 1
    double* q = sums + layout.offset[std::size_t(n)] + 2 * levels;
    const int end = first + 3 * levels - 2;
    for (int ix = 1; ix <= end; ix += 3) {
      step<Scaled, 1>(g, w, row, phase, q);
      step<Scaled, 2>(g, w, row + column_doubles, phase + 4 * lanes, q + 2 * levels);
      step<Scaled, 0>(g, w, row + 2 * column_doubles, phase + 8 * lanes, q + 4 * levels);
      row += 3 * column_doubles;
      phase += 12 * lanes;
      q += 6 * levels;
    }
    mirror(origin, Scaled ? 0.25 : 1.0);
  }
}

void AccumulateGroup(const plan::Moments& plan, std::size_t group, const PartialLayout& layout,
                     MomentsWorkspace& workspace, double* partial) {
  const int last = plan.last_degree[group];
  HWY_ALIGN double in[plan::inputs][lanes];
  plan::lane_inputs(plan, group, in[0]);
  const auto input = [&](std::size_t k) HWY_ATTR { return hn::Load(d, in[k]); };
  const Directions g = {input(0), input(1), input(2), input(3), input(4),
                        input(5), input(6), input(7), input(8), input(9)};

  const std::size_t columns = std::size_t(last) + 6 * levels + 4;
  std::memset(workspace.rows.get(), 0, columns * column_doubles * sizeof(double));
  const V start = hn::Set(d, std::ldexp(1.0, plan.start_exponent)), zero = hn::Zero(d);
  const V det = hn::Mul(hn::Add(input(14), input(15)), start);
  store_column({start, start, det, zero, det, zero}, workspace.rows.get() + 2 * levels * column_doubles);

  // Phases for columns from m = -2 levels + 1 on. Orders below 0 feed scratch columns only beyond -levels.
  const V c_cos = input(10), c_sin = input(11), d_cos = input(12), d_sin = input(13);
  double* const phase_origin = workspace.phases.get() + 4 * lanes * (2 * levels - 1); // m = 0
  Phase f = {input(14), zero, input(15), zero};
  for (std::size_t m = 0; m < columns - 2 * levels; ++m) {
    double* p = phase_origin + 4 * lanes * m;
    hn::Store(f.c_cos, d, p);
    hn::Store(f.c_sin, d, p + lanes);
    hn::Store(f.d_cos, d, p + 2 * lanes);
    hn::Store(f.d_sin, d, p + 3 * lanes);
    f = {hn::NegMulAdd(f.c_sin, c_sin, hn::Mul(f.c_cos, c_cos)), hn::MulAdd(f.c_sin, c_cos, hn::Mul(f.c_cos, c_sin)),
         hn::NegMulAdd(f.d_sin, d_sin, hn::Mul(f.d_cos, d_cos)), hn::MulAdd(f.d_sin, d_cos, hn::Mul(f.d_cos, d_sin))};
  }
  for (std::size_t m = 1; m < 2 * levels; ++m) {
    const double* from = phase_origin + 4 * lanes * m;
    double* to = phase_origin - 4 * lanes * m;
    for (std::size_t k = 0; k < 4; ++k) {
      const V value = hn::Load(d, from + k * lanes);
      hn::Store(k % 2 == 0 ? value : hn::Neg(value), d, to + k * lanes);
    }
  }
  if (plan.column_scale == 1)
    sweeps<false>(g, last, workspace.rows.get(), workspace.phases.get(), partial, layout);
  else
    sweeps<true>(g, last, workspace.rows.get(), workspace.phases.get(), partial, layout);
}

int MomentsLanes() {
  return int(lanes);
}

std::string SimdName() {
  return hwy::TargetName(HWY_TARGET);
}

} // namespace cowgpu::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cowgpu::cpu {
namespace {

constexpr std::size_t widest = 8; // doubles in the widest vector

std::size_t columns(int lmax) {
  return std::size_t(lmax) + 10 * degrees_per_sweep;
}

} // namespace

HWY_EXPORT(AccumulateGroup);
HWY_EXPORT(MomentsLanes);
HWY_EXPORT(SimdName);

PartialLayout::PartialLayout(int lmax) : offset{0} {
  // A sweep is unrolled by three columns.
  for (int first = 1; first <= lmax; first += degrees_per_sweep)
    offset.push_back(offset.back() + 2 * degrees_per_sweep * std::size_t(first + 3 * degrees_per_sweep + 2));
}

MomentsWorkspace::MomentsWorkspace(int lmax) {
  rows = hwy::AllocateAligned<double>(columns(lmax) * 6 * widest);
  phases = hwy::AllocateAligned<double>(columns(lmax) * 4 * widest);
  if (!rows || !phases) throw std::bad_alloc();
}

std::size_t MomentsWorkspace::bytes(int lmax) {
  return columns(lmax) * 10 * widest * sizeof(double);
}

int moments_lanes() {
  return HWY_DYNAMIC_DISPATCH(MomentsLanes)();
}

std::string simd_name() {
  return HWY_DYNAMIC_DISPATCH(SimdName)();
}

void accumulate_group(const plan::Moments& plan, std::size_t group, const PartialLayout& layout,
                      MomentsWorkspace& workspace, double* partial) {
  HWY_DYNAMIC_DISPATCH(AccumulateGroup)(plan, group, layout, workspace, partial);
}

} // namespace cowgpu::cpu
#endif

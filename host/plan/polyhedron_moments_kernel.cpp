// With u_l = l! rho_l (host/plan/solid_harmonics.hpp), u_l(D) = (D.T) u_(l-1) for an operator D.T that is linear in D, and powers
// of it integrate over a triangle as powers of numbers do:
//   integral of u_l = 2 area/((l+1)(l+2)) sum over i + j + k = l of (A.T)^i (B.T)^j (C.T)^k,
// whose sums follow from v_l = (C.T) v, e_l = (B.T) e + v_l, t_l = (A.T) t + e_l.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/plan/polyhedron_moments_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/plan/polyhedron_moments_kernel.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::plan::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, face_group>;
using V = hn::Vec<D>;
constexpr D d;
constexpr std::size_t lanes = hn::MaxLanes(d), parts = face_group / lanes;

// Adds the sums over the lanes of a[0] ... a[3] to to[0] ... to[3].
HWY_INLINE void add_sums(const V* a, double factor, double* to) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  using Four = hn::CappedTag<double, 4>;
  constexpr Four four;
  hn::Vec<Four> b[4];
  for (int i = 0; i < 4; ++i) {
#if HWY_TARGET <= HWY_AVX3
    b[i] = hn::Add(hn::LowerHalf(a[i]), hn::UpperHalf(four, a[i]));
#else
    b[i] = a[i];
#endif
  }
  const auto p = hn::Add(hn::InterleaveLower(four, b[0], b[1]), hn::InterleaveUpper(four, b[0], b[1]));
  const auto q = hn::Add(hn::InterleaveLower(four, b[2], b[3]), hn::InterleaveUpper(four, b[2], b[3]));
  const auto sum = hn::Add(hn::ConcatLowerLower(four, q, p), hn::ConcatUpperUpper(four, q, p));
  hn::StoreU(hn::MulAdd(hn::Set(four, factor), sum, hn::LoadU(four, to)), four, to);
#else
  for (int i = 0; i < 4; ++i) to[i] += factor * hn::GetLane(hn::SumOfLanes(d, a[i]));
#endif
}

// Complex numbers, real and imaginary parts in turn, of orders m = 0 ... l + 1, those above l 0; each of `width` lanes.
struct Row {
  double* at;
  std::size_t width;
  double* re(int m) const { return at + 2 * std::size_t(m) * width; }
  double* im(int m) const { return re(m) + width; }
};

// to = (x.T) from + plus, of degree l from degree l - 1, in lanes from `lane` on.
template <bool Plus>
HWY_INLINE void step(int l, V x, V y, V z, const Row& from, const Row& to, const Row& plus, std::size_t lane) {
  const V half = hn::Set(d, 0.5), a = hn::Mul(x, half), b = hn::Mul(y, half);
  const auto load = [lane](const double* p) HWY_ATTR { return hn::Load(d, p + lane); };
  V low_re = load(from.re(0)), low_im = hn::Zero(d); // m - 1
  V re = load(from.re(1)), im = load(from.im(1));    // m
  V first = hn::NegMulAdd(y, im, hn::NegMulAdd(x, re, hn::Mul(z, low_re)));
  if (Plus) first = hn::Add(first, load(plus.re(0)));
  hn::Store(first, d, to.re(0) + lane);
  hn::Store(hn::Zero(d), d, to.im(0) + lane);
  for (int m = 1; m <= l; ++m) {
    const V high_re = load(from.re(m + 1)), high_im = load(from.im(m + 1));
    V next_re = hn::MulAdd(a, hn::Sub(low_re, high_re), hn::NegMulAdd(b, hn::Add(low_im, high_im), hn::Mul(z, re)));
    V next_im = hn::MulAdd(a, hn::Sub(low_im, high_im), hn::MulAdd(b, hn::Add(low_re, high_re), hn::Mul(z, im)));
    if (Plus) next_re = hn::Add(next_re, load(plus.re(m)));
    if (Plus) next_im = hn::Add(next_im, load(plus.im(m)));
    hn::Store(next_re, d, to.re(m) + lane);
    hn::Store(next_im, d, to.im(m) + lane);
    low_re = re;
    low_im = im;
    re = high_re;
    im = high_im;
  }
}

// The groups' integrals of degree l, from the row t.
HWY_INLINE void add_degree(const FaceGroup* groups, std::size_t count, int l, const Row& t, double scale,
                           double* moments) {
  const auto& norms = harmonic_factors().norm[std::size_t(l)];
  double* to = moments + 4 * std::size_t(l * l);
  for (int m = 0; m <= l; ++m) {
    V cosine[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    V sine[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (std::size_t g = 0; g < count; ++g)
      for (std::size_t part = 0; part < parts; ++part) {
        const std::size_t lane = g * face_group + part * lanes;
        const V re = hn::Load(d, t.re(m) + lane), im = hn::Load(d, t.im(m) + lane);
        for (int q = 0; q < 4; ++q) {
          const V weight = hn::Load(d, groups[g].weights[q] + part * lanes);
          cosine[q] = hn::MulAdd(weight, re, cosine[q]);
          sine[q] = hn::MulAdd(weight, im, sine[q]);
        }
      }
    const double factor = scale * norms[std::size_t(m)];
    add_sums(cosine, factor, to + 4 * m);
    if (m > 0) add_sums(sine, factor, to + 4 * (l + m));
  }
}

void add_some(const FaceGroup* groups, std::size_t count, const Vec3& centre, int order, double* room,
              double* moments) {
  const std::size_t width = moment_groups * face_group, row = 2 * std::size_t(order + 3) * width;
  std::fill(room, room + 6 * row, 0.0);
  Row now[3] = {{room, width}, {room + row, width}, {room + 2 * row, width}};
  Row next[3] = {{room + 3 * row, width}, {room + 4 * row, width}, {room + 5 * row, width}};
  for (const Row& one : now) std::fill(one.at, one.at + width, 1.0);
  const V cx = hn::Set(d, centre[0]), cy = hn::Set(d, centre[1]), cz = hn::Set(d, centre[2]);
  double factorial = 1;
  for (int l = 0;; ++l) {
    if (l > 0) factorial *= l;
    add_degree(groups, count, l, now[2], 1 / (factorial * (l + 1) * (l + 2)), moments);
    if (l == order) return;
    for (std::size_t g = 0; g < count; ++g)
      for (std::size_t part = 0; part < parts; ++part) {
        const FaceGroup& faces = groups[g];
        const std::size_t at = part * lanes, lane = g * face_group + at;
        const auto coordinate = [at](const double* from, V middle)
                                    HWY_ATTR { return hn::Sub(hn::Load(d, from + at), middle); };
        step<false>(l + 1, coordinate(faces.c[0], cx), coordinate(faces.c[1], cy), coordinate(faces.c[2], cz), now[0],
                    next[0], next[0], lane);
        step<true>(l + 1, coordinate(faces.b[0], cx), coordinate(faces.b[1], cy), coordinate(faces.b[2], cz), now[1],
                   next[1], next[0], lane);
        step<true>(l + 1, coordinate(faces.a[0], cx), coordinate(faces.a[1], cy), coordinate(faces.a[2], cz), now[2],
                   next[2], next[1], lane);
      }
    for (int i = 0; i < 3; ++i) std::swap(now[i], next[i]);
  }
}

void AddFaceMoments(const FaceGroup* groups, std::size_t count, const Vec3& centre, int order, double* room,
                    double* moments) {
  for (std::size_t g = 0; g < count; g += moment_groups)
    add_some(groups + g, std::min(moment_groups, count - g), centre, order, room, moments);
}

FaceReach Reach(const FaceGroup* groups, std::size_t count, const Vec3& centre, int power) {
  const V c[3] = {hn::Set(d, centre[0]), hn::Set(d, centre[1]), hn::Set(d, centre[2])};
  V farthest = hn::Zero(d), sum = hn::Zero(d);
  for (std::size_t g = 0; g < count; ++g)
    for (std::size_t at = 0; at < face_group; at += lanes) {
      const auto square = [&](const double(&corner)[3][face_group]) HWY_ATTR {
        V total = hn::Zero(d);
        for (int k = 0; k < 3; ++k) {
          const V x = hn::Sub(hn::Load(d, corner[k] + at), c[k]);
          total = hn::MulAdd(x, x, total);
        }
        return total;
      };
      const V area = hn::Load(d, groups[g].area + at);
      const V square2 = hn::Max(square(groups[g].a), hn::Max(square(groups[g].b), square(groups[g].c)));
      const V r2 = hn::IfThenElseZero(hn::Gt(area, hn::Zero(d)), square2);
      farthest = hn::Max(farthest, r2);
      V value = power % 2 != 0 ? hn::Mul(area, hn::Sqrt(r2)) : area, base = r2;
      for (int left = power / 2; left > 0; left /= 2, base = hn::Mul(base, base))
        if (left % 2 != 0) value = hn::Mul(value, base);
      sum = hn::Add(sum, value);
    }
  return {std::sqrt(hn::GetLane(hn::MaxOfLanes(d, farthest))), hn::GetLane(hn::SumOfLanes(d, sum))};
}

} // namespace cowgpu::plan::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cowgpu::plan {
HWY_EXPORT(AddFaceMoments);
HWY_EXPORT(Reach);

void add_face_moments(std::span<const FaceGroup> groups, const Vec3& centre, int order, double* room, double* moments) {
  HWY_DYNAMIC_DISPATCH(AddFaceMoments)(groups.data(), groups.size(), centre, order, room, moments);
}
FaceReach face_reach(std::span<const FaceGroup> groups, const Vec3& centre, int power) {
  return HWY_DYNAMIC_DISPATCH(Reach)(groups.data(), groups.size(), centre, power);
}
} // namespace cowgpu::plan
#endif

// A patch at a time: distances of its corners, logarithms of its edges, then its faces, each corner and edge once. What lanes
// need next to an edge or a face is computed where one of them is there.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/cpu/polyhedron_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/cpu/polyhedron_kernel.hpp"
#include "host/cpu/polyhedron_math-inl.hpp"
#include "host/plan/polyhedron_series.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::cpu::HWY_NAMESPACE {

using Rows = plan::PolyhedronRows;

// A vector of points beside a patch: sums of the patch, and what is known about its corners and edges.
template <class Tag, class Series, bool Second>
struct PatchSum {
  using T = hn::TFromD<Tag>;
  using Vector = hn::Vec<Tag>;
  using Patch = typename plan::PolyhedronPatches<T>::Patch;
  using Edge = typename plan::PolyhedronPatches<T>::Edge;
  using Face = typename plan::PolyhedronPatches<T>::Face;
  static constexpr std::size_t lanes = hn::MaxLanes(Tag());

  struct Corner {
    T to[3][lanes]; // r
    T distance[lanes];
  };
  struct Side {
    T logarithm[lanes]; // L
    T excess[lanes];    // u
  };

  const Patch& patch;
  Corner* corners;
  Side* sides;
  std::uint8_t* touched; // [edge]: a lane is on it
  T touching;
  double* rows; // of the sums, at the first lane
  std::size_t stride;
  std::size_t points;                         // lanes that are points
  bool any_near = false, any_touched = false; // a lane is next to an edge, or on one

  static HWY_INLINE Vector load(const T* from) { return hn::Load(Tag(), from); }
  static HWY_INLINE Vector set(T value) { return hn::Set(Tag(), value); }
  static HWY_INLINE Vector dot(const std::array<T, 3>& a, const Corner& b) {
    return hn::MulAdd(set(a[0]), load(b.to[0]),
                      hn::MulAdd(set(a[1]), load(b.to[1]), hn::Mul(set(a[2]), load(b.to[2]))));
  }

  HWY_INLINE void measure_corners(Vector x, Vector y, Vector z) {
    // On a corner its distance is next to 0, so that nothing is divided by 0.
    const Vector least = set(T(sizeof(T) == 8 ? 1e-60 : 1e-30));
    for (std::size_t i = 0; i < patch.vertices.size(); ++i) {
      const auto& v = patch.vertices[i];
      const Vector a = hn::Sub(set(v[0]), x), b = hn::Sub(set(v[1]), y), c = hn::Sub(set(v[2]), z);
      const Tag tag;
      hn::Store(a, tag, corners[i].to[0]);
      hn::Store(b, tag, corners[i].to[1]);
      hn::Store(c, tag, corners[i].to[2]);
      hn::Store(hn::Sqrt(hn::Max(hn::MulAdd(a, a, hn::MulAdd(b, b, hn::Mul(c, c))), least)), tag, corners[i].distance);
    }
  }

  // a + b - e next to the edge, where it cancels: a - p and b - q, p + q = e the parts of the edge on both sides of the foot of
  // the height. Notes which lanes are on the edge.
  HWY_NOINLINE Vector near_excess(const Edge& edge, Vector plain, std::size_t index) {
    const Tag tag;
    const Corner &from = corners[edge.from], &to = corners[edge.to];
    const Vector length = set(edge.length), zero = hn::Zero(tag), inverse = set(T(1) / edge.length);
    Vector r[3], direction[3];
    for (int k = 0; k < 3; ++k) {
      r[k] = load(from.to[k]);
      direction[k] = hn::Mul(hn::Sub(load(to.to[k]), r[k]), inverse);
    }
    const Vector along =
        hn::Neg(hn::MulAdd(direction[0], r[0], hn::MulAdd(direction[1], r[1], hn::Mul(direction[2], r[2]))));
    const Vector rest = hn::Sub(length, along);
    Vector height2 = zero;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const Vector c = hn::MulSub(r[i], direction[j], hn::Mul(r[j], direction[i]));
      height2 = hn::MulAdd(c, c, height2);
    }
    const Vector a = load(from.distance), b = load(to.distance);
    const Vector first =
        hn::IfThenElse(hn::Gt(along, zero), hn::Div(height2, hn::Add(a, hn::Max(along, zero))), hn::Sub(a, along));
    const Vector second =
        hn::IfThenElse(hn::Gt(rest, zero), hn::Div(height2, hn::Add(b, hn::Max(rest, zero))), hn::Sub(b, rest));
    if constexpr (Second) {
      const Vector margin = set(touching);
      const auto on = hn::And(hn::Le(height2, hn::Mul(margin, margin)),
                              hn::And(hn::Ge(along, hn::Neg(margin)), hn::Ge(rest, hn::Neg(margin))));
      if (!hn::AllFalse(tag, on)) {
        any_touched = true;
        touched[index] = 1;
        T mask[lanes];
        hn::StoreU(hn::IfThenElseZero(on, set(T(edge.sharp))), tag, mask);
        for (std::size_t lane = 0; lane < points; ++lane) rows[Rows::on_edge * stride + lane] += double(mask[lane]);
      }
    }
    constexpr T epsilon = std::numeric_limits<T>::epsilon();
    const Vector exact = hn::Max(hn::Add(first, second), set(epsilon * epsilon * edge.length));
    return hn::IfThenElse(hn::Lt(plain, set(edge.length / 64)), exact, plain);
  }

  HWY_INLINE void measure_sides() {
    const Tag tag;
    constexpr T epsilon = std::numeric_limits<T>::epsilon();
    for (std::size_t i = 0; i < patch.edges.size(); ++i) {
      const Edge& edge = patch.edges[i];
      const Vector length = set(edge.length);
      const Vector sum = hn::Add(load(corners[edge.from].distance), load(corners[edge.to].distance));
      const Vector above = hn::Add(sum, length);
      Vector below = hn::Max(hn::Sub(sum, length), set(epsilon * edge.length)), logarithm;
      if (hn::AllTrue(tag, hn::Gt(sum, set(T(5.1) * edge.length)))) {
        logarithm = twice_atanh<Series>(tag, hn::Div(length, sum));
      } else {
        if (HWY_UNLIKELY(!hn::AllTrue(tag, hn::Ge(below, set(edge.length / 64))))) {
          below = near_excess(edge, below, i);
          any_near = true;
        }
        logarithm = log_side<Series>(tag, sum, length, below);
      }
      hn::Store(logarithm, tag, sides[i].logarithm);
      hn::Store(hn::Mul(above, below), tag, sides[i].excess);
    }
  }

  // The solid angle where a lane is near the face. On the face's plane it is 0, the mean of both sides; half the jump between
  // the sides is added to its rows.
  HWY_NOINLINE Vector near_angle(const Face& face, Vector height, Vector above, Vector below) {
    const Tag tag;
    const Vector angle = twice_atan2<Series>(tag, above, below);
    const auto on = hn::Le(hn::Abs(height), set(touching));
    if (hn::AllFalse(tag, on)) return angle;
    if constexpr (Second) {
      T is_on[lanes], across[3][lanes];
      hn::StoreU(hn::IfThenElseZero(on, set(T(1))), tag, is_on);
      for (std::size_t k = 0; k < 3; ++k) hn::StoreU(dot(face.outward[k], corners[face.corners[k]]), tag, across[k]);
      for (std::size_t lane = 0; lane < points; ++lane) {
        if (is_on[lane] == 0) continue;
        int outside = 0, on_line = 0;
        std::size_t off = 0; // the edge that it is not on
        for (std::size_t k = 0; k < 3; ++k) {
          if (across[k][lane] < -touching)
            ++outside;
          else if (across[k][lane] <= touching)
            ++on_line;
          else
            off = k;
        }
        if (outside > 0 || on_line > 2) continue;
        double part = 2 * std::numbers::pi;
        if (on_line == 1) part = std::numbers::pi;
        if (on_line == 2) {
          const auto &u = face.outward[(off + 1) % 3], &v = face.outward[(off + 2) % 3];
          part = std::acos(std::clamp(-double(u[0] * v[0] + u[1] * v[1] + u[2] * v[2]), -1.0, 1.0));
        }
        std::size_t row = Rows::jump;
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = i; j < 3; ++j)
            rows[row++ * stride + lane] += part * double(face.normal[i]) * double(face.normal[j]);
      }
    }
    return hn::IfThenZeroElse(on, angle);
  }

  // Without the edges that a lane is on: what they made is taken off again.
  HWY_NOINLINE void leave_out(const Face& face, Vector* hessian) {
    const Tag tag;
    for (std::size_t k = 0; k < 3; ++k) {
      if (!touched[face.edges[k]]) continue;
      const Edge& edge = patch.edges[face.edges[k]];
      const Vector length = set(edge.length), margin = set(touching), inverse = set(T(1) / edge.length);
      const Corner &a = corners[edge.from], &b = corners[edge.to];
      Vector along = hn::Zero(tag), height2 = along, direction[3], r[3];
      for (int c = 0; c < 3; ++c) {
        r[c] = load(a.to[c]);
        direction[c] = hn::Mul(hn::Sub(load(b.to[c]), r[c]), inverse);
        along = hn::NegMulAdd(direction[c], r[c], along);
      }
      for (int c = 0; c < 3; ++c) {
        const int i = (c + 1) % 3, j = (c + 2) % 3;
        const Vector x = hn::MulSub(r[i], direction[j], hn::Mul(r[j], direction[i]));
        height2 = hn::MulAdd(x, x, height2);
      }
      const auto on = hn::And(hn::Le(height2, hn::Mul(margin, margin)),
                              hn::And(hn::Ge(along, hn::Neg(margin)), hn::Ge(hn::Sub(length, along), hn::Neg(margin))));
      const Vector out = hn::IfThenElseZero(on, load(sides[face.edges[k]].logarithm));
      std::size_t at = 0;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j, ++at)
          hessian[at] = hn::NegMulAdd(set(face.normal[i] * face.outward[k][j]), out, hessian[at]);
    }
  }

  // Next to an edge the angle is ill conditioned, and whether the point is on the face's plane has to be looked at.
  // sum[row]: V twice, -grad V, w, dd V.
  HWY_INLINE void add_faces(Vector* sum) {
    const Tag tag;
    const Vector four = set(T(4)), fifth = set(T(0.2));
    for (const Face& face : patch.faces) {
      const Corner &a = corners[face.corners[0]], &b = corners[face.corners[1]], &c = corners[face.corners[2]];
      const Side &ab = sides[face.edges[0]], &bc = sides[face.edges[1]], &ca = sides[face.edges[2]];
      const Vector da = load(a.distance), db = load(b.distance), dc = load(c.distance);
      const Vector height = dot(face.normal, a);
      const Vector corner =
          hn::MulAdd(da, load(bc.excess), hn::MulAdd(db, load(ca.excess), hn::Mul(dc, load(ab.excess))));
      const Vector below = hn::NegMulAdd(hn::Mul(hn::Mul(four, da), db), dc, corner);
      const Vector above = hn::Mul(set(face.four_areas), height);
      const Vector angle = HWY_LIKELY(!any_near && hn::AllTrue(tag, hn::Lt(hn::Abs(above), hn::Mul(below, fifth))))
                               ? twice_atan<Series>(tag, hn::Div(above, below))
                               : near_angle(face, height, above, below);
      const Vector la = load(ab.logarithm), lb = load(bc.logarithm), lc = load(ca.logarithm);
      Vector phi;
      if constexpr (Second) {
        // s_b of edge 1 is m_1.r_a + its height, so that the vector below serves for phi and for second derivatives.
        Vector across[3];
        for (std::size_t k = 0; k < 3; ++k)
          across[k] =
              hn::NegMulAdd(set(face.normal[k]), angle,
                            hn::MulAdd(set(face.outward[0][k]), la,
                                       hn::MulAdd(set(face.outward[1][k]), lb, hn::Mul(set(face.outward[2][k]), lc))));
        phi = hn::MulAdd(
            across[0], load(a.to[0]),
            hn::MulAdd(across[1], load(a.to[1]), hn::MulAdd(across[2], load(a.to[2]), hn::Mul(set(face.height), lb))));
        std::size_t at = Rows::hessian;
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = i; j < 3; ++j, ++at) sum[at] = hn::MulAdd(set(face.normal[i]), across[j], sum[at]);
        if (HWY_UNLIKELY(any_touched)) leave_out(face, sum + Rows::hessian);
      } else {
        phi = hn::NegMulAdd(height, angle,
                            hn::MulAdd(dot(face.outward[0], a), la,
                                       hn::MulAdd(dot(face.outward[1], b), lb, hn::Mul(dot(face.outward[2], c), lc))));
      }
      sum[Rows::value] = hn::MulAdd(height, phi, sum[Rows::value]);
      for (std::size_t k = 0; k < 3; ++k)
        sum[Rows::gradient + k] = hn::MulAdd(set(face.normal[k]), phi, sum[Rows::gradient + k]);
      sum[Rows::winding] = hn::Add(sum[Rows::winding], angle);
    }
  }
};

template <class Tag, class Series, bool Second>
void sum_all(const plan::PolyhedronPatches<hn::TFromD<Tag>>& patches, std::span<const std::uint32_t> which,
             const double* points, std::size_t count, double touching, PolyhedronScratch& scratch, double* sums) {
  using T = hn::TFromD<Tag>;
  using Sum = PatchSum<Tag, Series, Second>;
  constexpr Tag tag;
  constexpr std::size_t lanes = Sum::lanes, used = Second ? 11 : Rows::first;
  const std::size_t corner_bytes = patches.most_vertices() * sizeof(typename Sum::Corner);
  const std::size_t side_bytes = patches.most_edges() * sizeof(typename Sum::Side);
  char* room = static_cast<char*>(scratch.room(corner_bytes + side_bytes + patches.most_edges()));
  auto* corners = reinterpret_cast<typename Sum::Corner*>(room);
  auto* sides = reinterpret_cast<typename Sum::Side*>(room + corner_bytes);
  auto* touched = reinterpret_cast<std::uint8_t*>(room + corner_bytes + side_bytes);
  if constexpr (Second) std::fill_n(touched, patches.most_edges(), std::uint8_t(0));
  for (const std::uint32_t p : which) {
    const auto& patch = patches[p];
    // In single precision heights are right to the rounding of the patch's own coordinates. What is called on a face and is not
    // loses 2 pi times its height of the gradient, so that the margin is no wider than it must be.
    T margin = T(touching);
    if constexpr (sizeof(T) == 4) {
      T reach = 0;
      for (const auto& v : patch.vertices)
        for (const T x : v) reach = std::max(reach, std::abs(x));
      margin = std::max(margin, 8 * std::numeric_limits<T>::epsilon() * reach);
    }
    for (std::size_t first = 0; first < count; first += lanes) {
      const std::size_t own = std::min(lanes, count - first);
      alignas(64) T at[3][lanes];
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = 0; i < lanes; ++i)
          at[k][i] = T(points[k * count + first + std::min(i, own - 1)] - patch.centre[Eigen::Index(k)]);
      Sum sum{patch, corners, sides, touched, margin, sums + first, count, own};
      sum.measure_corners(hn::Load(tag, at[0]), hn::Load(tag, at[1]), hn::Load(tag, at[2]));
      sum.measure_sides();
      hn::Vec<Tag> total[used];
      for (auto& v : total) v = hn::Zero(tag);
      sum.add_faces(total);
      if (Second && sum.any_touched) std::fill_n(touched, patch.edges.size(), std::uint8_t(0));
      constexpr double quarter = 0.25 * std::numbers::inv_pi;
      for (std::size_t row = 0; row < used; ++row) {
        alignas(64) T values[lanes];
        hn::Store(total[row], tag, values);
        const double factor = row == Rows::value ? 0.5 : row < Rows::winding ? -1 : row == Rows::winding ? quarter : 1;
        for (std::size_t i = 0; i < own; ++i) sums[row * count + first + i] += factor * double(values[i]);
      }
    }
  }
}

template <class T, class Series>
void sum_in(const plan::PolyhedronPatches<T>& patches, std::span<const std::uint32_t> which, const double* points,
            std::size_t count, const PolyhedronTerms& terms, PolyhedronScratch& scratch, double* sums) {
  using Tag = hn::CappedTag<T, 64 / sizeof(T)>;
  if (terms.second)
    sum_all<Tag, Series, true>(patches, which, points, count, terms.touching, scratch, sums);
  else
    sum_all<Tag, Series, false>(patches, which, points, count, terms.touching, scratch, sums);
}

void SumDouble(const plan::PolyhedronPatches<double>& patches, std::span<const std::uint32_t> which,
               const double* points, std::size_t count, const PolyhedronTerms& terms, PolyhedronScratch& scratch,
               double* sums) {
  if (terms.digits == SumDigits::nine)
    sum_in<double, plan::NineSeries>(patches, which, points, count, terms, scratch, sums);
  else
    sum_in<double, plan::FullSeries>(patches, which, points, count, terms, scratch, sums);
}
void SumSingle(const plan::PolyhedronPatches<float>& patches, std::span<const std::uint32_t> which,
               const double* points, std::size_t count, const PolyhedronTerms& terms, PolyhedronScratch& scratch,
               double* sums) {
  sum_in<float, plan::SingleSeries>(patches, which, points, count, terms, scratch, sums);
}

} // namespace cowgpu::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cowgpu::cpu {
HWY_EXPORT(SumDouble);
HWY_EXPORT(SumSingle);

void* PolyhedronScratch::room(std::size_t bytes) {
  const std::size_t lines = (bytes + sizeof(Line) - 1) / sizeof(Line);
  if (lines_.size() < lines) lines_.resize(lines);
  return lines_.data();
}

void sum_patches(const plan::PolyhedronPatches<double>& patches, std::span<const std::uint32_t> which,
                 const double* points, std::size_t count, const PolyhedronTerms& terms, PolyhedronScratch& scratch,
                 double* sums) {
  HWY_DYNAMIC_DISPATCH(SumDouble)(patches, which, points, count, terms, scratch, sums);
}
void sum_patches(const plan::PolyhedronPatches<float>& patches, std::span<const std::uint32_t> which,
                 const double* points, std::size_t count, const PolyhedronTerms& terms, PolyhedronScratch& scratch,
                 double* sums) {
  HWY_DYNAMIC_DISPATCH(SumSingle)(patches, which, points, count, terms, scratch, sums);
}
} // namespace cowgpu::cpu
#endif

// Logarithms and angles of the closed forms, for lanes of doubles or floats: include after hwy/foreach_target.h.
#if defined(COWGPU_HOST_CPU_POLYHEDRON_MATH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef COWGPU_HOST_CPU_POLYHEDRON_MATH_INL
#undef COWGPU_HOST_CPU_POLYHEDRON_MATH_INL
#else
#define COWGPU_HOST_CPU_POLYHEDRON_MATH_INL
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::cpu::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Sum of c[i] w^i.
template <class Tag, class Number, std::size_t N, class Vector = hn::Vec<Tag>>
HWY_INLINE Vector polynomial(Tag tag, const std::array<Number, N>& c, Vector w) {
  using T = hn::TFromD<Tag>;
  Vector sum = hn::Set(tag, T(c[N - 1]));
  for (std::size_t i = N - 1; i > 0; --i) sum = hn::MulAdd(sum, w, hn::Set(tag, T(c[i - 1])));
  return sum;
}

/// ln((sum + edge)/below) for below = sum - edge, given apart. Where sum > 5.1 edge it is 2 atanh(edge/sum), without cancellation;
/// else k ln 2 + 2 atanh z, k the nearest whole number to the difference of the logarithms of both as their bits tell them, to
/// 0.086: then z = (sum + edge - 2^k below)/(sum + edge + 2^k below) is below 0.2005. Of positive normal numbers.
template <class Series, class Tag, class Vector = hn::Vec<Tag>>
HWY_INLINE Vector log_side(Tag tag, Vector sum, Vector edge, Vector below) {
  using T = hn::TFromD<Tag>;
  constexpr int mantissa = std::numeric_limits<T>::digits - 1;
  const hn::RebindToUnsigned<Tag> whole;
  using Whole = hn::TFromD<decltype(whole)>;
  const Vector above = hn::Add(sum, edge);
  const auto far = hn::Gt(sum, hn::Mul(edge, hn::Set(tag, T(5.1))));
  const auto difference = hn::Sub(hn::BitCast(whole, above), hn::BitCast(whole, below));
  const auto k = hn::ShiftRight<mantissa>(hn::Add(difference, hn::Set(whole, Whole(1) << (mantissa - 1))));
  const Vector scaled = hn::BitCast(tag, hn::Add(hn::BitCast(whole, below), hn::ShiftLeft<mantissa>(k)));
  // k as a number: the bits of 2^mantissa + k, less 2^mantissa.
  constexpr T large = T(Whole(1) << mantissa);
  const Vector power =
      hn::Sub(hn::BitCast(tag, hn::Or(k, hn::BitCast(whole, hn::Set(tag, large)))), hn::Set(tag, large));
  const Vector z =
      hn::Div(hn::IfThenElse(far, edge, hn::Sub(above, scaled)), hn::IfThenElse(far, sum, hn::Add(above, scaled)));
  return hn::MulAdd(hn::IfThenZeroElse(far, power), hn::Set(tag, std::numbers::ln2_v<T>),
                    hn::Mul(z, polynomial(tag, Series::atanh, hn::Mul(z, z))));
}

/// 2 atanh z for |z| <= 0.2.
template <class Series, class Tag, class Vector = hn::Vec<Tag>>
HWY_INLINE Vector twice_atanh(Tag tag, Vector z) {
  return hn::Mul(z, polynomial(tag, Series::atanh, hn::Mul(z, z)));
}

/// 2 atan t for |t| <= 0.2.
template <class Series, class Tag, class Vector = hn::Vec<Tag>>
HWY_INLINE Vector twice_atan(Tag tag, Vector t) {
  return hn::Mul(t, polynomial(tag, Series::atan, hn::Mul(t, t)));
}

/// 2 atan2(y, x), between -2 pi and 2 pi; 0 where both are 0.
template <class Series, class Tag, class Vector = hn::Vec<Tag>>
HWY_INLINE Vector twice_atan2(Tag tag, Vector y, Vector x) {
  using T = hn::TFromD<Tag>;
  const Vector rise = hn::Abs(y), run = hn::Abs(x);
  const Vector most = hn::Max(hn::Max(rise, run), hn::Set(tag, std::numeric_limits<T>::min())),
               least = hn::Min(rise, run);
  const auto steep =
      hn::Gt(least, hn::Mul(most, hn::Set(tag, T(std::numbers::sqrt2 - 1)))); // beyond an eighth of a turn's half
  const Vector t =
      hn::Div(hn::IfThenElse(steep, hn::Sub(least, most), least), hn::IfThenElse(steep, hn::Add(least, most), most));
  const Vector two_pi = hn::Set(tag, 2 * std::numbers::pi_v<T>), pi = hn::Set(tag, std::numbers::pi_v<T>);
  Vector angle = hn::Mul(t, polynomial(tag, Series::folded_atan, hn::Mul(t, t)));
  angle = hn::Add(angle, hn::IfThenElseZero(steep, hn::Set(tag, std::numbers::pi_v<T> / 2)));
  angle = hn::IfThenElse(hn::Gt(rise, run), hn::Sub(pi, angle), angle);
  angle = hn::IfThenElse(hn::Lt(x, hn::Zero(tag)), hn::Sub(two_pi, angle), angle);
  return hn::CopySignToAbs(angle, y);
}

} // namespace cowgpu::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

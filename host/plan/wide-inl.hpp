// N numbers at once, in as many vectors as the instruction set needs: include after hwy/foreach_target.h.
#if defined(COWGPU_HOST_PLAN_WIDE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef COWGPU_HOST_PLAN_WIDE_INL
#undef COWGPU_HOST_PLAN_WIDE_INL
#else
#define COWGPU_HOST_PLAN_WIDE_INL
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::plan::HWY_NAMESPACE {
namespace hw = hwy::HWY_NAMESPACE;

template <class T, std::size_t N>
struct Wide {
  using Number = T;
  using Tag = hw::CappedTag<T, N>;
  static constexpr std::size_t lanes = hw::MaxLanes(Tag());
  static constexpr std::size_t parts = N / lanes;
  hw::Vec<Tag> v[parts];
};

template <class W>
struct WideMask {
  hw::Mask<typename W::Tag> m[W::parts];
};

template <class W>
HWY_INLINE W wide_set(typename W::Number value) {
  W r;
  for (std::size_t k = 0; k < W::parts; ++k) r.v[k] = hw::Set(typename W::Tag(), value);
  return r;
}
/// From N aligned numbers.
template <class W>
HWY_INLINE W wide_load(const typename W::Number* from) {
  W r;
  for (std::size_t k = 0; k < W::parts; ++k) r.v[k] = hw::Load(typename W::Tag(), from + k * W::lanes);
  return r;
}
template <class W>
HWY_INLINE void store(const W& a, typename W::Number* to) {
  for (std::size_t k = 0; k < W::parts; ++k) hw::Store(a.v[k], typename W::Tag(), to + k * W::lanes);
}

template <class T, std::size_t N>
HWY_INLINE Wide<T, N> operator+(const Wide<T, N>& a, const Wide<T, N>& b) {
  Wide<T, N> r;
  for (std::size_t k = 0; k < r.parts; ++k) r.v[k] = hw::Add(a.v[k], b.v[k]);
  return r;
}
template <class T, std::size_t N>
HWY_INLINE Wide<T, N> operator-(const Wide<T, N>& a, const Wide<T, N>& b) {
  Wide<T, N> r;
  for (std::size_t k = 0; k < r.parts; ++k) r.v[k] = hw::Sub(a.v[k], b.v[k]);
  return r;
}
template <class T, std::size_t N>
HWY_INLINE Wide<T, N> operator*(const Wide<T, N>& a, const Wide<T, N>& b) {
  Wide<T, N> r;
  for (std::size_t k = 0; k < r.parts; ++k) r.v[k] = hw::Mul(a.v[k], b.v[k]);
  return r;
}
/// a b + c
template <class W>
HWY_INLINE W mul_add(const W& a, const W& b, const W& c) {
  W r;
  for (std::size_t k = 0; k < W::parts; ++k) r.v[k] = hw::MulAdd(a.v[k], b.v[k], c.v[k]);
  return r;
}
/// c - a b
template <class W>
HWY_INLINE W neg_mul_add(const W& a, const W& b, const W& c) {
  W r;
  for (std::size_t k = 0; k < W::parts; ++k) r.v[k] = hw::NegMulAdd(a.v[k], b.v[k], c.v[k]);
  return r;
}
template <class W>
HWY_INLINE W least(const W& a, const W& b) {
  W r;
  for (std::size_t k = 0; k < W::parts; ++k) r.v[k] = hw::Min(a.v[k], b.v[k]);
  return r;
}
template <class W>
HWY_INLINE W most(const W& a, const W& b) {
  W r;
  for (std::size_t k = 0; k < W::parts; ++k) r.v[k] = hw::Max(a.v[k], b.v[k]);
  return r;
}
template <class W>
HWY_INLINE W root(const W& a) {
  W r;
  for (std::size_t k = 0; k < W::parts; ++k) r.v[k] = hw::Sqrt(a.v[k]);
  return r;
}
template <class T, std::size_t N>
HWY_INLINE WideMask<Wide<T, N>> operator<(const Wide<T, N>& a, const Wide<T, N>& b) {
  WideMask<Wide<T, N>> r;
  for (std::size_t k = 0; k < a.parts; ++k) r.m[k] = hw::Lt(a.v[k], b.v[k]);
  return r;
}
template <class T, std::size_t N>
HWY_INLINE WideMask<Wide<T, N>> operator<=(const Wide<T, N>& a, const Wide<T, N>& b) {
  WideMask<Wide<T, N>> r;
  for (std::size_t k = 0; k < a.parts; ++k) r.m[k] = hw::Le(a.v[k], b.v[k]);
  return r;
}
template <class T, std::size_t N>
HWY_INLINE WideMask<Wide<T, N>> equal(const Wide<T, N>& a, const Wide<T, N>& b) {
  WideMask<Wide<T, N>> r;
  for (std::size_t k = 0; k < a.parts; ++k) r.m[k] = hw::Eq(a.v[k], b.v[k]);
  return r;
}
template <class W>
HWY_INLINE WideMask<W> operator&(const WideMask<W>& a, const WideMask<W>& b) {
  WideMask<W> r;
  for (std::size_t k = 0; k < W::parts; ++k) r.m[k] = hw::And(a.m[k], b.m[k]);
  return r;
}
template <class W>
HWY_INLINE WideMask<W> operator|(const WideMask<W>& a, const WideMask<W>& b) {
  WideMask<W> r;
  for (std::size_t k = 0; k < W::parts; ++k) r.m[k] = hw::Or(a.m[k], b.m[k]);
  return r;
}
template <class W>
HWY_INLINE W choose(const WideMask<W>& mask, const W& yes, const W& no) {
  W r;
  for (std::size_t k = 0; k < W::parts; ++k) r.v[k] = hw::IfThenElse(mask.m[k], yes.v[k], no.v[k]);
  return r;
}
/// 0 where the mask holds.
template <class W>
HWY_INLINE W zero_where(const WideMask<W>& mask, const W& a) {
  W r;
  for (std::size_t k = 0; k < W::parts; ++k) r.v[k] = hw::IfThenZeroElse(mask.m[k], a.v[k]);
  return r;
}

/// Bit i for lane i.
template <class W>
HWY_INLINE std::uint32_t bits(const WideMask<W>& mask) {
  std::uint32_t r = 0;
  for (std::size_t k = 0; k < W::parts; ++k) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
    const auto part = std::uint32_t(mask.m[k].raw);
#else
    std::uint8_t bytes[8] = {};
    hw::StoreMaskBits(typename W::Tag(), mask.m[k], bytes);
    const std::uint32_t part = bytes[0] | std::uint32_t(bytes[1]) << 8;
#endif
    r |= part << (k * W::lanes);
  }
  return r;
}

template <class W>
HWY_INLINE typename W::Number least_lane(const W& a) {
  hw::Vec<typename W::Tag> r = a.v[0];
  for (std::size_t k = 1; k < W::parts; ++k) r = hw::Min(r, a.v[k]);
  return hw::GetLane(hw::MinOfLanes(typename W::Tag(), r));
}
template <class W>
HWY_INLINE typename W::Number most_lane(const W& a) {
  hw::Vec<typename W::Tag> r = a.v[0];
  for (std::size_t k = 1; k < W::parts; ++k) r = hw::Max(r, a.v[k]);
  return hw::GetLane(hw::MaxOfLanes(typename W::Tag(), r));
}

} // namespace cowgpu::plan::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

// Operations across the lanes of vectors, compiled once per instruction set: include after hwy/foreach_target.h.
#if defined(COWGPU_HOST_CPU_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef COWGPU_HOST_CPU_LANES_INL
#undef COWGPU_HOST_CPU_LANES_INL
#else
#define COWGPU_HOST_CPU_LANES_INL
#endif

#include <hwy/highway.h>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::cpu::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Vectors of the CPU path: up to 8 doubles.
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
constexpr D d;
constexpr std::size_t lanes = hn::MaxLanes(d);

/// Sums over the lanes of a[0] ... a[7]: as 8 / lanes vectors, given to to(vector, its index).
template <class To>
HWY_INLINE void lane_sums(const V* a, const To& to) {
  if constexpr (lanes == 1) {
    for (std::size_t i = 0; i < 8; ++i) to(a[i], i);
  } else {
#if HWY_TARGET != HWY_SCALAR
    const auto add_pair = [](V x, V y)
                              HWY_ATTR { return hn::Add(hn::InterleaveLower(d, x, y), hn::InterleaveUpper(d, x, y)); };
    const V p0 = add_pair(a[0], a[1]), p1 = add_pair(a[2], a[3]), p2 = add_pair(a[4], a[5]), p3 = add_pair(a[6], a[7]);
    if constexpr (lanes == 2) {
      to(p0, 0);
      to(p1, 1);
      to(p2, 2);
      to(p3, 3);
    } else {
      const auto add_blocks = [](V x, V y) HWY_ATTR {
        return hn::Add(hn::OddEvenBlocks(y, x), hn::SwapAdjacentBlocks(hn::OddEvenBlocks(x, y)));
      };
      const V q0 = add_blocks(p0, p1), q1 = add_blocks(p2, p3);
      if constexpr (lanes == 4) {
        to(q0, 0);
        to(q1, 1);
      } else {
        to(hn::Add(hn::ConcatLowerLower(d, q1, q0), hn::ConcatUpperUpper(d, q1, q0)), 0);
      }
    }
#endif
  }
}

/// Sums over the lanes of a[0] ... a[7], to p[0] ... p[7], which are aligned.
HWY_INLINE void store_lane_sums(const V* a, double* p) {
  lane_sums(a, [p](V sum, std::size_t i) HWY_ATTR { hn::Store(sum, d, p + i * lanes); });
}
/// The same, added to what is there.
HWY_INLINE void add_lane_sums(const V* a, double* p) {
  lane_sums(a, [p](V sum, std::size_t i)
                   HWY_ATTR { hn::Store(hn::Add(hn::Load(d, p + i * lanes), sum), d, p + i * lanes); });
}

/// Rows become columns of a[0] ... a[lanes-1].
HWY_INLINE void transpose(V* a) {
#if HWY_TARGET != HWY_SCALAR
  if constexpr (lanes > 1) {
    for (std::size_t i = 0; i < lanes; i += 2) {
      const V lower = hn::InterleaveLower(d, a[i], a[i + 1]), upper = hn::InterleaveUpper(d, a[i], a[i + 1]);
      a[i] = lower;
      a[i + 1] = upper;
    }
  }
  if constexpr (lanes == 4) {
    for (std::size_t i = 0; i < 2; ++i) {
      const V lower = hn::ConcatLowerLower(d, a[i + 2], a[i]), upper = hn::ConcatUpperUpper(d, a[i + 2], a[i]);
      a[i] = lower;
      a[i + 2] = upper;
    }
  }
  if constexpr (lanes == 8) {
    for (std::size_t i = 0; i < 8; i += i % 2 ? 3 : 1) { // 0, 1, 4, 5: pairs of blocks, two rows apart
      const V even = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(a[i + 2]), a[i]);
      const V odd = hn::OddEvenBlocks(a[i + 2], hn::SwapAdjacentBlocks(a[i]));
      a[i] = even;
      a[i + 2] = odd;
    }
    for (std::size_t i = 0; i < 4; ++i) {
      const V lower = hn::ConcatLowerLower(d, a[i + 4], a[i]), upper = hn::ConcatUpperUpper(d, a[i + 4], a[i]);
      a[i] = lower;
      a[i + 4] = upper;
    }
  }
#endif
  (void)a;
}

} // namespace cowgpu::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

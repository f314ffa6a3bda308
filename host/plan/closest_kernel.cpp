// A packet's box is held against sixteen boxes of children at once, nearest first; in a leaf against sixteen triangles'
// boxes, and the triangles left against the packet's sixteen points. A single point goes against sixteen boxes and sixteen
// triangles at once. Both gather candidates in single precision, within twice its margin of the best; whatever is still
// within it at the end is decided in double precision.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/plan/closest_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target must come first
#include "host/plan/closest_kernel.hpp"
#include "host/plan/wide-inl.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace cowgpu::plan::HWY_NAMESPACE {

using Floats = Wide<float, packet>;
using Doubles = Wide<double, 8>;
using FourDoubles = Wide<double, most_decided>;
using OneDouble = Wide<double, 1>;

constexpr float unbounded = 1e30F; // less than the square of where unused slots are
constexpr double infinite = std::numeric_limits<double>::infinity();

// a b + c. Fused in single precision alone: doubles decide, and a device's (shaders/flow.comp) are to decide alike.
template <class W>
HWY_INLINE W product_plus(const W& a, const W& b, const W& c) {
  if constexpr (std::is_same_v<W, Floats>)
    return mul_add(a, b, c);
  else
    return a * b + c;
}

// c - a b, the same.
template <class W>
HWY_INLINE W minus_product(const W& a, const W& b, const W& c) {
  if constexpr (std::is_same_v<W, Floats>)
    return neg_mul_add(a, b, c);
  else
    return c - a * b;
}

// Squared distance from an edge that runs from the origin to (ex, ey), `inverse` its inverse squared length.
template <class W>
HWY_INLINE W edge_distance2(const W& x, const W& y, const W& ex, const W& ey, const W& inverse) {
  const W zero = wide_set<W>(0), one = wide_set<W>(1);
  const W s = least(most(product_plus(x, ex, y * ey) * inverse, zero), one);
  const W dx = minus_product(s, ex, x), dy = minus_product(s, ey, y);
  return product_plus(dx, dx, dy * dy);
}

// `t` has the members of TriangleFrame from `length` on.
template <class W, class Frame>
HWY_INLINE W in_plane(const Frame& t, const W& x, const W& y, const W& z) {
  const W zero = wide_set<W>(0);
  const W dx = x - least(most(x, zero), t.length), xb = x - t.length;
  W d2 = product_plus(dx, dx, y * y);
  d2 = least(d2, edge_distance2(x, y, t.cx, t.cy, t.c_inverse));
  d2 = least(d2, edge_distance2(xb, y, t.ex, t.ey, t.e_inverse));
  const auto inside = (zero < y) & (t.cx * y < t.cy * x) & (t.ey * xb < t.ex * y);
  return product_plus(z, z, zero_where(inside, d2));
}

template <class W>
struct Frame {
  W a[3], u[3], v[3], n[3], length, cx, cy, c_inverse, ex, ey, e_inverse;
};

// number(k): the k-th number of TriangleFrame.
template <class W, class Number>
HWY_INLINE Frame<W> frame_from(const Number& number) {
  Frame<W> t;
  for (std::size_t c = 0; c < 3; ++c) {
    t.a[c] = number(c);
    t.u[c] = number(3 + c);
    t.v[c] = number(6 + c);
    t.n[c] = number(9 + c);
  }
  t.length = number(12);
  t.cx = number(13), t.cy = number(14), t.c_inverse = number(15);
  t.ex = number(16), t.ey = number(17), t.e_inverse = number(18);
  return t;
}

HWY_INLINE Floats single_distance2(const Frame<Floats>& t, const Floats* p) {
  const auto along = [&](const Floats* w, const Floats& offset)
                         HWY_ATTR { return mul_add(w[0], p[0], mul_add(w[1], p[1], w[2] * p[2] - offset)); };
  return in_plane(t, along(t.u, t.a[0]), along(t.v, t.a[1]), along(t.n, t.a[2]));
}

HWY_INLINE Floats single_distance2(const TriangleFrame<float>& t, const Floats* p) {
  const float* numbers = t.a;
  return single_distance2(frame_from<Floats>([&](std::size_t k) HWY_ATTR { return wide_set<Floats>(numbers[k]); }), p);
}

// The same rounding for any number of lanes, so that packets and single points agree.
template <class W>
HWY_INLINE W double_distance2(const TriangleFrame<double>& triangle, const W* p) {
  const double* numbers = triangle.a;
  const auto t = frame_from<W>([&](std::size_t k) HWY_ATTR { return wide_set<W>(numbers[k]); });
  const W rx = p[0] - t.a[0], ry = p[1] - t.a[1], rz = p[2] - t.a[2];
  const auto along = [&](const W* w) HWY_ATTR { return product_plus(w[0], rx, product_plus(w[1], ry, w[2] * rz)); };
  return in_plane(t, along(t.u), along(t.v), along(t.n));
}

// Between 16 boxes and a box or a point (low = high).
HWY_INLINE Floats box_distance2(const ClosestBoxes& boxes, const Floats* low, const Floats* high) {
  const Floats zero = wide_set<Floats>(0);
  const auto gap = [&](std::size_t c) HWY_ATTR {
    return most(most(wide_load<Floats>(boxes.low[c]) - high[c], low[c] - wide_load<Floats>(boxes.high[c])), zero);
  };
  const Floats x = gap(0), y = gap(1), z = gap(2);
  return mul_add(x, x, mul_add(y, y, z * z));
}

struct Waiting {
  float distance2;
  std::int32_t child;
};

// Children to be visited, the nearest on top.
struct Stack {
  Waiting items[closest_stack];
  std::size_t count = 0;

  HWY_INLINE void push(const ClosestNode& node, const Floats& distance2, std::uint32_t which) {
    HWY_ALIGN float d2[packet];
    store(distance2, d2);
    const std::size_t bottom = count;
    for (; which; which &= which - 1) {
      const auto j = std::size_t(std::countr_zero(which));
      const Waiting next = {d2[j], node.child[j]};
      std::size_t at = count++;
      for (; at > bottom && items[at - 1].distance2 < next.distance2; --at) items[at] = items[at - 1];
      items[at] = next;
    }
  }
};

HWY_INLINE float margin_at(float largest) {
  return 2 * closest_margin * std::max(1.0F, largest);
}

// The packet's candidates.
class PacketCandidates {
public:
  PacketCandidates(const ClosestTree& tree, const double (*points)[packet]) : tree_(tree), points_(points) {
    for (std::size_t h = 0; h < 2; ++h) {
      best_[h] = wide_set<Doubles>(infinite);
      face_[h] = wide_set<Doubles>(double(no_face));
    }
  }

  HWY_INLINE void add(std::uint32_t slot, const Floats& distance2, const Floats& bound) {
    if (HWY_UNLIKELY(count_ == most_candidates)) decide(bound);
    slots_[count_] = slot;
    distances_[count_++] = distance2;
  }

  // Those within the bound, in double precision.
  HWY_INLINE void decide(const Floats& bound) {
    for (std::size_t k = 0; k < count_; ++k) {
      const std::uint32_t near = bits(distances_[k] <= bound);
      if (!near) continue;
      const auto face = wide_set<Doubles>(double(tree_.face_of_slot[slots_[k]]));
      for (std::size_t h = 0; h < 2; ++h) {
        if (!(near >> (8 * h) & 0xffU)) continue;
        const Doubles p[3] = {wide_load<Doubles>(points_[0] + 8 * h), wide_load<Doubles>(points_[1] + 8 * h),
                              wide_load<Doubles>(points_[2] + 8 * h)};
        const Doubles d2 = double_distance2(tree_.frames[slots_[k]], p);
        const auto better = (d2 < best_[h]) | (equal(d2, best_[h]) & (face < face_[h]));
        best_[h] = choose(better, d2, best_[h]);
        face_[h] = choose(better, face, face_[h]);
      }
    }
    count_ = 0;
  }

  HWY_INLINE void faces(std::size_t count, std::uint32_t* out) const {
    HWY_ALIGN double face[packet];
    store(face_[0], face);
    store(face_[1], face + 8);
    for (std::size_t i = 0; i < count; ++i) out[i] = std::uint32_t(face[i]);
  }

private:
  static constexpr std::size_t most_candidates = 256;
  const ClosestTree& tree_;
  const double (*points_)[packet];
  Floats distances_[most_candidates];
  std::uint32_t slots_[most_candidates];
  std::size_t count_ = 0;
  Doubles best_[2], face_[2];
};

void Packet(const ClosestTree& tree, const Vec3* points, std::size_t count, WarmSlots& warm, std::uint32_t* faces) {
  HWY_ALIGN double exact[3][packet];
  HWY_ALIGN float single[3][packet];
  for (std::size_t i = 0; i < packet; ++i) {
    const Vec3& q = points[std::min(i, count - 1)];
    const auto local = tree.local(q);
    for (std::size_t c = 0; c < 3; ++c) {
      exact[c][i] = q[Eigen::Index(c)];
      single[c][i] = local[c];
    }
  }
  Floats p[3], low[3], high[3];
  float largest = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    p[c] = wide_load<Floats>(single[c]);
    const float from = least_lane(p[c]), to = most_lane(p[c]);
    low[c] = wide_set<Floats>(from);
    high[c] = wide_set<Floats>(to);
    largest = std::max({largest, std::abs(from), std::abs(to)});
  }
  const Floats margin = wide_set<Floats>(margin_at(largest));
  Floats best = wide_set<Floats>(unbounded);
  for (std::size_t w = 0; w < warm.count; ++w)
    best = least(best, single_distance2(tree.single_frames[warm.slot[w]], p));
  const auto bound_of = [&](const Floats& d2) HWY_ATTR {
    const Floats d = root(d2) + margin;
    return d * d;
  };
  Floats bound = bound_of(best);
  float widest = most_lane(bound);

  PacketCandidates candidates(tree, exact);
  Stack stack;
  stack.items[stack.count++] = {0, 0};
  while (stack.count) {
    const Waiting at = stack.items[--stack.count];
    if (at.distance2 > widest) continue;
    if (at.child >= 0) {
      const ClosestNode& node = tree.nodes[std::size_t(at.child)];
      const Floats d2 = box_distance2(node.boxes, low, high);
      stack.push(node, d2, bits(d2 <= wide_set<Floats>(widest)));
      continue;
    }
    const auto leaf_index = std::uint32_t(~at.child);
    const ClosestBoxes& boxes = tree.leaves[leaf_index].boxes;
    bool changed = false;
    for (std::uint32_t which = bits(box_distance2(boxes, low, high) <= wide_set<Floats>(widest)); which;
         which &= which - 1) {
      const auto j = std::uint32_t(std::countr_zero(which));
      const Floats zero = wide_set<Floats>(0);
      const auto gap = [&](std::size_t c) HWY_ATTR {
        return most(most(wide_set<Floats>(boxes.low[c][j]) - p[c], p[c] - wide_set<Floats>(boxes.high[c][j])), zero);
      };
      const Floats x = gap(0), y = gap(1), z = gap(2);
      if (!bits(mul_add(x, x, mul_add(y, y, z * z)) <= bound)) continue;
      const std::uint32_t slot = leaf_index * std::uint32_t(packet) + j;
      const Floats d2 = single_distance2(tree.single_frames[slot], p);
      if (!bits(d2 <= bound)) continue;
      if (bits(d2 < best)) {
        best = least(best, d2);
        bound = bound_of(best);
        changed = true;
      }
      candidates.add(slot, d2, bound);
    }
    if (changed) widest = most_lane(bound);
  }
  candidates.decide(bound);
  candidates.faces(count, faces);

  warm.count = 0;
  for (std::size_t i = 0; i < count && warm.count < WarmSlots::most; ++i) {
    const std::uint32_t slot = tree.slot_of_face[faces[i]];
    if (std::find(warm.slot, warm.slot + warm.count, slot) == warm.slot + warm.count) warm.slot[warm.count++] = slot;
  }
}

// The best of a single point's candidates.
struct Best {
  double distance2;
  std::uint32_t face = no_face;

  HWY_INLINE void take(const ClosestTree& tree, std::uint32_t slot, const OneDouble* p) {
    HWY_ALIGN double d2[1];
    store(double_distance2(tree.frames[slot], p), d2);
    const std::uint32_t candidate = tree.face_of_slot[slot];
    if (d2[0] < distance2 || (d2[0] == distance2 && face != no_face && candidate < face))
      distance2 = d2[0], face = candidate;
  }
};

std::uint32_t Single(const ClosestTree& tree, const Vec3& point, double below, std::uint32_t warm_slot) {
  const OneDouble exact[3] = {wide_set<OneDouble>(point.x()), wide_set<OneDouble>(point.y()),
                              wide_set<OneDouble>(point.z())};
  Best result{below * below};
  const Vec3 offset = (point - tree.centre) * tree.scale;
  if (offset.cwiseAbs().maxCoeff() > closest_far) {
    for (std::uint32_t slot = 0; slot < tree.frames.size(); ++slot)
      if (tree.face_of_slot[slot] != no_face) result.take(tree, slot, exact);
    return result.face;
  }
  const auto local = tree.local(point);
  const Floats p[3] = {wide_set<Floats>(local[0]), wide_set<Floats>(local[1]), wide_set<Floats>(local[2])};
  const float margin = margin_at(std::max({std::abs(local[0]), std::abs(local[1]), std::abs(local[2])}));
  // `below` bounds as a found triangle does.
  float best = unbounded;
  if (const double d = below * tree.scale; d < 1e15) best = float(d * d) * (1 + 0x1p-22F);
  const auto bound_of = [&](float d2) {
    const float d = std::sqrt(d2) + margin;
    return d * d;
  };
  float bound = bound_of(best);

  constexpr std::size_t most_candidates = 256;
  std::uint32_t slots[most_candidates];
  float distances[most_candidates];
  std::size_t count = 0;
  const auto decide = [&]() HWY_ATTR {
    for (std::size_t k = 0; k < count; ++k)
      if (distances[k] <= bound) result.take(tree, slots[k], exact);
    count = 0;
  };
  if (warm_slot != no_face) {
    HWY_ALIGN double d2[1];
    store(double_distance2(tree.frames[warm_slot], exact), d2);
    best = std::min(best, float(d2[0] * tree.scale * tree.scale) * (1 + 0x1p-22F));
    bound = bound_of(best);
  }
  Stack stack;
  stack.items[stack.count++] = {0, 0};
  while (stack.count) {
    const Waiting at = stack.items[--stack.count];
    if (at.distance2 > bound) continue;
    if (at.child >= 0) {
      const ClosestNode& node = tree.nodes[std::size_t(at.child)];
      const Floats d2 = box_distance2(node.boxes, p, p);
      stack.push(node, d2, bits(d2 <= wide_set<Floats>(bound)));
      continue;
    }
    const auto leaf_index = std::size_t(~at.child);
    const ClosestLeaf& leaf = tree.leaves[leaf_index];
    const auto frame = frame_from<Floats>([&](std::size_t k) HWY_ATTR { return wide_load<Floats>(leaf.frame[k]); });
    const Floats d2 = single_distance2(frame, p);
    std::uint32_t near = bits(d2 <= wide_set<Floats>(bound));
    if (!near) continue;
    if (const float nearest = least_lane(d2); nearest < best) {
      best = nearest;
      bound = bound_of(best);
      near = bits(d2 <= wide_set<Floats>(bound));
    }
    if (count + packet > most_candidates) decide();
    HWY_ALIGN float d[packet];
    store(d2, d);
    for (; near; near &= near - 1) {
      const auto j = std::uint32_t(std::countr_zero(near));
      slots[count] = std::uint32_t(leaf_index * packet) + j;
      distances[count++] = d[j];
    }
  }
  decide();
  return result.face;
}

void Decide(const ClosestTree& tree, const Vec3* points, std::size_t count, std::span<const std::uint32_t> slots,
            std::span<const std::uint32_t> masks, std::uint32_t* faces) {
  HWY_ALIGN double exact[3][most_decided], d2[most_decided];
  double best[most_decided];
  for (std::size_t i = 0; i < most_decided; ++i) {
    for (int c = 0; c < 3; ++c) exact[c][i] = points[std::min(i, count - 1)][c];
    best[i] = infinite;
    if (i < count) faces[i] = no_face;
  }
  const FourDoubles p[3] = {wide_load<FourDoubles>(exact[0]), wide_load<FourDoubles>(exact[1]),
                            wide_load<FourDoubles>(exact[2])};
  for (std::size_t k = 0; k < slots.size(); ++k) {
    store(double_distance2(tree.frames[slots[k]], p), d2);
    const std::uint32_t face = tree.face_of_slot[slots[k]];
    for (std::size_t i = 0; i < count; ++i)
      if (masks[k] >> i & 1 && (d2[i] < best[i] || (d2[i] == best[i] && face < faces[i])))
        best[i] = d2[i], faces[i] = face;
  }
}

// Rounding to single precision keeps the order, so no face is missed.
HWY_INLINE std::uint32_t in_column(const ClosestBoxes& boxes, const Floats* p, bool up) {
  const auto holds = [&](std::size_t c) HWY_ATTR {
    return (wide_load<Floats>(boxes.low[c]) <= p[c]) & (p[c] <= wide_load<Floats>(boxes.high[c]));
  };
  const auto ahead = up ? p[2] <= wide_load<Floats>(boxes.high[2]) : wide_load<Floats>(boxes.low[2]) <= p[2];
  return bits(holds(0) & holds(1) & ahead);
}

void Column(const ClosestTree& tree, const Vec3& point, bool up, std::vector<std::uint32_t>& faces) {
  const auto local = tree.local(point);
  const Floats p[3] = {wide_set<Floats>(local[0]), wide_set<Floats>(local[1]), wide_set<Floats>(local[2])};
  std::int32_t stack[closest_stack];
  std::size_t count = 0;
  stack[count++] = 0;
  while (count) {
    const std::int32_t at = stack[--count];
    if (at >= 0) {
      const ClosestNode& node = tree.nodes[std::size_t(at)];
      for (std::uint32_t which = in_column(node.boxes, p, up); which; which &= which - 1)
        stack[count++] = node.child[std::countr_zero(which)];
    } else {
      const auto leaf = std::size_t(~at);
      for (std::uint32_t which = in_column(tree.leaves[leaf].boxes, p, up); which; which &= which - 1)
        faces.push_back(tree.face_of_slot[leaf * packet + std::size_t(std::countr_zero(which))]);
    }
  }
}

} // namespace cowgpu::plan::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cowgpu::plan {

HWY_EXPORT(Packet);
HWY_EXPORT(Single);
HWY_EXPORT(Decide);
HWY_EXPORT(Column);

void closest_packet(const ClosestTree& tree, const Vec3* points, std::size_t count, WarmSlots& warm,
                    std::uint32_t* faces) {
  HWY_DYNAMIC_DISPATCH(Packet)(tree, points, count, warm, faces);
}

std::uint32_t closest_single(const ClosestTree& tree, const Vec3& point, double below, std::uint32_t warm_slot) {
  return HWY_DYNAMIC_DISPATCH(Single)(tree, point, below, warm_slot);
}

void closest_of(const ClosestTree& tree, const Vec3* points, std::size_t count, std::span<const std::uint32_t> slots,
                std::span<const std::uint32_t> masks, std::uint32_t* faces) {
  HWY_DYNAMIC_DISPATCH(Decide)(tree, points, count, slots, masks, faces);
}

void column_faces(const ClosestTree& tree, const Vec3& point, bool up, std::vector<std::uint32_t>& faces) {
  HWY_DYNAMIC_DISPATCH(Column)(tree, point, up, faces);
}

} // namespace cowgpu::plan
#endif // HWY_ONCE

// The SIMD kernels of the CPU path of `closest`, compiled once per instruction set.
#pragma once

#include "host/plan/closest_tree.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace cowgpu::plan {

inline constexpr std::size_t packet = closest_width;

/// Slots of the tree whose triangles bound the next answers: the last ones.
struct WarmSlots {
  static constexpr std::size_t most = 6;
  std::uint32_t slot[most];
  std::size_t count = 0;
};

/// The closest faces of up to a packet of points, which are faster near each other. All must be within
/// closest_far of the tree's middle. Where several faces are equally near in double precision, the least.
void closest_packet(const ClosestTree& tree, const Vec3* points, std::size_t count, WarmSlots& warm,
                    std::uint32_t* faces);

/// The closest face of one point, anywhere: the same face as in a packet. Only faces nearer than `below` are looked for;
/// no_face if there is none. `warm_slot`: a slot that may hold a near face, or no_face.
std::uint32_t closest_single(const ClosestTree& tree, const Vec3& point, double below, std::uint32_t warm_slot);

/// Of up to four points the closest faces among candidates: `slots`, each with a mask of the points it is one for.
/// Every point must have one; where several are equally near in double precision, the least face.
inline constexpr std::size_t most_decided = 4;
void closest_of(const ClosestTree& tree, const Vec3* points, std::size_t count, std::span<const std::uint32_t> slots,
                std::span<const std::uint32_t> masks, std::uint32_t* faces);

/// Appends the faces whose boxes meet the half line from the point along +z (`up`) or -z, perhaps a few more.
void column_faces(const ClosestTree& tree, const Vec3& point, bool up, std::vector<std::uint32_t>& faces);

} // namespace cowgpu::plan

// Greedy matching of triangles that share an edge.
#pragma once

#include "host/types.hpp"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace cowgpu::plan {

inline constexpr std::uint32_t unpaired = 0xffffffff;

/// Pairs of faces that share two vertices, each face in exactly one pair; second = `unpaired` where no neighbour was
/// left. Faces with the fewest free neighbours are matched first (Karp and Sipser 1981), which leaves under one per cent
/// of a closed mesh alone. Deterministic; faces with a repeated vertex stay alone,
/// and faces over the same three vertices are never paired. Indices must be below `vertices`.
std::vector<std::pair<std::uint32_t, std::uint32_t>> pair_faces(std::span<const Face> faces, std::size_t vertices);

} // namespace cowgpu::plan

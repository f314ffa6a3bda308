// The CPU path of the verb `closest` (host/distance_field.hpp), and single queries for work that goes from point to point.
#pragma once

#include "host/distance_field.hpp"
#include "host/plan/closest_tree.hpp"

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace cowgpu::cpu {

/// On `threads` threads (0: all). Throws what check_distance_surface throws.
std::unique_ptr<DistanceField> distance_field(std::span<const Vec3> vertices, std::span<const Face> faces,
                                              unsigned threads);

/// Bytes of the field and of one call of so many queries, their result included.
std::uint64_t distance_field_bytes(std::uint64_t vertices, std::uint64_t faces, std::uint64_t queries);

/// The closest point of the surface, the same as in a batch, if it is nearer than `below`. `warm_face`: a face that may be
/// near, as the last answer's where queries move little; it saves time and changes nothing. The query must be finite.
/// Safe from several threads.
std::optional<SurfacePoint> closest_point(const plan::ClosestTree& tree, const Vec3& query,
                                          double below = std::numeric_limits<double>::infinity(),
                                          std::uint32_t warm_face = no_face);

/// How often the surface, which must be closed, winds about a point; exact (host/distance_field.hpp).
int winding_number(const plan::ClosestTree& tree, const Vec3& query);

/// The order of points along a Morton curve of 2^10 cells a side through [low, high]; points outside count as on its sides.
/// Points of one cell keep their order.
std::vector<std::uint32_t> morton_order(std::span<const Vec3> points, const Vec3& low, const Vec3& high,
                                        unsigned threads);

} // namespace cowgpu::cpu

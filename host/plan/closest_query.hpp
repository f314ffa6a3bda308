// Single queries of closest points and winding numbers, for work that goes from point to point.
#pragma once

#include "host/distance_field.hpp"
#include "host/plan/closest_tree.hpp"

#include <cstdint>
#include <limits>
#include <optional>

namespace cowgpu::plan {

/// The closest point of the surface, the same as in a batch, if it is nearer than `below`. `warm_face`: a face that may be
/// near, as the last answer's where queries move little; it saves time and changes nothing. The query must be finite.
/// Safe from several threads.
std::optional<SurfacePoint> closest_point(const ClosestTree& tree, const Vec3& query,
                                          double below = std::numeric_limits<double>::infinity(),
                                          std::uint32_t warm_face = no_face);

/// How often the surface, which must be closed, winds about a point; exact (host/distance_field.hpp).
int winding_number(const ClosestTree& tree, const Vec3& query);

} // namespace cowgpu::plan

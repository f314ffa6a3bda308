// The flow of the distance's gradient by steps of one length, as the paper's recipe has it.
#pragma once

#include "host/backend.hpp"

#include <span>
#include <vector>

namespace cowgpu {

/// Where the starts come in `steps` equal steps of the classical Runge-Kutta method of fourth order for dx/dt = (x - q)/|x - q|,
/// q the closest surface point: away from the surface on either side of it. The first slope of starts on the surface is
/// their normal (unit length; for others zero). All points step together: four closest points a step and point. Off the medial axis the
/// rays are met exactly; on it the gradient jumps and the method is of first order (host/flow.hpp goes by events). Throws
/// Error(bad_argument) for sizes that differ, a time below 0 or no step, and what DistanceField throws.
std::vector<Vec3> flow_fixed_steps(DistanceField& field, std::span<const Vec3> starts, std::span<const Vec3> normals,
                                   double time, int steps, Monitor& monitor);

} // namespace cowgpu

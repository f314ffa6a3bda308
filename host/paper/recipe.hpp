// Settings that come nearest to the tables of "Higher multipoles of the cow", which does not say all of its own.
#pragma once

#include "host/map/harmonic.hpp"

namespace cowgpu::paper {

/// Of the harmonic map: cotangent weights, the back as pole, scale 10, nothing centred, polished or rotated.
HarmonicOptions harmonic_map();

/// Of the flow along the distance's gradient: time and length of a step, in the benchmark's length unit.
inline constexpr double flow_time = 0.2, flow_step = 0.05;

} // namespace cowgpu::paper

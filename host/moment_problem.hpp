// The input of the verb `moments`.
#pragma once

#include "host/types.hpp"

#include <span>

namespace cowgpu {

/// Default of MomentProblem::cut_off: what is left out is bounded by a tenth of a double's rounding unit.
inline constexpr double default_cut_off = 1e-17;

/// Largest degree the recursions are proven free of overflow for.
inline constexpr int largest_degree = 4096;

/// Input of the verb `moments`.
struct MomentProblem {
  std::span<const Vec3> vertices;   ///< mesh coordinates
  std::span<const Face> faces;      ///< the surface's faces, or any part of them (moments add)
  Vec3 origin = Vec3::Zero();       ///< mesh coordinates
  double reference_radius = 1;      ///< R > 0, at least the distance of every vertex used from `origin`
  double density = 1;               ///< mass per cubed length unit
  int lmax = 0;                     ///< 0 ... largest_degree
  double cut_off = default_cut_off; ///< allowed error per degree, relative to degree_bound(); 0: leave out only what
                                    ///< would underflow
};

} // namespace cowgpu

// How a tolerance is met by the fast sum, and when the fast sum pays.
#pragma once

#include "host/polyhedron.hpp"

#include <cstdint>

namespace cowgpu::plan {

enum class NearDigits { full, nine, single }; ///< of closed forms: to rounding, to 2e-11, in single precision

/// Of tolerances least_polyhedron_tolerance ... largest_polyhedron_tolerance.
struct FastSettings {
  int order;       ///< of multipoles
  double tau;      ///< PairTolerance::tau over v/R^2
  NearDigits near; ///< for second derivatives never in single precision
};
/// The highest order chosen.
inline constexpr int largest_fast_order = 28;
FastSettings fast_settings(const PolyhedronProblem& problem);

inline constexpr std::uint32_t largest_tree_leaf = 64;
/// Points whose locals are held together by one thread.
inline constexpr std::uint32_t task_points = 8192;

/// Whether the fast sum takes less time than the direct one.
bool fast_sum_pays(const PolyhedronProblem& problem, std::uint64_t points);

} // namespace cowgpu::plan

// The CPU path of the verb `potential`: vectors of points run the recursion and sum all sets at once.
#pragma once

#include "host/plan/potential.hpp"
#include "host/potential.hpp"

#include <memory>

namespace cowgpu::cpu {

/// On `threads` threads (0: all).
std::unique_ptr<ExteriorPotential> exterior_potential(const PotentialProblem& problem, unsigned threads);

/// Points that sum_potential() takes at once.
inline constexpr std::size_t potential_group = 8;

/// The sums of every set at the points first ... first + 7 (a multiple of 8), to degree `top`: sums[set * padded + point].
void sum_potential(const plan::PotentialSeries& series, const plan::PotentialPoints& points, std::size_t first, int top,
                   double* sums);

} // namespace cowgpu::cpu

// The multipole moments of a body's mass.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/body.hpp"

#include <span>
#include <vector>

namespace cowgpu {

/// The problems of a body's mass moments: that of its surface, then those of its parts, all about the body's origin and
/// with its Brillouin radius. They refer to the body.
std::vector<MomentProblem> mass_problems(const Body& body, int lmax, double cut_off);

/// The sum of the problems' moments, each of those far from its origin by way of near_problem() (host/mass/translate.hpp);
/// `report` sums up what the backend reports, `norms` holds the norm of each degree of what it computed for each problem.
Multipoles mass_moments(std::span<const MomentProblem> problems, Backend& backend, Monitor& monitor,
                        RunReport* report = nullptr, std::vector<std::vector<double>>* norms = nullptr);

} // namespace cowgpu

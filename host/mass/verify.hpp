// Checks a backend's moments against a second path, and says how well they are known.
#pragma once

#include "host/backend.hpp"
#include "host/mass/compare.hpp"
#include "host/mass/error_estimate.hpp"
#include "host/mass/mass_moments.hpp"
#include "host/mesh/body.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace cowgpu {

enum class Verify { none, sample, full };

/// One path against another.
struct Agreement {
  std::string path, against;
  DegreeErrors errors;
};

/// Outcome of a check: every pair of paths on the same triangles, at all degrees, and what is known of the whole.
struct Accuracy {
  /// Paths that agree to so many times the estimated error agree.
  static constexpr double bound = 2;

  Verify how = Verify::none;
  std::uint64_t triangles = 0;
  std::uint64_t seed = 0; ///< seed of the sample
  std::vector<Agreement> agreements;
  ErrorEstimate estimate; ///< estimate for all triangles; empty if nothing was computed

  /// The agreement with the largest ratio; null if nothing was compared. What is not a number counts as largest.
  const Agreement* worst() const;
  bool passed() const; ///< something was compared, and every ratio is within the bound; NaN fails
};

/// Degrees 0 and 2 of `q` against the body's mass and Cartesian quadrupole tensor, which share no code with any path:
/// Q_00 = M/sqrt(4 pi), Q_20 = sqrt(5/pi)/4 T_zz, Q_21 = -sqrt(5/24pi) (T_xz + i T_yz), Q_22 = sqrt(5/96pi) (T_xx - T_yy +
/// 2i T_xy), T = integral of density (3 x x - r^2). `estimate` is E_l of `q`.
Agreement compare_with_tensors(const Body& body, const Multipoles& q, std::span<const double> estimate);

/// Bound of the host bytes verify_moments() allocates beside what the backend needs for the same triangles.
std::uint64_t verify_bytes(const MomentProblem& problem, Verify how);

/// E_l of one problem's moments, given what the estimate takes of it or, where there is one, of its near_problem().
std::vector<double> problem_error(const MomentProblem& problem, const RoundingTerms& rounding);

/// Re-does the moments on a seeded sample of 128 triangles (Verify::sample; all if there are no more) or on all of them, on
/// `backend` and by the second recursion of host/moment_terms.hpp, and compares them with the estimated error of the sample's
/// moments. Where `rounding` is not null it gets what the estimate takes of all triangles, but for the
/// norms. Throws what the backends throw.
Accuracy verify_moments(const MomentProblem& problem, Backend& backend, Verify how, std::uint64_t seed,
                        Monitor& monitor, RoundingTerms* rounding = nullptr);

/// verify_moments() of each problem or its near_problem(), and the estimate for `mass`, the sum of their moments, of which
/// mass_moments() gave the `norms`: triangles are counted over all, agreements are the worst of each pair of paths.
Accuracy verify_all(std::span<const MomentProblem> problems, const Multipoles& mass,
                    std::span<const std::vector<double>> norms, Backend& backend, Verify how, std::uint64_t seed,
                    Monitor& monitor);

} // namespace cowgpu

// Checks a backend's moments against a second path.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/body.hpp"
#include "host/spectrum/compare.hpp"

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

/// Outcome of a check: every pair of paths on the same triangles, at all degrees.
struct Accuracy {
  Verify how = Verify::none;
  std::uint64_t triangles = 0;
  std::uint64_t seed = 0; ///< of the sample
  double bound = 0;       ///< what the paths must agree to, expected_error()
  std::vector<Agreement> agreements;

  /// The agreement with the largest weighed error; null if nothing was compared. What is not a number counts as largest.
  const Agreement* worst() const;
  bool passed() const; ///< something was compared, and every weighed error is within the bound; NaN fails
};

/// The problems of a body's mass moments: that of its surface, then those of its parts, all about the body's origin and
/// with its Brillouin radius. They refer to the body.
std::vector<MomentProblem> mass_problems(const Body& body, int lmax, double cut_off);

/// B_l of plan::degree_bound(), summed over the problems.
std::vector<double> degree_bound(std::span<const MomentProblem> problems);

/// The sum of the problems' moments; `report` sums up what the backend reports.
Coefficients mass_moments(std::span<const MomentProblem> problems, Backend& backend, Monitor& monitor,
                          RunReport* report = nullptr);

/// Degrees 0 and 2 of `q` against the body's mass and Cartesian quadrupole tensor, which share no code with any path:
/// Q_00 = M/sqrt(4 pi), Q_20 = sqrt(5/pi)/4 T_zz, Q_21 = -sqrt(5/24pi) (T_xz + i T_yz), Q_22 = sqrt(5/96pi) (T_xx - T_yy +
/// 2i T_xy), T = integral of density (3 x x - r^2).
Agreement compare_with_tensors(const Body& body, const Coefficients& q);

/// Bound of the host bytes verify_moments() allocates beside what the backend needs for the same triangles.
std::uint64_t verify_bytes(const MomentProblem& problem, const Backend& backend, Verify how);

/// Re-does the moments on a seeded sample of 256 triangles (Verify::sample; all if there are no more) or on all of them,
/// on `backend` and on the second path: the CPU path for a Vulkan backend, the plain reference in extended precision
/// for the CPU path. Throws what the backends throw.
Accuracy verify_moments(const MomentProblem& problem, Backend& backend, Verify how, std::uint64_t seed,
                        Monitor& monitor);

/// verify_moments() of each problem: triangles are counted over all, agreements are the worst of each pair of paths.
Accuracy verify_all(std::span<const MomentProblem> problems, Backend& backend, Verify how, std::uint64_t seed,
                    Monitor& monitor);

} // namespace cowgpu

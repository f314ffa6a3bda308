// The verb `potential`: the field of a body outside it, by its moments.
#pragma once

#include "host/memory_need.hpp"
#include "host/monitor.hpp"
#include "host/multipoles.hpp"
#include "host/run_report.hpp"
#include "host/types.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu {

/// Up to here no order that counts underflows, at any place outside (host/plan/potential.hpp).
inline constexpr int largest_potential_degree = 1536;

/// Of PotentialProblem::cut_off: an eighth of a double's rounding unit.
inline constexpr double default_potential_cut_off = 0x1p-56;

/// In R: a point on the sphere that rounding has moved inside is outside.
inline constexpr double nearest_potential = 1 - 1e-9;

/// What is asked for: V alone, its gradient too, its second derivatives too.
enum class Derivatives { none = 0, first = 1, second = 2 };

/// What is asked for of V(x) = integral of density(y) / |x - y| outside a body, by its moments.
struct PotentialProblem {
  const Multipoles& moments;
  int lmax = 0; ///< 0 ... min(moments.lmax, largest_potential_degree)
  Derivatives derivatives = Derivatives::second;
  /// The degrees left out far away add up to at most so much of the bound of all of them; 0: leave out none.
  double cut_off = default_potential_cut_off;
};

/// xx, xy, xz, yy, yz, zz.
using SymmetricTensor = std::array<double, 6>;

/// V in mass over length, its gradient over its square, its second derivatives over its cube; one entry a point, in their
/// order; empty where not asked for.
struct PotentialField {
  std::vector<double> value;
  std::vector<Vec3> gradient;
  std::vector<SymmetricTensor> hessian;
};

/// The field of a PotentialProblem, whose moments must outlive it: the mathematics stands in host/plan/potential.hpp.
class ExteriorPotential {
public:
  virtual ~ExteriorPotential() = default;

  /// Upper bound of what at() allocates for so many points, its result included.
  virtual MemoryNeed memory(std::uint64_t points) const = 0;

  /// At points seen from the moments' origin, in their length unit, no nearer to it than R (to 1e-9). Throws
  /// Error(point_inside) for a nearer one, bad_argument, too_large, device_failed, device_lost, interrupted. The same points on
  /// the same device give the same bits. Of the report, seconds, setup_seconds, elements, full_elements and kernels are set.
  virtual PotentialField at(std::span<const Vec3> points, Monitor& monitor, RunReport* report = nullptr) const = 0;
};

} // namespace cowgpu

// What a body's gravity or electric field is outside it, and how well its first multipoles know it.
#pragma once

#include "host/backend.hpp"
#include "host/coefficient_set.hpp"
#include "host/mesh/body.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu::physics {

/// 1/(4 pi epsilon_0) in N m^2/C^2, CODATA 2018.
inline constexpr double coulomb_constant_si = 8.9875517923e9;

/// Multipoles of a file, of degrees 0 ... min(lmax, set.lmax), as moments: about their own origin, with their own reference
/// radius. Throws Error(file_format) for coefficients of a surface and where no reference radius is stated; what converted()
/// throws.
Coefficients mass_moments(const CoefficientSet& set, int lmax);

/// Moments whose unit of length is so many metres, and whose unit of mass so many kilograms, in SI.
Coefficients in_si(Coefficients moments, double metres, double kilograms);

/// From V = integral of density/|x - y| to what it stands for, per unit of a test body. Gravity: potential -G V, acceleration
/// G grad V, its gradient G dd V. Charges: potential k V, field -k grad V, its gradient -k dd V.
struct FieldLaw {
  double constant = 1; ///< G or k
  bool charge = false;
  double potential(double value) const { return (charge ? constant : -constant) * value; }
  Vec3 force(const Vec3& gradient) const { return (charge ? -constant : constant) * gradient; }
  SymmetricTensor tensor(const SymmetricTensor& hessian) const {
    SymmetricTensor t = hessian;
    for (double& component : t) component *= charge ? -constant : constant;
    return t;
  }
};

/// Errors of the series to one order at one distance, over a sphere.
struct SeriesError {
  double distance = 1; ///< from the body's origin, in its Brillouin radii
  int order = 0;
  double potential_max = 0, potential_rms = 0;       ///< |V_L - V| / |V|
  double acceleration_max = 0, acceleration_rms = 0; ///< |g_L - g| / |g|
};

/// Where an order begins to be good.
struct GoodFrom {
  int order = 0;
  /// Brillouin radii; from there on outwards potential and acceleration are right to the tolerance everywhere. Empty where
  /// that is beyond farthest_good.
  std::array<std::optional<double>, 3> distance;
};
inline constexpr std::array good_tolerances = {1e-3, 1e-6, 1e-9};
inline constexpr double farthest_good = 1e6;

struct SeriesErrors {
  std::vector<SeriesError> rows; ///< distance by distance, order by order
  std::vector<GoodFrom> good_from;
  std::vector<double> ladder;             ///< distances that good_from was measured at
  std::vector<std::vector<double>> worst; ///< [order][of the ladder]: the larger of both largest errors
  std::size_t directions = 0;             ///< of the sphere
  int truth_degree = 0;                   ///< beyond `truth_from` radii the truth is the series to this degree,
  double truth_from = 0;
  double truth_error = 0; ///< which there differs so much from the polyhedron
};

/// Series to the `orders` against the exact polyhedron at `distances` (1 or more), on the points of a Gauss-Legendre grid; rms
/// with its weights. `good_from` is measured at 16 distances a decade, and in between by a power law. Throws
/// Error(bad_argument), interrupted, and what the backend throws.
SeriesErrors series_errors(const Body& body, const std::vector<int>& orders, const std::vector<double>& distances,
                           Backend& backend, unsigned threads, Monitor& monitor);

} // namespace cowgpu::physics

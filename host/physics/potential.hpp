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

/// Multipoles of a file, of degrees 0 ... min(lmax, set.lmax), as moments about their own origin, over the radius of the
/// sphere that holds the body, or where the file does not say that one over its reference radius. Throws Error(file_format) for coefficients of a surface and where no reference radius is stated; what converted()
/// throws.
Multipoles mass_moments(const CoefficientSet& set, int lmax);

/// The same moments over another reference radius; what is too small for a double becomes 0. Throws Error(bad_argument) for a
/// radius that is not above 0 and finite, and one so small that a moment exceeds doubles.
Multipoles over_radius(Multipoles moments, double radius);

/// How large the terms of each degree of V are where r = `radius`: their root mean square over that sphere, in units of
/// V = 1/r of the moments' mass unit, [l] for l = 0 ... moments.lmax.
std::vector<double> degree_sizes(const Multipoles& moments, double radius);

/// Where r = `radius` the largest term of the degrees above lmax/2 over the largest of those below, by degree_sizes(): above 1
/// the series to degree lmax does not converge there.
double term_growth(const Multipoles& moments, int lmax, double radius);

/// Moments whose unit of length is so many metres, and whose unit of mass so many kilograms, in SI.
Multipoles in_si(Multipoles moments, double metres, double kilograms);

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
  std::size_t directions = 0;             ///< directions of the grid for root mean squares
  int truth_degree = 0;                   ///< from `truth_from` radii on the truth is the series to this degree,
  double truth_from = 0;
  double truth_error = 0; ///< which there differs so much from the polyhedron
};

/// What the series to the `orders` leave out at `distances` (1 or more): of the exact polyhedron next to the sphere, farther out
/// of the series to truth_degree. Rounding, about 1e-15, is not in it.
///
/// The largest errors are searched: on a grid of 6 points a wave of the highest degree that counts, at the ends of the axes,
/// over the vertices that are farthest out, and from the best of these uphill to local maxima. Root mean squares are over a
/// Gauss-Legendre grid. `good_from` is measured at 16 distances a decade and between two of them by secants, whose last
/// distance is one where the tolerance holds. Where V or its gradient vanishes relative errors have no bound. Throws
/// Error(bad_argument), interrupted, and what the backend throws.
SeriesErrors series_errors(const Body& body, const std::vector<int>& orders, const std::vector<double>& distances,
                           Backend& backend, unsigned threads, Monitor& monitor);

} // namespace cowgpu::physics

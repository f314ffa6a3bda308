// Grids on the sphere whose sums integrate exactly.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace cowgpu {

/// Where the rings of a grid lie.
enum class GridKind {
  gauss_legendre,        ///< "gl": zeros of P_n, n = lmax + 1 rings
  clenshaw_curtis,       ///< "cc": theta_i = pi i / (n - 1), both poles included, n = 2 lmax + 1 rings, at least 2
  driscoll_healy,        ///< "dh": theta_i = pi i / n, n = 2 lmax + 2 rings of 2 n points; the pole's ring has weight 0
  driscoll_healy_square, ///< "dh1": the same rings of n points
  fejer, ///< "f1": Fejer's first rule, cell-centred: theta_i = pi (i + 1/2) / n, n = 2 lmax + 2 rings of 2 n points, no pole
};

/// "gl", "cc", "dh", "dh1", "f1".
std::string_view name(GridKind kind);

/// Rings of equally spaced points. Ring i lies at colatitude theta_i, from north to south; its points at longitudes
/// phi_j = 2 pi (j + shift) / ring_length. For polynomials f of degree at most 2 lmax on the sphere
///   integral of f over the sphere = sum_i weight_i (2 pi / ring_length) sum_j f(theta_i, phi_j).
/// Values on a grid are held as [ring][longitude].
struct SphereGrid {
  GridKind kind = GridKind::gauss_legendre;
  int lmax = 0;        ///< largest degree whose coefficients the grid gives back exactly
  int rings = 1;       ///< n
  int ring_length = 1; ///< points a ring
  /// Of the first point of each ring from longitude 0, in steps between points, 0 <= shift < 1: 1/2 for f1 as make_grid() makes
  /// it, where points are the centres of cells; 0 for the others. Files may have another (host/io/grid_file.hpp).
  double shift = 0;
  /// cos and sin of theta_i, to the last bit of the type: powers sin^m theta amplify its rounding.
  std::vector<long double> cosine, sine;
  std::vector<double> theta;   ///< radians
  std::vector<double> weights; ///< weight_i; they add up to 2

  std::size_t points() const { return std::size_t(rings) * std::size_t(ring_length); }
  double phi(int j) const;               ///< radians
  double latitude_degrees(int i) const;  ///< 90 - theta_i in degrees
  double longitude_degrees(int j) const; ///< 360 (j + shift) / ring_length
};

/// Largest lmax of a grid.
inline constexpr int largest_grid_degree = 8192;

/// The smallest grid of its kind for degree lmax, 0 <= lmax <= largest_grid_degree. For gl and cc the ring length is the
/// smallest product of 2, 3 and 5 that is at least 2 lmax + 1 (lmax 0: 1). Gauss-Legendre nodes by Newton's iteration in
/// extended precision; Clenshaw-Curtis and Fejer weights: Waldvogel, BIT 46 (2006) 195; Driscoll-Healy weights: Driscoll and
/// Healy, Adv. Appl. Math. 15 (1994) 202. Throws Error(bad_argument).
SphereGrid make_grid(GridKind kind, int lmax);

/// The grid of this kind with so many rings and points a ring, as found in a file; lmax is the largest degree for which
/// both are enough. Throws Error(bad_argument) for a shape no grid of the kind has: dh and dh1 have an even number of
/// rings of twice and once as many points, cc has both poles. f1 of any number of rings n is exact to degree (n - 1) / 2.
SphereGrid make_grid(GridKind kind, int rings, int ring_length);

} // namespace cowgpu

// Values and derivatives of fields at any directions, from their spherical-harmonic coefficients.
#pragma once

#include "host/monitor.hpp"
#include "host/plan/legendre.hpp"
#include "host/spectrum/polar_cap.hpp"
#include "host/sphere_coefficients.hpp"
#include "host/types.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace cowgpu {

/// A place on the sphere.
struct Direction {
  long double cosine = 1, sine = 0;  ///< cosine and sine of theta, to the last bits: sin^m theta amplifies rounding
  double phi = 0, phi_remainder = 0; ///< longitude as the sum of both, radians: m phi amplifies rounding too
};

/// From angles in radians; any real theta (theta < 0 is the place at -theta and phi + pi). Throws Error(bad_argument) for
/// NaN and for angles beyond 1e6.
Direction direction(double theta, double phi);
/// Where `r` points to, of any length but 0. Throws Error(bad_argument) for 0 and for what is not finite.
Direction direction(const Vec3& r);

/// Of each field at each direction, [field][direction].
struct DirectionValues {
  std::vector<double> values;
  std::vector<double> d_theta, d_phi; ///< empty unless asked for
};

/// Sums f(theta, phi) = sum a_lm Y_lm for directions side by side in SIMD lanes, all fields sharing the recursion of
/// host/plan/legendre.hpp. Start values below the range of doubles carry an exponent of their own, and what stays below
/// 1e-19 over a whole order m is left out, so that polar directions take less time. Next to the poles
/// host/spectrum/polar_cap.hpp takes over. On a pole only m = 0 counts, d_phi is 0 and d_theta is the derivative along
/// the meridian phi (the fields X and Y of host/spectrum/derivatives.hpp: no division by sin theta).
///
/// Against 80-bit arithmetic values are within 1e-14 sqrt(lmax) of the field's root mean square, within 16 / lmax of the
/// equator 1e-12 at degree 1024 and 5e-12 at 4096; derivatives within lmax times that. What comes out at a direction does
/// not depend on the other directions nor on the number of threads.
///
/// Time per direction O(lmax^2); d_theta counts as two fields more. Memory O(lmax^2): 12 (lmax + 17)^2 bytes, and
/// 8 (lmax + 17)^2 + 1072 (lmax + 1) for each field, three times that with derivatives.
class DirectionSynthesis {
public:
  /// Copies what it needs. `threads` 0: all. Throws Error(bad_argument) unless 0 <= lmax <= largest_grid_degree.
  explicit DirectionSynthesis(const SphereCoefficients& coefficients, bool derivatives = false, unsigned threads = 0);

  /// Throws Error(interrupted).
  DirectionValues at(std::span<const Direction> directions, Monitor& monitor) const;

private:
  struct Block;
  void evaluate(Block& block, std::span<const Direction> directions, DirectionValues& result) const;
  void evaluate_polar(std::size_t index, std::span<const Direction> directions, DirectionValues& result) const;

  plan::Legendre plan_;
  PolarCap cap_;
  std::vector<double> steps_; ///< [m][field][k][4]: what plan::prepare_synthesis() makes
  int fields_ = 1;            ///< those asked for
  int summed_ = 1;            ///< with X and Y after them
  bool derivatives_ = false;
  unsigned threads_ = 0;
};

} // namespace cowgpu

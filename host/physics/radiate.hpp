// Gravitational waves from a rigid body that turns about an axis: power, and how the spin decays.
//
// K. S. Thorne, Multipole expansions of gravitational radiation, Rev. Mod. Phys. 52, 299 (1980), eq. 4.16; in symmetric
// trace-free tensors (L. Blanchet, Living Rev. Relativity 17, 2 (2014), eq. 67), I_ij = Q_ij / 3:
//   P = G/c^5 [ I'''_ij I'''_ij / 5 + ( I''''_ijk I''''_ijk / 189 + 16 J'''_ij J'''_ij / 45 ) / c^2 ]
// For uniform rotation every one of these squares is constant in time; no average is taken.
#pragma once

#include "host/mesh/tensors.hpp"
#include "host/types.hpp"

#include <Eigen/Core>

#include <array>
#include <complex>
#include <string>

namespace cowgpu::physics {

inline constexpr double speed_of_light_si = 299792458;

/// Q'''_ij Q'''_ij / omega^6 of a tensor Q_ij that turns about `axis` (any length but 0), in its unit squared: with
/// P = 1 - a a^T, T = P Q P - P tr(P Q)/2 and v = P Q a it is 64 T_ij T_ij + 2 v_i v_i. Throws Error(bad_argument) for an
/// axis that is no direction.
double quadrupole_square(const Eigen::Matrix3d& quadrupole, const Vec3& axis);

/// The same from Q_20, Q_21, Q_22: they are turned until the axis is z, and the square is 24 pi/5 sum_m m^6 |Q_2m|^2.
double quadrupole_square(const std::array<std::complex<double>, 3>& q, const Vec3& axis);

/// I''''_ijk I''''_ijk / omega^8, I_ijk the trace-free part of the third moment about the centre of mass.
double octupole_square(const Tensor3& third_moment, const Vec3& axis);

/// J'''_ij J'''_ij / omega^8, J_ij the trace-free symmetric part of the integral of density x_i (x cross v)_j with
/// v = omega cross x.
double current_quadrupole_square(const Tensor3& third_moment, const Vec3& axis);

/// Powers in watts of squares in (kg m^2)^2 and (kg m^3)^2, omega in rad/s: G/(45 c^5) square omega^6, and G/(189 c^7) and
/// 16 G/(45 c^7) square omega^8. In extended precision, whose range they need.
long double quadrupole_power(double square, double omega);
long double octupole_power(double square, double omega);
long double current_quadrupole_power(double square, double omega);

/// The spin of a body that loses its energy E = I omega^2 / 2 at P ~ omega^6: d omega/dt = -omega/(2 tau), tau = E/P at the
/// start, so omega = omega_0 (1 + 2 t/tau)^(-1/4).
struct SpinDown {
  long double energy = 0;    ///< J, at the start
  long double timescale = 0; ///< tau in s; infinite where nothing is radiated
  long double deficit = 0;   ///< 1 - omega/omega_0, right to 16 digits however small
  std::string omega;         ///< in rad/s, a decimal number to the fifteenth digit of the deficit
};

/// Moment of inertia in kg m^2, power in W at omega in rad/s, time in s. Throws Error(bad_argument) for a moment or omega
/// that is not above 0, a negative time, or values that are not finite.
SpinDown spin_down(double moment_of_inertia, long double power, double omega, double time);

/// a - b for decimal numbers without sign and exponent, a >= b, exact: "1" - "0.001" = "0.999".
std::string decimal_difference(const std::string& a, const std::string& b);

/// `value` >= 0 to so many significant digits, without exponent and without zeros at the end.
std::string plain_decimal(long double value, int significant);

/// The same with the fewest digits that read back as the same double.
std::string plain_decimal(double value);

} // namespace cowgpu::physics

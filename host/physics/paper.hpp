// Numbers that the paper "Higher multipoles of the cow" prints about its benchmark body: density 1, the mesh's unit, about the
// centre of mass, x forward, y up, z to the right.
#pragma once

#include <array>

namespace cowgpu::physics::paper {

/// xx, xy, xz, yy, yz, zz.
inline constexpr std::array quadrupole = {4.23004e-3, 0.83531e-3, 0.00704e-3, -1.64753e-3, 0.00039e-3, -2.58252e-3};
inline constexpr std::array inertia = {7.95079e-4, -2.78437e-4, -0.02348e-4, 27.5426e-4, -0.00130e-4, 30.6593e-4};

inline constexpr double volume = 0.054;
inline constexpr double q00 = 0.0152, q20 = -0.0008, q22_re = 0.0008, q22_im = -0.0002; // values of conj Q_lm

inline constexpr double length = 2.5, box_length = 1.044; ///< length of the average cow in m, and of the mesh
inline constexpr double length_unit_m = 2.39, mass_unit_kg = 13652, mass_kg = 740;
inline constexpr double square = 0.00149; ///< Q'''_ij Q'''_ij / omega^6 about y
inline constexpr double square_si = 9e12; ///< the same in (kg m^2)^2, as printed
inline constexpr double power_erg_per_s = 5.5e-41;
inline constexpr double timescale_s = 1.9e49;
inline constexpr double deficit = 1.1432e-32; ///< 1 - omega_now, of 0.999999999999999999999999999999988568
inline constexpr const char* omega_now = "0.999999999999999999999999999999988568";

inline constexpr double sustained_force_N = 500; ///< that a human can keep up
inline constexpr double punch_N = 5000;          ///< punch of an elite boxer

/// As set for the paper's numbers.
inline constexpr const char* mesh = "benchmark";
inline constexpr const char* length_unit = "2.39m";
inline constexpr const char* density = "1g/cm3";

} // namespace cowgpu::physics::paper

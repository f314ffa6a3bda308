#include "host/report/beside_paper.hpp"

#include "host/physics/paper.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace cowgpu {

using namespace physics;

std::vector<Comparison> beside_paper(const TensorsResult& found) {
  const RigidBody& body = found.body;
  const double unit = body.units.kilogram * body.units.metre * body.units.metre;
  const Eigen::Matrix3d q = body.quadrupole / unit, inertia = body.inertia() / unit;
  const double mass = body.mass / body.units.kilogram;
  const std::string sampled = "the paper sampled the interior coarsely; its own tensors agree with each other";
  const std::string noise = "nothing but noise in the paper: the cow is alike on both sides";
  std::vector<Comparison> rows = {
      {"volume", mass, paper::volume, "0.05348 rounds to 0.053"},
      {"Q_00", mass / std::sqrt(4 * std::numbers::pi), paper::q00, "0.0151: the volume's error"}};
  const auto spherical = spherical_quadrupole(q);
  rows.push_back({"Q_20", spherical[0].real(), paper::q20});
  rows.push_back({"Re conj Q_22", spherical[2].real(), paper::q22_re, "0.00075; the paper's own tensor gives 0.00076"});
  rows.push_back({"Im conj Q_22", -spherical[2].imag(), paper::q22_im,
                  "the paper's table has the conjugate of what its text defines"});
  constexpr std::array names = {"xx", "xy", "xz", "yy", "yz", "zz"};
  std::size_t at = 0;
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = i; j < 3; ++j, ++at) {
      const std::string& why = i < 2 && j == 2 ? noise : sampled;
      rows.push_back({fmt::format("quadrupole {}", names[at]), q(i, j), paper::quadrupole[at], why});
    }
  for (Eigen::Index i = 0, k = 0; i < 3; ++i)
    for (Eigen::Index j = i; j < 3; ++j, ++k) {
      const std::string& why = i < 2 && j == 2 ? noise : sampled;
      rows.push_back(
          {fmt::format("inertia {}", names[std::size_t(k)]), inertia(i, j), paper::inertia[std::size_t(k)], why});
    }
  return rows;
}

std::vector<Comparison> beside_paper(const RadiationResult& r) {
  if (!r.spin || !r.longest_side) return {};
  const std::string sampled = "from the paper's tensors, which are up to 2 % off";
  const double square_si = r.square, erg = double(r.power) * 1e7, year = 365 * 86400.0;
  const Units& units = r.body.units;
  const double length_unit = paper::length / (*r.longest_side / units.metre);
  const double unit = units.kilogram * units.metre * units.metre;
  const double rounded = (13.787e9 - 12e6) * year / (2 * paper::timescale_s);
  return {
      {"length unit in m", length_unit, paper::length_unit_m,
       "2.5 m over the mesh's own length, 1.044392, is 2.39374 m, cut to three digits; the power grows like its tenth "
       "power, +1.57 %"},
      {"mass unit in kg", units.kilogram, paper::mass_unit_kg},
      {"volume", r.body.mass / units.kilogram, paper::volume, "0.05348 rounds to 0.053"},
      {"mass in kg", r.body.mass, paper::mass_kg, "of the volume 0.054"},
      {"Q'''^2/omega^6", r.square / (unit * unit), paper::square, sampled},
      {"Q'''^2/omega^6 in kg^2 m^4", square_si, paper::square_si, "9e12 is a misprint for 9e6: see the power"},
      {"power in erg/s", erg, paper::power_erg_per_s, sampled},
      {"factor of sum |Q'''_2m|^2 G/c^5", 8 * std::numbers::pi / 75, 3 / (8 * std::numbers::pi),
       "8 pi/75 goes with Q_2m as the paper defines it; 3/(8 pi) gives 2.807 times too little"},
      {"timescale in s", double(r.spin->timescale), paper::timescale_s, sampled},
      {"1 - omega now", double(r.spin->deficit), paper::deficit,
       "the paper rounds the timescale to 1.9e49 s and takes years of 365 days"},
      {"the same with its rounding", rounded, paper::deficit},
  };
}

} // namespace cowgpu

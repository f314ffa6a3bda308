#include "host/report/beside_paper.hpp"

#include "host/io/mesh_source.hpp"
#include "host/mesh/geometry.hpp"
#include "host/paper/printed.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace cowgpu {

using namespace physics;

std::vector<Comparison> beside_paper(const TensorsResult& found) {
  const RigidBody& body = found.body;
  const double unit = body.units.kilogram * body.units.metre * body.units.metre;
  const Eigen::Matrix3d q = body.quadrupole / unit, inertia = body.inertia() / unit;
  const double mass = body.mass / body.units.kilogram;
  const auto spherical = spherical_quadrupole(q);
  const char* table = "tensors";
  std::vector<Comparison> rows = {
      paper::beside(table, "volume", mass), paper::beside(table, "Q_00", mass / std::sqrt(4 * std::numbers::pi)),
      paper::beside(table, "Q_20", spherical[0].real()), paper::beside(table, "Re conj Q_22", spherical[2].real()),
      paper::beside(table, "Im conj Q_22", -spherical[2].imag())};
  constexpr std::array axes = {'x', 'y', 'z'};
  for (const auto& [name, tensor] : {std::pair("quadrupole", &q), std::pair("inertia", &inertia)})
    for (Eigen::Index i = 0; i < 3; ++i)
      for (Eigen::Index j = i; j < 3; ++j)
        rows.push_back(paper::beside(table, fmt::format("{} {}{}", name, axes[std::size_t(i)], axes[std::size_t(j)]),
                                     (*tensor)(i, j)));
  return rows;
}

std::vector<Comparison> beside_paper(const RadiationResult& r) {
  if (!r.spin || !r.longest_side) return {};
  const Units& units = r.body.units;
  const double unit = units.kilogram * units.metre * units.metre, year = 365 * 86400.0;
  const char* table = "radiation";
  return {paper::beside(table, "length unit in m", paper::cow_length_m / (*r.longest_side / units.metre)),
          paper::beside(table, "mass unit in kg", units.kilogram),
          paper::beside(table, "volume", r.body.mass / units.kilogram),
          paper::beside(table, "mass in kg", r.body.mass),
          paper::beside(table, "Q'''^2/omega^6", r.square / (unit * unit)),
          paper::beside(table, "Q'''^2/omega^6 in kg^2 m^4", r.square),
          paper::beside(table, "power in erg/s", double(r.power) * 1e7),
          paper::beside(table, "factor of sum |Q'''_2m|^2 G/c^5", 8 * std::numbers::pi / 75),
          paper::beside(table, "timescale in s", double(r.spin->timescale)),
          paper::beside(table, "1 - omega now", double(r.spin->deficit)),
          paper::beside(table, "the same with its rounding",
                        (13.787e9 - 12e6) * year / (2 * paper::number(table, "timescale in s")))};
}

std::vector<Comparison> beside_paper(const TipResult& found, const Monitor& monitor) {
  const RigidBody& body = found.body;
  const double weight = found.forces.weight();
  constexpr double human = paper::sustained_force_N;
  std::vector<Comparison> rows;
  const auto add = [&](const std::string& what, double force) {
    rows.push_back({what, force, human,
                    fmt::format("no force is printed: 500 N are 'out of reach by a factor of a few', here {:.2f}",
                                force / human)});
  };
  const double volume = cowgpu::volume(body.vertices, body.faces);
  const Stance ball = stand(ball_like(body, volume), {}, monitor);
  rows.push_back({"spherical cow, N", tipping(ball, Side::right).force * weight, 0});
  const auto weaker = [](const Stance& stance) {
    const Tipping left = tipping(stance, Side::left), right = tipping(stance, Side::right);
    return weaker_side(left, right) == Side::left ? left : right;
  };
  const Side side = found.forces.side;
  const Tipping settled = !found.as_modelled ? found.forces.chosen()
                          : found.side_given ? tipping(stand(body, {}, monitor), side)
                                             : weaker(stand(body, {}, monitor));
  add("settled, N", settled.force * weight);
  add("settled, its balance, N", settled.force_paper_balance * weight);
  if (settled.force_paper_literal) add("settled, its arm in space, N", *settled.force_paper_literal * weight);
  if (found.subject.sha256 != benchmark_sha256) return rows;
  for (const auto& [what, tolerance] :
       {std::pair("hind hooves' tips", 0.0), std::pair("hind hooves", 0.005), std::pair("all hooves", 0.01)}) {
    const Tipping modelled = weaker(stand(body, {true, tolerance * body.units.metre}, monitor));
    add(fmt::format("as modelled, {}, N", what), modelled.force * weight);
  }
  return rows;
}

std::vector<Comparison> potential_beside_paper() {
  std::vector<Comparison> rows;
  for (const int l : {0, 2})
    rows.push_back(paper::beside("potential", fmt::format("factor of G Q_lm / r^(l+1), l = {}", l),
                                 4 * std::numbers::pi / (2 * l + 1)));
  return rows;
}

} // namespace cowgpu

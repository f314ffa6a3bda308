#include "host/cli/physics.hpp"

#include "host/physics/paper.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace cowgpu::cli {
namespace {

using namespace physics;

// In the paper's units: the mesh's, and density 1.
std::vector<Comparison> beside_paper(const MassTensors& tensors, const PlacedTensors& placed) {
  const double length = placed.unit_m.value_or(1), unit = placed.unit_kg.value_or(1) * length * length;
  const Eigen::Matrix3d q = tensors.quadrupole / unit, inertia = tensors.inertia() / unit;
  const double mass = tensors.mass / placed.unit_kg.value_or(1);
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

Findings solve(const PhysicsOptions& options, bool inertia_wanted) {
  const PhysicsInput input = load_input(options);
  const PlacedTensors placed = placed_tensors(input, options);
  const MassTensors& tensors = placed.tensors;
  const bool complete = tensors.trace.has_value();
  if (inertia_wanted && !complete) tensors.inertia(); // its error names what is missing
  const PrincipalAxes principal = principal_axes(tensors);
  Findings found = findings_about(input, options);
  const bool si = tensors.metric();
  const std::string length = si ? "m" : std::string(mesh_length_unit), mass = si ? "kg" : std::string(mesh_mass_unit),
                    unit = si ? "kg m^2" : "density * length^5, in the mesh's length unit";
  if (!complete)
    found.notes.push_back(
        "the file does not say the second moment, which no multipole holds: no inertia without it; the JSON "
        "of `cowgpu expand` holds it, and what `cowgpu convert` makes of that");
  if (!si)
    found.notes.push_back("lengths and densities are in the mesh's units; --length-unit or --length make them SI");
  if (principal.first_two_alike && principal.last_two_alike)
    found.notes.push_back("all three principal moments are equal: any axes would do");
  else if (principal.first_two_alike || principal.last_two_alike)
    found.notes.push_back(fmt::format("the {} two principal moments are equal: their axes are any two in their plane",
                                      principal.first_two_alike ? "first" : "last"));
  found.notes.push_back("principal axes by growing moment; the largest component of the first two is positive, and "
                        "the third is the first cross the second");
  found.rows = {
      {"origin", "origin", tensors.origin ? Value(*tensors.origin) : Value(), length},
      {"origin_kind", "kind of origin", tensors.origin_kind},
      {"mass", "mass", tensors.mass, mass},
      {"first_moment", "first moment", tensors.first_moment, si ? "kg m" : "density * length^4"},
      {"quadrupole", "quadrupole, integral of density (3 x_i x_j - r^2 delta_ij)", tensors.quadrupole, unit},
      {"inertia", "inertia, integral of density (r^2 delta_ij - x_i x_j)",
       complete ? Value(tensors.inertia()) : Value(), unit},
      {"second_moment", "second moment, integral of density x_i x_j",
       complete ? Value(tensors.second_moment()) : Value(), unit},
      {"principal_moments", "principal moments of inertia", complete ? Value(*principal.moments) : Value(), unit},
      {"principal_quadrupole", "quadrupole along the principal axes", principal.quadrupole, unit},
      {"principal_axes", "principal axes, one a row", Eigen::Matrix3d(principal.axes.transpose())}};
  if (options.paper()) found.paper = beside_paper(tensors, placed);
  return found;
}

} // namespace

Solve add_tensors(Command& command, Common&) {
  const auto inertia = std::make_shared<bool>(false);
  command.add_flag("--inertia", *inertia, "The inertia is what is wanted: refuse a file that does not give it");
  return [inertia](const PhysicsOptions& options) { return solve(options, *inertia); };
}

} // namespace cowgpu::cli

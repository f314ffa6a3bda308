// Where particles stay at rest on or about a spinning body.
#pragma once

#include "host/backend.hpp"
#include "host/report/equilibria_findings.hpp"
#include "host/requests/load_body.hpp"
#include "host/units.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// A surface of zero velocity, of one of the two.
struct ZeroVelocityRequest {
  std::optional<double> jacobi; ///< the constant, in J/kg where units are stated
  int equilibrium = 1;          ///< else that of an equilibrium, counted from the innermost
  std::optional<Measure>
      extent;     ///< half side of the cube about the centre of mass; empty: 1.5 times the farthest equilibrium
  int cells = 64; ///< along its sides
};

struct EquilibriaRequest {
  BodyRequest body;            ///< a mesh; it turns about its centre of mass
  std::optional<Measure> mass; ///< instead of a density: in kg where units are stated, else in the mesh's own units
  /// How fast the body turns: in rad/s where units are stated, else in units of sqrt(G density).
  Measure spin_rate;
  std::optional<Vec3> spin_axis; ///< a direction; empty: the largest principal axis
  double smallest = 1e-4;        ///< as physics::EquilibriaProblem has these
  std::uint64_t cells = 1'000'000;
  std::optional<ZeroVelocityRequest> surface;
  std::vector<std::string> notes; ///< sentences that come after those about the body
};

/// Throws what load_mass() throws, Error(file_format) for coefficients, Error(bad_argument) for density and mass at once, a mass
/// that is not above 0 or one of a body with parts, measures with units where the mesh has none and without where it has, a
/// spin that is not above 0, an axis that is none, Error(too_large), what physics::equilibria() and
/// physics::zero_velocity_surface() throw; Error(bad_argument) for a surface of an equilibrium that there is not.
EquilibriaResult equilibria(const EquilibriaRequest& request, Backend& backend, Monitor& monitor);

} // namespace cowgpu

// Gravitational waves from a body that turns: their power, and how its spin decays.
#pragma once

#include "host/report/radiation_findings.hpp"
#include "host/requests/load_body.hpp"

namespace cowgpu {

/// rad/s: a body that turns slower has not turned once in 400 Gyr.
inline constexpr double slowest_turn = 5e-19;

struct RadiateRequest {
  BodyRequest body;
  Vec3 axis = Vec3::UnitY();      ///< through the centre of mass, of length 1
  double omega = 1;               ///< rad/s, slowest_turn at least
  double time = 0;                ///< s, from the start of the spin to when it is asked for
  bool octupole = false;          ///< also mass octupole and current quadrupole, of a mesh
  std::vector<std::string> notes; ///< sentences that come before those about the radiation
};

/// Throws what load_mass() and physics::rigid_body() throw, Error(bad_argument) for rates and times beyond, a body without mass or
/// moment, one faster than light, and numbers that doubles cannot hold, Error(file_format) for the octupole of coefficients.
RadiationResult radiate(const RadiateRequest& request, Monitor& monitor);

} // namespace cowgpu

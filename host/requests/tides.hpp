// A body on a circular orbit: the torque of gravity, attitudes that last, librations, tidal locking.
#pragma once

#include "host/report/tides_findings.hpp"
#include "host/requests/load_body.hpp"

namespace cowgpu {

struct TidesRequest {
  BodyRequest body; ///< units must be stated
  physics::PointMass centre = physics::earth;
  double radius = 0; ///< m, between the centres
  std::optional<physics::LongMat3>
      attitude;                        ///< from the body's axes to the orbit's; empty: the principal axes along them
  int order = 0;                       ///< highest degree; 0: 6, or what a file holds
  std::optional<double> spin;          ///< rad/s, about the axis of the largest moment
  std::optional<double> love, quality; ///< with the spin: the time to lock
  std::vector<std::string> notes;      ///< sentences that come before those about the orbit
};

/// Throws what load_mass(), free_body(), physics::circular_orbit() and physics::locking_time() throw, Error(bad_argument)
/// without units, for an orbit or a spin faster than light, and where some of spin, Love number and quality factor are given but not all.
TidesResult tides(const TidesRequest& request, Monitor& monitor);

} // namespace cowgpu

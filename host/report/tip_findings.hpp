// What is found out about a body that stands on the ground and is tipped over.
#pragma once

#include "host/physics/findings.hpp"
#include "host/physics/tip.hpp"
#include "host/report/push_findings.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// What begins to tip a body to either side. Forces are in units of its weight.
struct TippingForces {
  physics::Tipping left, right;
  physics::Side side = physics::Side::right; ///< to which it falls
  double mass = 0;
  double gravity = 0;      ///< m/s^2
  double settle_angle = 0; ///< radians that it turned to come to rest
  bool held = false;       ///< as in physics::Stance

  const physics::Tipping& chosen() const { return side == physics::Side::left ? left : right; }
  double weight() const { return mass * gravity; }
};

/// The body of an order.
struct TippedOrder {
  int order = 0;
  std::optional<TippingForces> forces; ///< none where it cannot stand
  std::string note;
};

struct TipResult {
  physics::Subject subject;
  std::string body_is;     ///< "the mesh", or which order stands for it
  physics::RigidBody body; ///< as modelled, with its surface
  physics::Stance stance;  ///< how it stands
  TippingForces forces;
  bool as_modelled = false; ///< it did not settle
  bool side_given = false;  ///< forces.side was asked for; else it is the one that needs less
  std::optional<double> friction;
  std::string expansion; ///< name of the expansion that orders are of; empty where there is none
  std::vector<TippedOrder> orders;
  std::optional<PushOutcome> push; ///< where units are stated and not every push tips it
};

/// What `cowgpu tip` shows of it: rows, tables and notes with their units.
physics::Findings findings(const TipResult& result);

} // namespace cowgpu

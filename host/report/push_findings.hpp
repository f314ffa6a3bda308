// What is found out about pushes that last.
#pragma once

#include "host/physics/findings.hpp"
#include "host/physics/push.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// The pushes that are asked about, and what results call them.
struct PushRequest {
  std::optional<physics::Profile> profile;
  bool turns_with_body = true; ///< at right angles to the line from pivot to point all the time; else as it began
  double sustained = 500;      ///< N, a force that lasts
  double punch = 5000;         ///< N, of which the least duration that tips is found
  std::optional<double> punch_duration; ///< s
  std::string profile_name, sustained_name = "500 N", punch_name = "5000 N", punch_duration_name;
};

/// How long a constant force must last to tip the body.
struct BoundaryPoint {
  double force = 0;           ///< N
  std::string mark;           ///< what is special about it, or empty
  double least_duration = 0;  ///< s; infinite where it never does
  double friction_needed = 0; ///< of its feet meanwhile; infinite where they leave the ground
};

struct PushOutcome {
  PushRequest asked;
  physics::Rocker rocker;
  double punch_least_duration = 0;           ///< s; infinite where it never tips
  std::optional<double> punch_force_needed;  ///< N, that tips it in the punch's duration, where that is given
  std::optional<physics::PushResult> pushed; ///< outcome of the profile, where there is one
  std::vector<BoundaryPoint> boundary;       ///< by growing force
};

/// Adds rows, notes and the table `boundary`. `friction`: coefficient of the feet, where it is given.
void add_findings(const PushOutcome& outcome, std::optional<double> friction, physics::Findings& found);

} // namespace cowgpu

// The push over time in `tip`: options, and what they find out.
#pragma once

#include "host/physics/findings.hpp"
#include "host/physics/push.hpp"
#include "host/physics/tip.hpp"

#include "host/cli/command_line.hpp"

#include <optional>
#include <string>

namespace cowgpu::cli {

struct PushOptions {
  std::string push;               ///< FORCE:DURATION or FILE.csv, or empty
  std::string direction = "body"; ///< or "space"
  std::string sustained = "500 N", punch = "5000 N", punch_duration;
};

void add_push_options(Command& command, PushOptions& options);

/// The options read, before there is a body.
struct PushPlan {
  std::optional<physics::Profile> profile;
  bool turns_with_body = true;
  double sustained = 0, punch = 0;      ///< N
  std::optional<double> punch_duration; ///< s
};

/// Throws Error(bad_argument) for words that mean nothing, for forces beyond 1e-30 to 1e30 N and durations beyond 1e-15 to
/// 1e9 s; what read_csv() throws, and file_syntax with the line for times that fall or are beyond that and forces below
/// 0 or above it.
PushPlan plan_push(const PushOptions& options);

/// Of a body in SI units.
physics::Rocker rocker(const physics::RigidBody& body, const physics::Tipping& tipping, double gravity,
                       bool turns_with_body);

/// Rows, notes and the table `boundary`. `friction`: the coefficient, where it is given.
void add_push_findings(const physics::Rocker& rocker, const PushOptions& options, const PushPlan& plan,
                       std::optional<double> friction, const Monitor& monitor, physics::Findings& found);

} // namespace cowgpu::cli

// The applications of the multipoles: one row of a table each makes subcommand, help, JSON and report.
#pragma once

#include "host/cli/body_options.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/quantities.hpp"
#include "host/report/findings_report.hpp"

#include <functional>

namespace cowgpu::cli {

/// What every application is asked for.
struct PhysicsCall {
  BodyRequest body;
  bool paper = false; ///< with the numbers of "Higher multipoles of the cow" beside those found
  bool json = false;
};

/// Computes, once the options are parsed.
using Solve = std::function<physics::Findings(const PhysicsCall&)>;

/// A subcommand. `add` adds the options that are its own (of one that needs a device, add_common_options() too), which may
/// set those of the body, and returns what to do; the JSON is cowgpu.NAME.v1.
struct Application {
  const char* name;
  const char* summary;
  const char* footer;
  Solve (*add)(Command& command, Common& common, BodyOptions& body);
  bool paper_of_formulas = false; ///< what it lays beside the paper holds for every body
  bool asks_radius = false;       ///< it takes --brillouin-radius for files that do not say it
};

Solve add_tensors(Command& command, Common& common, BodyOptions& body);
Solve add_potential(Command& command, Common& common, BodyOptions& body);
Solve add_radiate(Command& command, Common& common, BodyOptions& body);
Solve add_tides(Command& command, Common& common, BodyOptions& body);
Solve add_drop(Command& command, Common& common, BodyOptions& body);
Solve add_equilibria(Command& command, Common& common, BodyOptions& body);
Solve add_tip(Command& command, Common& common, BodyOptions& body);

} // namespace cowgpu::cli

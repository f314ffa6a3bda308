// The options that turn a mesh into a body: unit, density, axes, attitude, origin, parts.
#pragma once

#include "host/mesh/body.hpp"
#include "host/mesh/mend.hpp"

#include "host/cli/command_line.hpp"

#include <string>
#include <vector>

namespace cowgpu::cli {

/// As typed.
struct BodyOptions {
  std::string mesh = "builtin:cow";
  std::string origin = "com";
  std::string density = "1";
  std::string length_unit, length, axes, rotate;
  bool charge = false;            ///< densities are of charge: C/m3 where metric
  std::vector<std::string> parts; ///< FILE=DENSITY each
  Mending mending;                ///< what mends MESH, before it is placed
};

/// Adds MESH, --origin, --density, --length-unit, --length, --axes, --rotate, --part and those of mend_options.hpp.
void add_body_options(Command& command, BodyOptions& options);

/// Reads mesh and parts, places them and measures the body; sentences about what was done go to `notes`. Throws
/// Error(bad_argument) for options that mean nothing or do not go together, and what load_mended(), ClosedSurface::from() and
/// make_body() throw; errors of a part begin with its name.
Body load_body(const BodyOptions& options, std::vector<std::string>& notes);

/// The unit and density that options state; `metres` and `density` are plain numbers where not metric.
struct StatedUnits {
  double metres = 1, density = 1;
  bool metric = false;
};

/// Reads --length-unit and --density alone. Throws Error(bad_argument).
StatedUnits stated_units(const BodyOptions& options);

/// The words for what is read, for refuse_mesh_as_output().
std::vector<std::string> input_files(const BodyOptions& options);

} // namespace cowgpu::cli

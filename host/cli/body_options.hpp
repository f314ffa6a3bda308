// The options that say which body is meant: a mesh, its unit, density, axes, attitude, origin and parts.
#pragma once

#include "host/cli/command_line.hpp"
#include "host/requests/load_body.hpp"

#include <string>
#include <vector>

namespace cowgpu::cli {

/// As typed.
struct BodyOptions {
  std::string mesh = "builtin:cow";
  std::string origin = "com";
  std::string density = "1";
  const Option* density_option = nullptr; ///< null where the command has none
  bool density_stated = false;            ///< by a recipe; else by the option
  std::string length_unit, length, axes, rotate;
  bool charge = false;            ///< densities are of charge: C/m3 where units are stated
  std::vector<std::string> parts; ///< FILE=DENSITY each
  Mending mending;
};

/// Adds MESH, --origin, --density, --length-unit, --length, --axes, --rotate, --part and those of mend_options.hpp.
void add_body_options(Command& command, BodyOptions& options);

/// Reads the words. Throws Error(bad_argument) for those that mean nothing or do not go together.
BodyRequest body_request(const BodyOptions& options);

/// The words for what is read, for refuse_mesh_as_output().
std::vector<std::string> input_files(const BodyOptions& options);
std::vector<std::string> input_files(const BodyRequest& request);

} // namespace cowgpu::cli

// The program's subcommands. Each adds itself to the command line; a new one is a file, a line here and one in main.cpp.
#pragma once

#include "host/backend.hpp"
#include "host/cli/console.hpp"
#include "host/convention.hpp"
#include "host/requests/limits.hpp"
#include "host/requests/load_body.hpp"
#include "host/requests/memory.hpp"
#include "host/types.hpp"

#include "host/cli/command_line.hpp"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu::cli {

/// Options every subcommand has.
struct Common {
  std::vector<std::string> command; ///< the command line as typed
  std::string device = "auto";
  std::string progress = "auto";
  unsigned threads = 0;
  bool quiet = false;
  int exit_code = 0;

  ProgressStyle style() const { return progress_style(progress, quiet); }
};

void add_expand(Command& app, Common& common);
void add_validate(Command& app, Common& common);
void add_inspect(Command& app, Common& common);
void add_devices(Command& app, Common& common);
void add_render(Command& app, Common& common);
void add_bench(Command& app, Common& common);
void add_transform(Command& app, Common& common);
void add_spectrum(Command& app, Common& common);
void add_convert(Command& app, Common& common);
void add_diff(Command& app, Common& common);
void add_map(Command& app, Common& common);
void add_reconstruct(Command& app, Common& common);
void add_report(Command& app, Common& common);
void add_inflate(Command& app, Common& common);
void add_distance(Command& app, Common& common);
void add_streamlines(Command& app, Common& common);
void add_surface(Command& app, Common& common);
void add_reproduce(Command& app, Common& common);
void add_figure(Command& app, Common& common);
/// Adds the applications of the multipoles, host/cli/physics.cpp.
void add_physics(Command& app, Common& common);
void add_errata(Command& app, Common& common);

/// Adds `meshes` and `meshes add`.
void add_meshes(Command& app);

/// Adds `man` and `completion`, which print the man page and the shell completion of `app`.
void add_manual(Command& app);

/// Adds `roundtrip` to the command `transform`.
void add_roundtrip(Command& transform, Common& common);

/// Adds --threads, --progress and --quiet.
void add_run_options(Command& command, Common& common);

/// Adds --device and those.
void add_common_options(Command& command, Common& common);

/// Opens what --device names: "cpu", or a Vulkan device. "auto" falls back to the CPU path where there is no loader, no
/// device or no double precision; `note` then says so. Throws Error(no_loader, no_device, no_fp64, device_failed).
std::unique_ptr<Backend> open_backend(const Common& common, std::string* note);

/// Adds --grid and --lmax as the transforms have them; `lmax` stays as it is where the option is not given.
void add_grid_option(Command& command, std::string& grid, const char* what);
void add_degree_option(Command& command, int& lmax, const char* what);

/// Throws Error(bad_argument) where the output's name leads to the file that is read.
void refuse_same_file(const std::string& input, const std::string& output);

/// The same where the input is a word for a mesh, with the file that the word means.
void refuse_mesh_as_output(const std::string& mesh, const std::string& output);

/// "X,Y,Z", three finite numbers; nothing if the text is something else.
std::optional<Vec3> parse_point(std::string_view text);

/// Reads --origin: com, mesh or X,Y,Z. Throws Error(bad_argument).
OriginChoice parse_origin(const std::string& text);

/// Adds --normalisation and --phase with their words; `of_what` goes on behind their names in the help: "of OUT".
void add_convention_options(Command& command, std::string& normalisation, std::string& phase, const char* of_what);

/// The help text of a MESH argument.
std::string mesh_help();

} // namespace cowgpu::cli

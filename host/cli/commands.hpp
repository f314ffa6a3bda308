// The program's subcommands. Each adds itself to the command line; a new one is a file, a line here and one in main.cpp.
#pragma once

#include "host/backend.hpp"
#include "host/cli/console.hpp"
#include "host/convention.hpp"
#include "host/mesh/body.hpp"
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

void add_expand(CLI::App& app, Common& common);
void add_validate(CLI::App& app, Common& common);
void add_inspect(CLI::App& app, Common& common);
void add_devices(CLI::App& app, Common& common);
void add_render(CLI::App& app, Common& common);
void add_bench(CLI::App& app, Common& common);
void add_transform(CLI::App& app, Common& common);
void add_spectrum(CLI::App& app, Common& common);
void add_convert(CLI::App& app, Common& common);
void add_diff(CLI::App& app, Common& common);
void add_map(CLI::App& app, Common& common);
void add_reconstruct(CLI::App& app, Common& common);
void add_report(CLI::App& app, Common& common);
void add_inflate(CLI::App& app, Common& common);
void add_distance(CLI::App& app, Common& common);
void add_streamlines(CLI::App& app, Common& common);
void add_reproduce(CLI::App& app, Common& common);
void add_figure(CLI::App& app, Common& common);
/// Adds the applications of the multipoles, host/cli/physics.cpp.
void add_physics(CLI::App& app, Common& common);
void add_errata(CLI::App& app, Common& common);

/// Adds `meshes` and `meshes add`.
void add_meshes(CLI::App& app);

/// Adds `man` and `completion`, which print the man page and the shell completion of `app`.
void add_manual(CLI::App& app);

/// Checks of options: a finite number above 0, or one from 0 on.
CLI::Validator positive_number();
CLI::Validator non_negative_number();
/// A text that is not empty: what a shell's variable that is not set would give.
CLI::Validator not_empty();

/// Adds `roundtrip` to the command `transform`.
void add_roundtrip(CLI::App& transform, Common& common);

/// Adds --threads, --progress and --quiet.
void add_run_options(CLI::App& command, Common& common);

/// Adds --device and those.
void add_common_options(CLI::App& command, Common& common);

/// Opens what --device names: "cpu", or a Vulkan device. "auto" falls back to the CPU path where there is no loader, no
/// device or no double precision; `note` then says so. Throws Error(no_loader, no_device, no_fp64, device_failed).
std::unique_ptr<Backend> open_backend(const Common& common, std::string* note);

/// Adds --grid and --lmax as the transforms have them; `lmax` stays as it is where the option is not given.
void add_grid_option(CLI::App& command, std::string& grid, const char* what);
void add_degree_option(CLI::App& command, int& lmax, const char* what);

/// Throws Error(too_large) with `advice` where this machine has not so much memory.
void check_memory(const MemoryNeed& need, const Backend& backend, const char* advice);

/// Throws Error(bad_argument) where the output's name leads to the file that is read.
void refuse_same_file(const std::string& input, const std::string& output);

/// The same where the input is a word for a mesh, with the file that the word means.
void refuse_mesh_as_output(const std::string& mesh, const std::string& output);

/// "X,Y,Z", three finite numbers; nothing if the text is something else.
std::optional<Vec3> parse_point(std::string_view text);

/// Reads --origin: com, mesh or X,Y,Z. Throws Error(bad_argument).
OriginChoice parse_origin(const std::string& text);

/// Adds --normalisation and --phase with their words; `of_what` goes on behind their names in the help: "of OUT".
void add_convention_options(CLI::App& command, std::string& normalisation, std::string& phase, const char* of_what);

/// "orthonormal, with Condon-Shortley phase".
std::string convention_text(Convention convention);

/// The help text of a MESH argument.
std::string mesh_help();

} // namespace cowgpu::cli

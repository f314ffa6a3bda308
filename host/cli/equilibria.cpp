#include "host/cli/physics.hpp"
#include "host/cli/quantities.hpp"
#include "host/cli/spin_options.hpp"
#include "host/cli/surface_outputs.hpp"

#include "host/error.hpp"
#include "host/number.hpp"
#include "host/requests/equilibria.hpp"

#include <fmt/format.h>

#include <optional>
#include <string_view>

namespace cowgpu::cli {
namespace {

struct Options {
  SpinOptions spin;
  double smallest = 1e-4;
  int cells = 1'000'000;
  std::string surface, extent, output;
  int surface_cells = 64;
};

// A constant, or the number of an equilibrium: "E2".
ZeroVelocityRequest parse_surface(const Options& options) {
  ZeroVelocityRequest request;
  const std::string_view text = options.surface;
  if (text.starts_with('E')) {
    const auto number = read_whole(text.substr(1), 1, 1000);
    request.equilibrium = number ? *number : 0;
  } else {
    request.jacobi = read_number(text);
    request.equilibrium = 0;
  }
  if (!request.jacobi && request.equilibrium == 0)
    throw Error(
        Fault::bad_argument,
        fmt::format("--surface {}: it takes a Jacobi constant, a number, or E1, E2 ... for that of an equilibrium "
                    "counted from the innermost",
                    options.surface));
  request.cells = options.surface_cells;
  if (!options.extent.empty()) request.extent = parse_measure("--extent", options.extent, Dimension::length);
  return request;
}

void check_outputs(const PhysicsCall& call, const Options& options) {
  if (options.surface.empty() != options.output.empty())
    throw Error(Fault::bad_argument,
                "--surface says which zero-velocity surface, and -o where it goes, FILE.ply or FILE.glb: "
                "give both or neither");
  if (options.output == "-") throw Error(Fault::bad_argument, "-o -: the standard output has the report; name a file");
  if (!options.output.empty() && !options.output.ends_with(".ply") && !options.output.ends_with(".glb"))
    throw Error(Fault::bad_argument,
                fmt::format("-o {}: a zero-velocity surface is FILE.ply or FILE.glb", options.output));
  for (const std::string& name : input_files(call.body))
    if (!options.output.empty()) refuse_mesh_as_output(name, options.output);
}

void write_surface(const Options& options, const EquilibriaResult& result, SurfaceOutputs& outputs, bool quiet) {
  const auto& zero = *result.zero_velocity;
  if (zero.surface.faces.empty())
    throw Error(
        Fault::bad_argument,
        fmt::format("--surface {}: there is no zero-velocity surface of the constant {} in the cube of half side {} "
                    "about the centre of mass, or none thicker than a cell",
                    options.surface, zero.jacobi, zero.extent));
  const std::string name =
      outputs.write({"", ""}, zero.surface,
                    {fmt::format("spin_rate {}", result.spin.rate), fmt::format("half_side_of_cube {}", zero.extent)},
                    {"jacobi", zero.jacobi});
  if (!quiet) say(fmt::format("cowgpu: wrote {}\n", name));
}

EquilibriaRequest request_of(const PhysicsCall& call, const Options& options) {
  EquilibriaRequest request;
  request.body = call.body;
  request.mass = stated_mass(options.spin);
  const std::optional<Measure> rate = spin_rate(options.spin, request.notes);
  if (!rate) throw Error(Fault::bad_argument, "--period or --omega says how fast the body turns: give one of them");
  request.spin_rate = *rate;
  request.spin_axis = spin_axis(options.spin);
  request.smallest = options.smallest;
  request.cells = std::uint64_t(options.cells);
  if (!options.surface.empty()) request.surface = parse_surface(options);
  return request;
}

} // namespace

Solve add_equilibria(Command& command, Common& common, BodyOptions&) {
  const auto options = std::make_shared<Options>();
  add_spin_options(command, options->spin, "its centre of mass");
  command
      .add_option("--smallest", options->smallest,
                  "How far cells are refined before they count as undecided: 1e-8 to 0.1, in radii of the ball with "
                  "the body's volume")
      ->type_name("PART")
      ->check(in_range(1e-8, 0.1))
      ->capture_default_str();
  command.add_option("--cells", options->cells, "As many cells are looked at, at most")
      ->type_name("N")
      ->check(in_range(1'000, 1'000'000'000))
      ->capture_default_str();
  add_common_options(command, common);
  command
      .add_option("--surface", options->surface,
                  "Write the zero-velocity surface of this Jacobi constant (J/kg where units are stated), or of an "
                  "equilibrium's: E1 is the innermost")
      ->type_name("C|E1...")
      ->check(not_empty());
  command
      .add_option("--extent", options->extent,
                  "Half side of the cube about the centre of mass in which the surface is looked for (default: 1.5 "
                  "times as far as the farthest equilibrium)")
      ->type_name("LENGTH")
      ->check(not_empty());
  command.add_option("--surface-cells", options->surface_cells, "Cells along the sides of that cube")
      ->type_name("N")
      ->check(in_range(4, 512))
      ->capture_default_str();
  command.add_option("-o,--output", options->output, "The zero-velocity surface: FILE.ply or FILE.glb")
      ->type_name("FILE");
  return [options, &common](const PhysicsCall& call) {
    check_outputs(call, *options);
    SurfaceOutputs outputs(options->output, "", 1, "surface");
    EquilibriaRequest request = request_of(call, *options);
    if (outputs.any()) outputs.open({"", ""});
    std::string note;
    const auto backend = open_backend(common, &note);
    if (!note.empty()) request.notes.push_back(note);
    if (!common.quiet && !note.empty()) say(fmt::format("cowgpu: {}\n", note));
    ConsoleMonitor monitor(common.style());
    const EquilibriaResult result = equilibria(request, *backend, monitor);
    monitor.clear();
    if (result.zero_velocity) write_surface(*options, result, outputs, common.quiet);
    return findings(result);
  };
}

} // namespace cowgpu::cli

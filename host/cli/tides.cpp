#include "host/requests/tides.hpp"
#include "host/cli/physics.hpp"

#include <fmt/format.h>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string orbit, mass = "earth", attitude = "aligned", spin;
  std::optional<double> love, quality;
  int order = 0; // 0: not given
};

TidesRequest request_of(const PhysicsCall& call, const Options& options) {
  TidesRequest request;
  request.body = call.body;
  request.centre = parse_point_mass("--mass", options.mass);
  request.radius = parse_positive("--orbit", options.orbit, Dimension::length, "6771km");
  note_unit("--orbit", options.orbit, Dimension::length, request.notes);
  if (options.attitude != "aligned")
    request.attitude = options.attitude == "as-is" ? physics::LongMat3(physics::LongMat3::Identity())
                                                   : parse_turn("--attitude", options.attitude);
  request.order = options.order;
  if (!options.spin.empty()) request.spin = parse_positive("--spin", options.spin, Dimension::angular_rate, "1rad/s");
  request.love = options.love;
  request.quality = options.quality;
  return request;
}

} // namespace

Solve add_tides(Command& command, Common&, BodyOptions&) {
  const auto options = std::make_shared<Options>();
  command
      .add_option("--orbit", options->orbit,
                  "Radius of the circular orbit: 6771km, 1.1R_earth (R_earth is 6371 km, the earth's mean radius), 1au")
      ->type_name("RADIUS")
      ->required();
  command
      .add_option("--mass", options->mass,
                  "Mass at the centre of the orbit, a point: earth, moon, sun, or a mass: 6e24kg")
      ->type_name("MASS")
      ->capture_default_str();
  command
      .add_option(
          "--attitude", options->attitude,
          "For the torque: aligned (A outwards, C along the normal), as-is (the mesh's axes along the orbit's), or a "
          "turn from as-is: AXIS:DEGREES, or ALPHA,BETA,GAMMA as --rotate has it")
      ->type_name("TURN")
      ->capture_default_str();
  command.add_option("--order", options->order, "Highest degree of the multipoles; default 6")
      ->type_name("L")
      ->check(in_range(least_multipole_order, largest_multipole_order));
  command.add_option("--spin", options->spin, "How fast it spins at first, about C: whether it is caught")
      ->type_name("RATE");
  command
      .add_option("--love", options->love,
                  fmt::format("Love number k2 of the body, above 0 to {}: with --quality and --spin the time to lock",
                              physics::largest_love))
      ->type_name("NUMBER");
  command
      .add_option("--quality", options->quality,
                  fmt::format("Quality factor Q of the body, 1 to {:.0e}", physics::largest_quality))
      ->type_name("NUMBER");
  return [options](const PhysicsCall& call) {
    ConsoleMonitor monitor(ProgressStyle::none);
    return findings(tides(request_of(call, *options), monitor));
  };
}

} // namespace cowgpu::cli

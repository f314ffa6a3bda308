#include "host/cli/physics.hpp"

#include "host/error.hpp"
#include "host/requests/drop.hpp"

#include <fmt/format.h>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string height, attitude = "upright", feet = "-y", spin;
  int order = 6;
};

std::variant<Held, physics::LongMat3> parse_attitude(const std::string& text) {
  if (text == "upright") return Held::upright;
  if (text == "upside-down") return Held::upside_down;
  if (text == "on-side") return Held::on_side;
  try {
    return parse_turn("--attitude", text);
  } catch (const Error& error) {
    throw Error(error.fault(), fmt::format("{}; or upright, upside-down, on-side, or AXIS:DEGREES", error.what()));
  }
}

// AXIS,RATE with AXIS perhaps X,Y,Z.
Vec3 parse_spin(const std::string& text) {
  if (text.empty()) return Vec3::Zero();
  const std::size_t comma = text.rfind(',');
  if (comma == std::string::npos)
    throw Error(Fault::bad_argument, fmt::format("--spin {}: it takes AXIS,RATE, as in x,10rpm", text));
  return parse_axis("--spin", text.substr(0, comma)) *
         parse_quantity("--spin", text.substr(comma + 1), Dimension::angular_rate, "x,10rpm").value;
}

DropRequest request_of(const PhysicsCall& call, const Options& options) {
  DropRequest request;
  request.body = call.body;
  request.feet = parse_axis("--feet", options.feet);
  request.height = parse_quantity("--height", options.height, Dimension::length, "10m").value;
  request.attitude = parse_attitude(options.attitude);
  request.spin = parse_spin(options.spin);
  request.order = options.order;
  return request;
}

} // namespace

Solve add_drop(Command& command, Common& program, BodyOptions&) {
  const auto options = std::make_shared<Options>();
  command.add_option("--height", options->height, "Height of the centre of mass above the ground, with its unit: 10m")
      ->type_name("LENGTH")
      ->required();
  command
      .add_option("--attitude", options->attitude,
                  "upright (feet down), upside-down, on-side (a half and a quarter turn about x), or a turn of the "
                  "mesh's axes, "
                  "of which y is up: AXIS:DEGREES, or ALPHA,BETA,GAMMA as --rotate has it")
      ->type_name("TURN")
      ->capture_default_str();
  command.add_option("--feet", options->feet, "Where the feet are, in the body's axes: x, -y, X,Y,Z ...")
      ->type_name("AXIS")
      ->capture_default_str();
  command.add_option("--spin", options->spin, "Spin at the start, about an axis of the body: x,10rpm or 1,2,0,3rad/s")
      ->type_name("AXIS,RATE");
  command.add_option("--order", options->order, "Highest degree of the multipoles")
      ->type_name("L")
      ->check(in_range(least_multipole_order, largest_multipole_order))
      ->capture_default_str();
  return [options, &program](const PhysicsCall& call) {
    ConsoleMonitor monitor(program.style());
    return findings(drop(request_of(call, *options), monitor));
  };
}

} // namespace cowgpu::cli

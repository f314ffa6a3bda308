#include "host/cli/spin_options.hpp"

#include "host/cli/quantities.hpp"
#include "host/error.hpp"

#include <fmt/format.h>

#include <numbers>

namespace cowgpu::cli {

void add_spin_options(Command& command, SpinOptions& options, const char* through) {
  command.add_option("--mass", options.mass, "Mass of the body with its unit, instead of --density: 6.69e15kg")
      ->type_name("MASS")
      ->check(not_empty());
  command
      .add_option("--period", options.period,
                  "The body spins, one turn in this time: 5.27h; without units of the mesh a bare number, G being 1")
      ->type_name("TIME")
      ->check(not_empty());
  command.add_option("--omega", options.omega, "The same as an angular rate: 3.3e-4rad/s, instead of --period")
      ->type_name("RATE")
      ->check(not_empty());
  command
      .add_option("--spin", options.axis,
                  fmt::format("Axis that it spins about, through {}: x, y, z or X,Y,Z (default: the axis of the "
                              "largest moment of inertia)",
                              through))
      ->type_name("AXIS")
      ->check(not_empty());
}

std::optional<Measure> stated_mass(const SpinOptions& options) {
  if (options.mass.empty()) return std::nullopt;
  return parse_measure("--mass", options.mass, Dimension::mass);
}

std::optional<Measure> spin_rate(const SpinOptions& options, std::vector<std::string>& notes) {
  if (!options.period.empty() && !options.omega.empty())
    throw Error(Fault::bad_argument, "--omega and --period both say how fast the body turns; leave one out");
  if (!options.period.empty()) {
    Measure period = parse_measure("--period", options.period, Dimension::time);
    if (!(period.value > 0))
      throw Error(Fault::bad_argument, fmt::format("--period {}: it must be above 0", options.period));
    period.value = 2 * std::numbers::pi / period.value;
    return period;
  }
  if (options.omega.empty()) return std::nullopt;
  const Measure omega = parse_measure("--omega", options.omega, Dimension::angular_rate);
  if (!(omega.value > 0))
    throw Error(Fault::bad_argument,
                fmt::format("--omega {}: it must be above 0; it counts about --spin", options.omega));
  if (omega.unit == "Hz" || omega.unit == "/s")
    notes.push_back(
        fmt::format("--omega {} is read as an angular frequency, 1 Hz being 1 rad/s; --period says the time of a turn",
                    options.omega));
  return omega;
}

std::optional<Vec3> spin_axis(const SpinOptions& options) {
  if (options.axis.empty()) return std::nullopt;
  return parse_axis("--spin", options.axis);
}

} // namespace cowgpu::cli

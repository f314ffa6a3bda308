#include "host/cli/physics.hpp"

#include "host/error.hpp"
#include "host/report/beside_paper.hpp"
#include "host/requests/radiate.hpp"

#include <fmt/format.h>

#include <numbers>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string axis = "y", omega, period, start = "12Myr", age = "13.787Gyr";
  bool octupole = false;
};

double check_rate(double omega, const char* option, const std::string& text) {
  if (!(omega >= slowest_turn))
    throw Error(Fault::bad_argument,
                fmt::format("{} {}: {:.3g} rad/s is slower than a turn in 400 Gyr, {} rad/s, which is as slow as this "
                            "goes",
                            option, text, omega, slowest_turn));
  return omega;
}

double parse_omega(const Options& options, std::vector<std::string>& notes) {
  if (!options.period.empty()) {
    if (!options.omega.empty())
      throw Error(Fault::bad_argument, "--omega and --period both say how fast the body turns; leave one out");
    const double period = parse_quantity("--period", options.period, Dimension::time, "24h").value;
    if (!(period > 0)) throw Error(Fault::bad_argument, fmt::format("--period {}: it must be above 0", options.period));
    return check_rate(2 * std::numbers::pi / period, "--period", options.period);
  }
  const std::string text = options.omega.empty() ? "1rad/s" : options.omega;
  const Measure omega = parse_quantity("--omega", text, Dimension::angular_rate, "1rad/s, 3rpm or 1Hz");
  if (!(omega.value > 0))
    throw Error(Fault::bad_argument, fmt::format("--omega {}: it must be above 0; turn --axis round for the other "
                                                 "sense, which radiates the same",
                                                 text));
  if (omega.unit == "Hz" || omega.unit == "/s")
    notes.push_back(fmt::format("{} is read as an angular frequency, 1 Hz being 1 rad/s, as the paper has it; --period "
                                "1s is one turn a second",
                                text));
  return check_rate(omega.value, "--omega", text);
}

double parse_time(const Options& options) {
  const double start = parse_quantity("--start", options.start, Dimension::time, "12Myr").value;
  const double age = parse_quantity("--age", options.age, Dimension::time, "13.787Gyr").value;
  if (!(start >= 0) || !(age >= start))
    throw Error(Fault::bad_argument,
                fmt::format("--start {} --age {}: both count from the Big Bang, and the start comes "
                            "first",
                            options.start, options.age));
  return age - start;
}

// The paper turns its cow about y at 1 Hz, from 12 Myr to now.
Options paper_options(const Options& options) {
  const Options fresh;
  if (options.axis != fresh.axis || !options.omega.empty() || !options.period.empty() || options.start != fresh.start ||
      options.age != fresh.age)
    throw Error(Fault::bad_argument, "--recipe paper sets axis, spin and times as the paper has them: leave --axis, "
                                     "--omega, --period, --start and --age out");
  Options paper = options;
  paper.omega = "1Hz";
  return paper;
}

RadiateRequest request_of(const PhysicsCall& call, const Options& options) {
  RadiateRequest request;
  request.body = call.body;
  request.axis = parse_axis("--axis", options.axis);
  request.omega = parse_omega(options, request.notes);
  request.time = parse_time(options);
  request.octupole = options.octupole;
  return request;
}

} // namespace

Solve add_radiate(Command& command, Common&, BodyOptions&) {
  const auto options = std::make_shared<Options>();
  command.add_option("--axis", options->axis, "Through the centre of mass: x, y, z or X,Y,Z in the body's axes")
      ->type_name("AXIS")
      ->capture_default_str();
  command
      .add_option(
          "--omega", options->omega,
          "Angular frequency with its unit: 90deg/s, 3rpm; 1Hz and 1/s are 1 rad/s, as in the paper; without this "
          "option 1rad/s")
      ->type_name("RATE");
  command.add_option("--period", options->period, "Time of one turn with its unit, such as 1s, instead of --omega")
      ->type_name("TIME");
  command.add_option("--start", options->start, "When it began to turn, after the Big Bang (Julian years)")
      ->type_name("TIME")
      ->capture_default_str();
  command.add_option("--age", options->age, "When the spin is asked for, after the Big Bang")
      ->type_name("TIME")
      ->capture_default_str();
  command.add_flag("--octupole", options->octupole,
                   "Also the mass octupole and the current quadrupole, from the mesh's exact third moments");
  return [options](const PhysicsCall& call) {
    ConsoleMonitor monitor(ProgressStyle::none);
    const RadiationResult result = radiate(request_of(call, call.paper ? paper_options(*options) : *options), monitor);
    physics::Findings found = findings(result);
    if (call.paper) found.paper = beside_paper(result);
    return found;
  };
}

} // namespace cowgpu::cli

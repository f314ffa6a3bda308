#include "host/cli/quantities.hpp"

#include "host/cli/commands.hpp"
#include "host/error.hpp"
#include "host/number.hpp"
#include "host/requests/convert.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <numbers>

namespace cowgpu::cli {

using physics::LongMat3;

Vec3 parse_axis(const std::string& option, const std::string& text) {
  for (int c = 0; c < 3; ++c)
    for (const double sign : {1, -1})
      if (text == (sign > 0 ? "" : "-") + std::string(1, char('x' + c))) return sign * Vec3::Unit(c);
  const auto axis = parse_point(text);
  if (!axis)
    throw Error(Fault::bad_argument, fmt::format("{} {}: it takes x, y, z or three numbers X,Y,Z", option, text));
  if (!(axis->stableNorm() > 0))
    throw Error(Fault::bad_argument, fmt::format("{} {}: an axis of zero length has no direction", option, text));
  return *axis / axis->stableNorm();
}

Measure parse_quantity(const std::string& option, const std::string& text, Dimension dimension, const char* example) {
  const Measure measure = parse_measure(option, text, dimension);
  if (!measure.has_unit)
    throw Error(Fault::bad_argument, fmt::format("{} {}: it needs a unit, as in {}", option, text, example));
  return measure;
}

double parse_positive(const std::string& option, const std::string& text, Dimension dimension, const char* example) {
  const double value = parse_quantity(option, text, dimension, example).value;
  if (!(value > 0)) throw Error(Fault::bad_argument, fmt::format("{} {}: it must be above 0", option, text));
  return value;
}

double parse_length_unit(const std::string& text) {
  const bool bare = !text.empty() && std::isalpha(static_cast<unsigned char>(text.front())) != 0; // "mm" is one of them
  const Measure unit = parse_measure("--length-unit", (bare ? "1" : "") + text, Dimension::length);
  if (!unit.has_unit)
    throw Error(
        Fault::bad_argument,
        fmt::format("--length-unit {}: it needs a unit; it is the length that 1 in the file stands for, such as mm, km "
                    "or 2.3m",
                    text));
  if (!(unit.value > 0)) throw Error(Fault::bad_argument, fmt::format("--length-unit {}: it must be above 0", text));
  return unit.value;
}

void add_length_unit_option(Command& command, std::string& text, const char* of) {
  command
      .add_option(
          "--length-unit", text,
          fmt::format("The length that 1 stands for in {}, where the file does not say it (.sh and gravity tables: "
                      "metres are assumed) or has it from its mesh: km, 2.3m ...",
                      of))
      ->type_name("LENGTH")
      ->check(not_empty());
}

std::optional<double> stated_metres(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional(parse_length_unit(text));
}

void note_unit(const std::string& option, const std::string& text, Dimension dimension,
               std::vector<std::string>& notes) {
  const std::string_view stands_for = meaning(parse_measure(option, text, dimension).unit);
  if (!stands_for.empty()) notes.push_back(fmt::format("{} {}: {}", option, text, stands_for));
}

Eigen::Matrix3d parse_rotation(const std::string& option, const std::string& text) {
  const auto angles = parse_point(text);
  if (!angles)
    throw Error(Fault::bad_argument,
                fmt::format("{} {}: it takes three angles ALPHA,BETA,GAMMA in degrees, of the rotation "
                            "R_z(ALPHA) R_y(BETA) R_z(GAMMA)",
                            option, text));
  // Whole turns are left out exactly, and multiples of 90 degrees stay exact.
  const Vec3 turns = angles->unaryExpr([](double a) { return std::remainder(a, 360.0); }) / 180 * std::numbers::pi;
  return rotation_matrix({turns[0], turns[1], turns[2]});
}

LongMat3 parse_turn(const std::string& option, const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) {
    const LongMat3 r = parse_rotation(option, text).cast<long double>();
    return r * (3 * LongMat3::Identity() - r.transpose() * r) / 2; // Newton's step to the orthogonal matrix next to it
  }
  const Vec3 axis = parse_axis(option, text.substr(0, colon));
  std::string number = text.substr(colon + 1);
  if (number.ends_with("deg")) number.resize(number.size() - 3);
  const auto degrees = read_number(number);
  if (!degrees)
    throw Error(Fault::bad_argument,
                fmt::format("{} {}: after the axis it takes an angle in degrees, as in x:30", option, text));
  return physics::turn_about(axis, *degrees);
}

physics::PointMass parse_point_mass(const std::string& option, const std::string& text) {
  for (const physics::PointMass* known : {&physics::earth, &physics::moon, &physics::sun})
    if (text == known->name) return *known;
  try {
    const double mass = parse_positive(option, text, Dimension::mass, "5.97e24kg");
    return {"", mass * gravitational_constant_si, 0};
  } catch (const Error& error) {
    throw Error(error.fault(), fmt::format("{}; earth, moon and sun are known by name", error.what()));
  }
}

} // namespace cowgpu::cli

// Words of the command line that stand for quantities: axes, rotations, numbers with units, masses in the sky.
#pragma once

#include "host/cli/command_line.hpp"
#include "host/requests/tides.hpp"
#include "host/types.hpp"
#include "host/units.hpp"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace cowgpu::cli {

/// "x", "y", "z", these with a minus sign, or "X,Y,Z": of length 1. Throws Error(bad_argument).
Vec3 parse_axis(const std::string& option, const std::string& text);

/// A measure that must have a unit; `example` shows one. Throws Error(bad_argument).
Measure parse_quantity(const std::string& option, const std::string& text, Dimension dimension, const char* example);

/// The same where it must also be above 0.
double parse_positive(const std::string& option, const std::string& text, Dimension dimension, const char* example);

/// What --length-unit says: a length with its unit, or a unit alone ("km"), in metres. Throws Error(bad_argument).
double parse_length_unit(const std::string& text);

/// Adds --length-unit to a command that reads files of coefficients; `of` names them in the help: "IN". Its text goes to
/// read_in_unit() by way of stated_metres(), which is empty where the option is not given.
void add_length_unit_option(Command& command, std::string& text, const char* of);
std::optional<double> stated_metres(const std::string& text);

/// Adds to the notes what the text's unit stands for, where that is not the same everywhere: R_earth.
void note_unit(const std::string& option, const std::string& text, Dimension dimension,
               std::vector<std::string>& notes);

/// "ALPHA,BETA,GAMMA" in degrees as R_z(ALPHA) R_y(BETA) R_z(GAMMA); multiples of 90 are exact. Throws Error(bad_argument).
Eigen::Matrix3d parse_rotation(const std::string& option, const std::string& text);

/// The same, or "AXIS:ANGLE" with parse_axis() and degrees, orthogonal in extended precision.
physics::LongMat3 parse_turn(const std::string& option, const std::string& text);

/// "earth", "moon", "sun", or a mass with its unit. Throws Error(bad_argument).
physics::PointMass parse_point_mass(const std::string& option, const std::string& text);

} // namespace cowgpu::cli

// The unit of length of coefficient files that do not say it.
#pragma once

#include "host/coefficient_set.hpp"

#include <optional>
#include <string>

namespace cowgpu {

/// Gives a potential whose file does not say its units (units_stated is false; R and GM as they stand there) metres and
/// kilograms: R in the unit, GM in its cube per square second. The unit is `metres` long where the user states it. Without that
/// it is the metre, but the kilometre where R and GM are in kilometres those of a body that is known (the Sun, planets, their
/// moons, asteroids that were visited; GM within 1 %, R within 2 %, of small bodies 10 and 60 %). A note says what was taken and
/// how to state another; none where `format_says_metres` and metres were taken.
void settle_length_unit(CoefficientSet& set, std::optional<double> metres, bool format_says_metres);

/// Gives coefficients whose lengths are in the unit of a mesh metres and kilograms: the unit is `metres` long, densities are
/// in kg/m^3. Multipoles, mass, second moment, GM, radius, origin, and fields that are lengths are scaled. Throws
/// Error(bad_argument), which begins with the option --length-unit and `file`, for coefficients that are in metres already or
/// that hold no length.
void state_length_unit(CoefficientSet& set, double metres, const std::string& file);

} // namespace cowgpu

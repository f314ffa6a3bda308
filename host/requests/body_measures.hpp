// A mass that is stated in place of a density, rates of spins, and measures that go with a body's units.
#pragma once

#include "host/requests/load_body.hpp"
#include "host/units.hpp"

#include <optional>

namespace cowgpu {

/// Throws Error(bad_argument) for a mass that is not above 0, one beside a density, and one of a body with parts.
void check_mass(const BodyRequest& body, const std::optional<Measure>& mass);

/// Throws Error(bad_argument) for a rate that is not from 1e-50 to 1e50.
void check_spin_rate(const Measure& rate);

/// A number of a body with units has one, and of a body without has none: throws Error(bad_argument), naming `option` and giving
/// `example`, where it does not.
void check_unit(const char* option, const Measure& measure, bool stated, const char* example);

/// Gives a body without parts the density that makes it weigh so much. Throws what check_unit() throws, and Error(bad_argument) for
/// a density that is out of the range from 1e-50 to 1e50.
void weigh(const Measure& mass, Body& body);

} // namespace cowgpu

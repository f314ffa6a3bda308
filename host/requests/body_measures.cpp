#include "host/requests/body_measures.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

namespace cowgpu {

void check_mass(const BodyRequest& body, const std::optional<Measure>& mass) {
  if (!mass) return;
  if (body.density)
    throw Error(Fault::bad_argument, "--mass and --density both say how heavy the body is; leave one out");
  if (!body.parts.empty())
    throw Error(Fault::bad_argument,
                "--mass says the mass of a body of one density, and --part adds others: give --density in its place");
  if (!(mass->value > 0)) throw Error(Fault::bad_argument, fmt::format("--mass {}: it must be above 0", mass->value));
}

void check_spin_rate(const Measure& rate) {
  if (!(rate.value >= 1e-50) || !(rate.value <= 1e50))
    throw Error(Fault::bad_argument,
                fmt::format("a body that turns at {} rad/s: the rate must be from 1e-50 to 1e50", rate.value));
}

void check_unit(const char* option, const Measure& measure, bool stated, const char* example) {
  if (measure.has_unit && !stated)
    throw Error(
        Fault::bad_argument,
        fmt::format("{} with the unit {} needs the mesh's unit of length: add --length-unit or --length, or give "
                    "a bare number in the mesh's units with G = 1",
                    option, measure.unit));
  if (!measure.has_unit && stated)
    throw Error(Fault::bad_argument, fmt::format("{}: it needs a unit, as in {}", option, example));
}

void weigh(const Measure& mass, Body& body) {
  check_unit("--mass", mass, body.placement.units.stated, "6.69e15kg");
  const double density = mass.value / body.volume;
  if (!(density >= 1e-50) || !(density <= 1e50))
    throw Error(
        Fault::bad_argument,
        fmt::format("--mass {}: of a volume of {:.6g} that is a density of {:.3g}, out of the range from 1e-50 to 1e50",
                    mass.value, body.volume, density));
  body.density = density;
}

} // namespace cowgpu

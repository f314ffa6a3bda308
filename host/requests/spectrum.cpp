#include "host/requests/spectrum.hpp"

#include "host/error.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/shown.hpp"
#include "host/report/document_parts.hpp"
#include "host/spectrum/power.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace cowgpu {

SpectrumResult spectrum(const SpectrumRequest& request) {
  const std::string input = request.input.string();
  CoefficientSet set = read_fields(request.input, request.metres);
  const SphereCoefficients a = field_coefficients(set, input);
  if (request.cross && a.fields != 2)
    throw Error(Fault::bad_argument, fmt::format("--cross takes a file of two fields; {} has {}", input, a.fields));
  SpectrumResult result;
  result.created = utc_now();
  result.input = input;
  result.lmax = a.lmax;
  for (int f = 0; f < a.fields; ++f) {
    const std::string& name = set.names[std::size_t(f)];
    result.fields.push_back({!name.empty()   ? name
                             : a.fields == 1 ? "field"
                                             : fmt::format("field_{}", f + 1),
                             power(a, f)});
  }
  for (const PowerSpectrum& field : result.fields)
    if (!std::isfinite(field.total()))
      throw Error(Fault::file_format,
                  fmt::format("{}: the squares of the coefficients of {} overflow double precision; "
                              "scale the field down",
                              input, shown(field.name)));
  if (request.cross) result.cross = {result.fields[0].name + " and " + result.fields[1].name, cross_power(a, 0, a, 1)};
  result.notes = std::move(set.notes);
  return result;
}

} // namespace cowgpu

#include "host/report/expansion_file.hpp"

#include "host/error.hpp"
#include "host/io/document_json.hpp"
#include "host/report/coefficient_sets.hpp"
#include "host/spectrum/convert.hpp"

#include <fmt/format.h>

namespace cowgpu {

void check_expansion_file(const std::string& path, bool mass, std::size_t surfaces) {
  const CoefficientFormat format = coefficient_format(path);
  if (format == CoefficientFormat::json || format == CoefficientFormat::csv) return;
  const auto refuse = [&](const char* sentence) {
    throw Error(Fault::bad_argument, fmt::format("-o {}: {}", path, sentence));
  };
  if (surfaces > 0 && format == CoefficientFormat::gfc)
    refuse("a .gfc file holds the gravity field of a body, and --of asks for surfaces; .json, .csv and .nc hold them");
  if (surfaces > 0 && format == CoefficientFormat::shtools)
    refuse("a .sh file holds one field, and a surface has six; .json, .csv and .nc hold them, and `cowgpu convert "
           "--field` takes one of them out");
  if (surfaces + (mass ? 1 : 0) > 1)
    refuse("a .nc file holds one expansion, and --of asks for several; .json and .csv hold them all");
}

void write_expansion(const ExpandResult& result, CoefficientFormat format, AtomicFile& file, const Monitor& monitor) {
  const Sink sink = [&](std::string_view text) {
    check_stop(monitor);
    file.write(text);
  };
  if (format == CoefficientFormat::json) return write_json(document(result), sink);
  if (format == CoefficientFormat::csv) return write_csv(result, sink);
  ConversionTarget target;
  target.form = Form::real;
  if (result.has_mass) {
    target.kind = CoefficientKind::potential;
    target.normalisation = Normalisation::four_pi;
    target.phase = Phase::none;
  }
  const CoefficientSet set = result.has_mass ? mass_set(result) : surface_set(result, result.surfaces.front());
  write_coefficient_set(converted(set, target), format, file);
}

} // namespace cowgpu

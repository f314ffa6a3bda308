#include "host/requests/diff.hpp"

#include "host/bounds.hpp"
#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/length_unit.hpp"
#include "host/report/document_parts.hpp"
#include "host/spectrum/convert.hpp"

namespace cowgpu {
namespace {

// The expansion and the unit are for the one of both files, or for both, that they are about.
CoefficientSet read(const DiffRequest& request, const std::filesystem::path& path, bool& unit_used) {
  CoefficientSet set = read_coefficient_set(path, can_hold_expansions(path) ? request.of : "", request.metres);
  const bool metric = set.units_stated && set.in_metres();
  if (request.metres && set.units_stated && !metric && !set.length_unit.empty())
    state_length_unit(set, *request.metres, path.string());
  unit_used = unit_used || !metric;
  return request.field.empty() || set.fields == 1 ? set : single_field(set, request.field);
}

} // namespace

DiffResult diff(const DiffRequest& request) {
  require_member("the normalisation is", request.convention.normalisation, Normalisation::unnormalised);
  require_member("the phase is", request.convention.phase, Phase::none);
  require_not_negative("the tolerance is", request.tolerance.value_or(0));
  bool unit_used = false;
  const CoefficientSet a = read(request, request.first, unit_used), b = read(request, request.second, unit_used);
  if (request.metres && !unit_used) throw Error(Fault::bad_argument, "--length-unit: both files are in metres already");
  DiffResult result;
  result.created = utc_now();
  result.first = request.first.string();
  result.second = request.second.string();
  result.tolerance = request.tolerance;
  for (const std::string& note : a.notes) result.notes.push_back("A: " + note);
  for (const std::string& note : b.notes) result.notes.push_back("B: " + note);
  result.difference = difference(a, b, request.convention);
  return result;
}

} // namespace cowgpu

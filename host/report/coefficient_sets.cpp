#include "host/report/coefficient_sets.hpp"

#include "host/io/number.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

namespace cowgpu {

Provenance provenance_of(const ExpandResult& result) {
  Provenance from;
  from.program = fmt::format("cowgpu {}", version);
  from.created = result.created;
  from.command = fmt::format("{}", fmt::join(result.command, " "));
  from.mesh = result.body.surface.mesh().name;
  from.mesh_sha256 = result.body.surface.mesh().sha256;
  return from;
}

std::string length_unit(const Body& body) {
  return body.units().stated ? "m" : std::string(mesh_length_unit);
}

std::string mass_unit(const Body& body) {
  return body.units().stated ? "kg" : std::string(mesh_mass_unit);
}

double second_moment_of(const ExpandResult& result) {
  const auto& moments = result.tensors.second_moment;
  return moments(0, 0) + moments(1, 1) + moments(2, 2);
}

CoefficientSet mass_set(const ExpandResult& result) {
  const Multipoles& q = result.mass;
  CoefficientSet set(q.lmax, 1);
  set.kind = CoefficientKind::multipoles;
  set.form = Form::complex;
  for (int l = 0; l <= q.lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      set.first[set.index(0, l, m)] = q(l, m).real();
      set.second[set.index(0, l, m)] = q(l, m).imag();
    }
  set.names = {mass_expansion};
  set.reference_radius = q.reference_radius;
  set.brillouin_radius = result.body.brillouin_radius;
  set.origin = q.origin;
  set.origin_kind = result.body.origin_kind;
  if (result.body.parts.empty()) set.density = q.density;
  set.second_moment = second_moment_of(result);
  set.length_unit = length_unit(result.body);
  set.mass_unit = mass_unit(result.body);
  set.provenance = provenance_of(result);
  return set;
}

CoefficientSet surface_set(const ExpandResult& result, const SurfaceResult& surface) {
  const SurfaceExpansion& expansion = surface.expansion;
  const SphereCoefficients& a = expansion.coefficients;
  CoefficientSet set(a.lmax, a.fields);
  set.form = Form::complex;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    set.first[i] = a.values[i].real();
    set.second[i] = a.values[i].imag();
  }
  for (std::size_t f = 0; f < set.names.size(); ++f) {
    set.names[f] = surface_field_names[f];
    set.units[f] = set.names[f] == "f_dtheta" || set.names[f] == "f_dphi" ? "radian" : "length";
  }
  set.origin = expansion.origin;
  set.origin_kind = surface.origin_kind;
  set.length_unit = length_unit(result.body);
  set.provenance = provenance_of(result);
  set.remarks = {{"map", std::string(name(surface.map.method))}, {"recipe", surface.recipe}};
  for (const auto& [field, mean] :
       {std::pair("f_dtheta", expansion.mean_dtheta), std::pair("f_dphi", expansion.mean_dphi)}) {
    std::string text;
    append_number(text, mean);
    set.remarks.emplace_back(std::string("removed_mean_") + field, text);
  }
  return set;
}

} // namespace cowgpu

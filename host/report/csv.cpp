#include "host/io/coefficient_metadata.hpp"
#include "host/io/number.hpp"
#include "host/io/shown.hpp"
#include "host/report/coefficient_sets.hpp"
#include "host/report/result.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

namespace cowgpu {
namespace {

std::string numbers(const Vec3& v) {
  std::string text;
  for (int c = 0; c < 3; ++c) {
    if (c > 0) text += " ";
    append_number(text, v[c]);
  }
  return text;
}

std::string mass_comments(const ExpandResult& result) {
  const Multipoles& q = result.mass;
  std::string text =
      "# Q_lm / R^l, Q_lm = integral of density r^l Y_lm, not conjugated; orthonormal, Condon-Shortley phase;\n"
      "# theta from +z, phi from +x towards +y, axes of the mesh; Q_l,-m = (-1)^m conj Q_lm\n";
  text += "# lmax " + std::to_string(q.lmax) + "\n# reference_radius ";
  append_number(text, q.reference_radius);
  text += "\n# brillouin_radius ";
  append_number(text, result.body.brillouin_radius);
  text += "\n# density ";
  append_number(text, q.density);
  text += "\n# second_moment ";
  append_number(text, second_moment_of(result));
  text += "\n";
  const ErrorEstimate& estimate = result.accuracy.estimate;
  for (const std::string& sentence : sentences(estimate)) text += "# accuracy: " + sentence + "\n";
  if (!estimate.error.empty()) text += fmt::format("# error_estimate {:.3e}\n", fmt::join(estimate.error, ","));
  for (const Part& part : result.body.parts) {
    text += fmt::format("# part {}, sha256 {}: adds the density ", one_line(part.surface.mesh().name),
                        part.surface.mesh().sha256);
    append_number(text, part.density);
    text += "\n";
  }
  return text + fmt::format("# origin ({}) {}\n", result.body.origin_kind, numbers(q.origin));
}

std::string surface_comments(const SurfaceResult& surface) {
  const SurfaceExpansion& e = surface.expansion;
  std::string text =
      fmt::format("# {}: map {}{}, recipe {}; dphi {}\n# {}_origin ({}) {}\n", name(surface.of),
                  name(surface.map.method), surface.map_file.empty() ? "" : " " + surface.map_file, surface.recipe,
                  e.signed_dphi ? "signed" : "absolute", name(surface.of), surface.origin_kind, numbers(e.origin));
  for (const auto& [field, mean] : {std::pair("f_dtheta", e.mean_dtheta), std::pair("f_dphi", e.mean_dphi)}) {
    text += fmt::format("# {}_removed_mean_{} ", name(surface.of), field);
    append_number(text, mean);
    text += "\n";
  }
  return text;
}

void append_pair(std::string& text, std::complex<double> value) {
  text += ",";
  append_number(text, value.real());
  text += ",";
  append_number(text, value.imag());
}

} // namespace

void write_csv(const ExpandResult& result, const Sink& sink) {
  std::string text = "# cowgpu " + std::string(version) + ", " + result.created + "\n";
  CoefficientSet facts(0, 1);
  facts.length_unit = length_unit(result.body);
  if (result.has_mass) facts.mass_unit = mass_unit(result.body);
  facts.provenance = provenance_of(result);
  text += comment_lines(facts, {"lmax"}) + "# " + one_line(mesh_line(result.body.surface.mesh())) +
          "\n# device: " + device_line(result.device) + "\n";
  std::string columns = "l,m";
  if (result.has_mass) {
    text += mass_comments(result);
    columns += result.surfaces.empty() ? ",re,im" : ",mass_re,mass_im";
  }
  const int lmax = result.has_mass ? result.mass.lmax : result.surfaces.front().expansion.coefficients.lmax;
  if (!result.surfaces.empty()) {
    text += "# of surfaces: a_lm of fields f = sum a_lm Y_lm over the sphere of a map; orthonormal, Condon-Shortley "
            "phase;\n# f_r, x, y, z in " +
            result.surfaces.front().length_unit + ", f_dtheta and f_dphi in radians; a_l,-m = (-1)^m conj a_lm\n";
    if (!result.has_mass) text += fmt::format("# lmax {}\n", lmax);
  }
  for (const SurfaceResult& surface : result.surfaces) {
    text += surface_comments(surface);
    for (const char* field : surface_field_names)
      columns += fmt::format(",{0}_{1}_re,{0}_{1}_im", name(surface.of), field);
  }
  text += columns + "\n";
  for (int l = 0; l <= lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      text += std::to_string(l) + "," + std::to_string(m);
      if (result.has_mass) append_pair(text, result.mass(l, m));
      for (const SurfaceResult& surface : result.surfaces) {
        const SphereCoefficients& a = surface.expansion.coefficients;
        for (int f = 0; f < a.fields; ++f) append_pair(text, a.at(f, l, m));
      }
      text += "\n";
      if (text.size() > 65536) {
        sink(text);
        text.clear();
      }
    }
  sink(text);
}

} // namespace cowgpu

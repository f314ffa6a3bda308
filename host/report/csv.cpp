#include "host/io/number.hpp"
#include "host/report/result.hpp"
#include "host/version.hpp"

namespace cowgpu {

void write_csv(const ExpandResult& result, const Sink& sink) {
  const Coefficients& q = result.mass;
  std::string text = "# cowgpu " + std::string(version) + ", " + result.created + "\n";
  text += "# " + mesh_line(result.body.surface.mesh()) + "\n# device: " + device_line(result.device) + "\n";
  text += "# Q_lm / R^l, Q_lm = integral of density r^l Y_lm, not conjugated; orthonormal, Condon-Shortley phase;\n"
          "# theta from +z, phi from +x towards +y, axes of the mesh; Q_l,-m = (-1)^m conj Q_lm\n";
  text += "# lmax " + std::to_string(q.lmax) + "\n# reference_radius ";
  append_number(text, q.reference_radius);
  text += "\n# density ";
  append_number(text, q.density);
  text += "\n# origin (" + result.body.origin_kind + ") ";
  for (int c = 0; c < 3; ++c) {
    append_number(text, q.origin[c]);
    text += c < 2 ? " " : "\n";
  }
  text += "l,m,re,im\n";
  for (int l = 0; l <= q.lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      text += std::to_string(l) + "," + std::to_string(m) + ",";
      append_number(text, q(l, m).real());
      text += ",";
      append_number(text, q(l, m).imag());
      text += "\n";
      if (text.size() > 65536) {
        sink(text);
        text.clear();
      }
    }
  sink(text);
}

} // namespace cowgpu

#include "host/report/result.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace cowgpu {
namespace {

std::string vector_text(const Vec3& v) {
  return fmt::format("({:.12g}, {:.12g}, {:.12g})", v.x(), v.y(), v.z());
}

std::string complex_text(int m, std::complex<double> q) {
  if (m == 0) return fmt::format("{:+.6e}", q.real());
  return fmt::format("{:+.6e} {} {:.6e} i", q.real(), std::signbit(q.imag()) ? '-' : '+', std::abs(q.imag()));
}

// Raw Q_lm in two columns, as many degrees as the paper's first table has.
void write_table(const Multipoles& q, const Sink& sink) {
  std::vector<std::string> rows;
  for (int l = 0; l <= std::min(q.lmax, 4); ++l)
    for (int m = 0; m <= l; ++m)
      rows.push_back(
          fmt::format("{:>3} {:>3}  {:<36}", l, m, complex_text(m, q(l, m) * std::pow(q.reference_radius, l))));
  const std::size_t half = (rows.size() + 1) / 2;
  sink(fmt::format("  {:>3} {:>3}  {:<36}", "l", "m", "Q_lm"));
  sink(rows.size() > 1 ? fmt::format("{:>3} {:>3}  Q_lm\n", "l", "m") : "\n");
  for (std::size_t i = 0; i < half; ++i) {
    std::string line = "  " + rows[i] + (i + half < rows.size() ? rows[i + half] : "");
    line.erase(line.find_last_not_of(' ') + 1);
    sink(line + "\n");
  }
}

void write_matrix(const char* name, const Eigen::Matrix3d& matrix, const Sink& sink) {
  for (int row = 0; row < 3; ++row)
    sink(fmt::format("  {:<26} {:+.12e} {:+.12e} {:+.12e}\n", row == 0 ? name : "", matrix(row, 0), matrix(row, 1),
                     matrix(row, 2)));
}

// The largest error beside its degree's norm, which may be 0.
std::string relative_text(const Agreement& agreement) {
  const DegreeErrors& errors = agreement.errors;
  const std::size_t l = std::size_t(errors.degree);
  if (errors.difference[l] > 0 && errors.norm[l] == 0)
    return fmt::format("{:.1e} in degree {}, exactly zero by {}", errors.difference[l], l, agreement.against);
  return fmt::format("{:.1e} of degree {}", errors.relative(), l);
}

void write_accuracy(const ExpandResult& result, const Sink& sink) {
  const Accuracy& accuracy = result.accuracy;
  if (accuracy.how == Verify::none) {
    sink("accuracy: not checked (--verify none)\n");
    return;
  }
  for (const std::string& sentence : sentences(accuracy.estimate)) sink("accuracy: " + sentence + "\n");
  for (const Agreement& a : accuracy.agreements)
    sink(fmt::format("accuracy: {} against {}: {}, {:.2g} of its estimated error (bound {:.0f}: {})\n", a.path,
                     a.against, relative_text(a), a.errors.ratio, Accuracy::bound,
                     a.errors.ratio <= Accuracy::bound ? "passed" : "FAILED"));
  sink(fmt::format(
      "accuracy: compared on {} triangles{}, degrees 0 to {}\n", accuracy.triangles,
      accuracy.triangles < result.body.surface.faces().size() ? fmt::format(" (sample, seed {})", accuracy.seed) : "",
      result.mass.lmax));
}

void write_computed(const ExpandResult& result, const Sink& sink) {
  const Multipoles& q = result.mass;
  sink(fmt::format(
      "computed: mass multipoles to degree {}, {} coefficients, in {:.3f} s ({} pairs of triangles, {:.1f} % of "
      "the work after the cut-off {:.0e})\n",
      q.lmax, q.values.size(), result.run.seconds, result.run.pairs,
      100 * std::min(1.0, result.run.elements / result.run.full_elements), result.cut_off));
}

void write_body(const Body& body, const Sink& sink) {
  const bool metric = body.units().stated;
  sink(fmt::format("\nbody, in {}, density {:.17g}{}\n",
                   metric ? "metres and kilograms" : "the mesh's length unit and axes", body.density,
                   metric ? " kg/m3" : ""));
  for (const Part& part : body.parts)
    sink(fmt::format("  {:<26} density {:+.15g}, volume {:.15g}, mass {:.15g}\n", "part " + part.surface.mesh().name,
                     part.density, part.volume, part.mass()));
  sink(fmt::format("  {:<26} {:.15g}\n", body.parts.empty() ? "volume" : "volume without parts", body.volume));
  sink(fmt::format("  {:<26} {:.15g}\n", body.parts.empty() ? "mass" : "mass, parts included", body.mass()));
  sink(fmt::format("  {:<26} {:.15g}\n", "area", body.area));
  sink(fmt::format("  {:<26} {}\n", "centre of mass",
                   body.centre_of_mass.allFinite() ? vector_text(body.centre_of_mass) : "none: the masses cancel"));
  sink(fmt::format("  {:<26} {} ({})\n", "origin", vector_text(body.origin), body.origin_kind));
  sink(fmt::format("  {:<26} {:.15g}\n", "Brillouin radius R", body.brillouin_radius));
}

void write_leading(const ExpandResult& result, const Sink& sink) {
  sink("\nleading mass multipoles Q_lm = integral of density r^l Y_lm about the origin: raw (not divided by R^l), in ");
  sink(result.body.units().stated ? "kg m^l" : "mesh units");
  sink(",\nnot conjugated; Y_lm orthonormal with the Condon-Shortley phase, polar axis z; Q_l,-m = (-1)^m conj "
       "Q_lm\n");
  write_table(result.mass, sink);
}

} // namespace

void write_screen(const ExpandResult& result, const Sink& sink) {
  sink(mesh_line(result.body.surface.mesh()) + "\n");
  for (const std::string& note : result.notes) sink("note: " + note + "\n");
  if (result.has_mass) write_computed(result, sink);
  sink("device: " + device_line(result.device) + "\n");
  if (result.has_mass) write_accuracy(result, sink);
  const Timings& t = result.timings;
  sink(fmt::format(
      "time: load {:.3f} s, device {:.3f} s, moments {:.3f} s, check {:.3f} s, surfaces {:.3f} s, in all {:.3f} s\n",
      t.load, t.device, t.moments, t.verify, t.surfaces, t.total));

  write_body(result.body, sink);
  if (result.has_mass) write_leading(result, sink);
  sink("\ntensors about the origin\n");
  write_matrix("quadrupole 3 x x - r^2", result.tensors.quadrupole, sink);
  write_matrix("inertia r^2 - x x", result.tensors.inertia, sink);
  for (const SurfaceResult& surface : result.surfaces) write_surface_screen(surface, sink);
}

} // namespace cowgpu

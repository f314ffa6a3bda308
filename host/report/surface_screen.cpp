#include "host/report/surface_result.hpp"

#include "host/spectrum/paper_harmonic.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

std::string coefficient_text(std::complex<double> value) {
  return fmt::format("{:+.4f}{:+.4f}i", value.real(), value.imag());
}

void write_beside_paper(const SurfaceExpansion& expansion, const std::function<void(std::string_view)>& sink) {
  sink(
      "\nbeside the paper's table (Higher multipoles of the cow, harmonic map; the means of the angles are dropped)\n");
  sink(fmt::format("  {:>2} {:>2}", "l", "m"));
  for (int f = 0; f < 3; ++f) sink(fmt::format("  {:<16} {:<16}", surface_field_names[std::size_t(f)], "paper"));
  sink("\n");
  for (const PaperRow& row : paper_harmonic_table()) {
    std::string line = fmt::format("  {:>2} {:>2}", row.l, row.m);
    for (int f = 0; f < 3; ++f)
      line += fmt::format("  {:<16} {:<16}", coefficient_text(expansion.coefficients.at(f, row.l, row.m)),
                          coefficient_text(row.values[std::size_t(f)]));
    sink(line + "\n");
  }
  const auto misfits = paper_misfits(expansion);
  sink(fmt::format("misfit sqrt(sum |c - t|^2 / sum |t|^2), l >= 1: f_r {:.4f}, f_dtheta {:.4f}, f_dphi {:.4f}\n",
                   misfits[0], misfits[1], misfits[2]));
}

} // namespace

void write_surface_screen(const SurfaceResult& result, bool beside_paper,
                          const std::function<void(std::string_view)>& sink) {
  const SurfaceExpansion& expansion = result.expansion;
  const SphereCoefficients& a = expansion.coefficients;
  const Vec3& o = expansion.origin;
  sink(fmt::format("\nsurface over the {} map{}, recipe {}, to degree {}: {} coefficients of each of six fields\n",
                   result.name, result.map_file.empty() ? "" : " of " + result.map_file, result.recipe, a.lmax,
                   SphereCoefficients::count(a.lmax)));
  for (const std::string& note : result.map.notes) sink("  map: " + note + "\n");
  for (const std::string& sentence : result.quality.sentences) sink("  map: " + sentence + "\n");
  sink(fmt::format("  origin ({:.9g}, {:.9g}, {:.9g}) ({}); grid of {} rings of {} points, looked up {}\n", o.x(),
                   o.y(), o.z(), result.origin_kind, result.report.rings, result.report.ring_length,
                   result.closest_point ? "at the closest point" : "along the ray"));
  sink(fmt::format("  time: map {:.3f} s, sample {:.3f} s, analyse {:.3f} s\n", result.map_seconds,
                   result.report.sample_seconds, result.report.analyse_seconds));
  sink(fmt::format("  means removed: f_dtheta {:.9g}, f_dphi {:.9g} radians; f_dphi is {}\n", expansion.mean_dtheta,
                   expansion.mean_dphi, expansion.signed_dphi ? "signed" : "absolute"));
  if (!result.report.aliasing.empty()) {
    const auto& top = result.report.aliasing.back();
    sink(fmt::format("  aliasing, bounded by a grid of half the rings, at degree {}: f_r {:.1e}, x {:.1e}, y {:.1e}, "
                     "z {:.1e}\n",
                     a.lmax, top[0], top[3], top[4], top[5]));
  }
  std::string head = fmt::format("  {:>2} {:>2}", "l", "m");
  for (const char* field : surface_field_names) head += fmt::format("  {:<16}", field);
  sink(head + "\n");
  for (int l = 0; l <= std::min(a.lmax, 3); ++l)
    for (int m = 0; m <= l; ++m) {
      std::string line = fmt::format("  {:>2} {:>2}", l, m);
      for (int f = 0; f < a.fields; ++f) line += fmt::format("  {:<16}", coefficient_text(a.at(f, l, m)));
      sink(line + "\n");
    }
  if (beside_paper && a.lmax >= 3) write_beside_paper(expansion, sink);
}

} // namespace cowgpu

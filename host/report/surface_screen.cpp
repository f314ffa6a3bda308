#include "host/report/surface_result.hpp"

#include "host/spectrum/paper_tables.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

std::string coefficient_text(std::complex<double> value) {
  return fmt::format("{:+.4f}{:+.4f}i", value.real(), value.imag());
}

std::string fields_text(const std::array<double, 6>& values, std::size_t fields) {
  std::string text;
  for (std::size_t f = 0; f < fields; ++f)
    text += fmt::format("{}{} {:.1e}", f == 0 ? "" : ", ", surface_field_names[f], values[f]);
  return text;
}

std::string columns_text(const std::array<double, 3>& values) {
  return fmt::format("f_r {:.4f}, f_dtheta {:.4f}, f_dphi {:.4f}", values[0], values[1], values[2]);
}

void write_beside_paper(const SurfaceResult& result, const std::function<void(std::string_view)>& sink) {
  const SurfaceExpansion& expansion = result.expansion;
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
  sink("misfit sqrt(sum |c - t|^2 / sum |t|^2), l >= 1: " + columns_text(paper_misfits(expansion)) + "\n");

  sink(fmt::format(
      "\nconverged values, and how far the paper's are from them: a grid of half the {} rings moves degrees "
      "0 to 3 by\nat most {}\n",
      result.report.rings, fields_text(converged_within(result), 3)));
  sink(fmt::format("  {:>2} {:>2}", "l", "m"));
  for (int f = 0; f < 3; ++f) sink(fmt::format("  {:<22} {:<8}", surface_field_names[std::size_t(f)], "paper's"));
  sink("\n");
  for (const PaperRow& row : paper_harmonic_table()) {
    std::string line = fmt::format("  {:>2} {:>2}", row.l, row.m);
    for (int f = 0; f < 3; ++f) {
      const std::complex<double> value = expansion.coefficients.at(f, row.l, row.m);
      line += fmt::format("  {:<22} {:<8.5f}", fmt::format("{:+.6f}{:+.6f}i", value.real(), value.imag()),
                          std::abs(value - row.values[std::size_t(f)]));
    }
    sink(line + "\n");
  }
  sink("the paper's largest distance: " + columns_text(paper_distances(expansion)) + "\n");
}

} // namespace

std::array<double, 6> converged_within(const SurfaceResult& result) {
  std::array<double, 6> most{};
  for (std::size_t l = 0; l < std::min<std::size_t>(4, result.report.aliasing.size()); ++l)
    for (std::size_t f = 0; f < most.size(); ++f) most[f] = std::max(most[f], result.report.aliasing[l][f]);
  return most;
}

void write_surface_screen(const SurfaceResult& result, const std::function<void(std::string_view)>& sink) {
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
  sink(fmt::format("  left above degree {} (root mean square): {}\n", a.lmax,
                   fields_text(result.report.truncation.back(), 6)));
  if (!result.report.aliasing.empty())
    sink(fmt::format("  aliasing at degree {}, as a grid of half the rings shows it: {}\n", a.lmax,
                     fields_text(result.report.aliasing.back(), 6)));
  std::string head = fmt::format("  {:>2} {:>2}", "l", "m");
  for (const char* field : surface_field_names) head += fmt::format("  {:<16}", field);
  sink(head + "\n");
  for (int l = 0; l <= std::min(a.lmax, 3); ++l)
    for (int m = 0; m <= l; ++m) {
      std::string line = fmt::format("  {:>2} {:>2}", l, m);
      for (int f = 0; f < a.fields; ++f) line += fmt::format("  {:<16}", coefficient_text(a.at(f, l, m)));
      sink(line + "\n");
    }
  if (result.beside_paper) write_beside_paper(result, sink);
}

} // namespace cowgpu

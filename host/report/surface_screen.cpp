#include "host/report/surface_result.hpp"

#include "host/paper/surface_tables.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

std::string coefficient_text(std::complex<double> value) {
  return fmt::format("{:+.4f}{:+.4f}i", value.real(), value.imag());
}

std::string scaled_text(std::complex<double> value) {
  return fmt::format("{:+.4e}{:+.4e}i", value.real(), value.imag());
}

// Lengths of bodies that are very small or large in their unit do not fit four decimals.
bool fits_decimals(double length) {
  return length >= 0.05 && length < 1e4;
}

std::string fields_text(const std::array<double, 6>& values, std::size_t fields) {
  std::string text;
  for (std::size_t f = 0; f < fields; ++f)
    text += fmt::format("{}{} {:.1e}", f == 0 ? "" : ", ", surface_field_names[f], values[f]);
  return text;
}

std::string lookup_words(const SurfaceResult& result) {
  const std::string name = lookup_name(result);
  return name == "ray" ? "along the ray" : name == "sheets" ? "sheet by sheet" : "at the " + name;
}

std::string columns_text(const std::array<double, 3>& values) {
  return fmt::format("f_r {:.4f}, f_dtheta {:.4f}, f_dphi {:.4f}", values[0], values[1], values[2]);
}

// Refining the mesh is what decides between the two tables: it converges, and not to the paper's.
std::string verdict_text(const std::array<double, 3>& distances, const std::array<double, 6>& within) {
  std::string farther;
  for (std::size_t f = 0; f < distances.size(); ++f)
    if (distances[f] > within[f] + 5e-5) // the paper's table has four decimals
      farther += fmt::format("{}{} ({:.0f} times)", farther.empty() ? "" : ", ", surface_field_names[f],
                             distances[f] / within[f]);
  if (farther.empty()) return "the paper's values lie within what is uncertain of the converged ones\n";
  return fmt::format("refining the mesh converges, and to other values than the paper's, beyond what is uncertain: {}: "
                     "the converged ones hold,\nthe paper's are those of its mesh, steps and look-up\n",
                     farther);
}

void write_beside_paper(const SurfaceResult& result, const Sink& sink) {
  const SurfaceExpansion &expansion = result.expansion, &converged = converged_expansion(result);
  const auto table = paper_table(result);
  sink(fmt::format(
      "\nbeside the paper's table (Higher multipoles of the cow, {}; the means of the angles are dropped)\n",
      result.flow ? "gradient flow of the distance" : "harmonic map"));
  sink(fmt::format("  {:>2} {:>2}", "l", "m"));
  for (int f = 0; f < 3; ++f) sink(fmt::format("  {:<16} {:<16}", surface_field_names[std::size_t(f)], "paper"));
  sink("\n");
  for (const PaperRow& row : table) {
    std::string line = fmt::format("  {:>2} {:>2}", row.l, row.m);
    for (int f = 0; f < 3; ++f)
      line += fmt::format("  {:<16} {:<16}", coefficient_text(expansion.coefficients.at(f, row.l, row.m)),
                          coefficient_text(row.values[std::size_t(f)]));
    sink(line + "\n");
  }
  sink("misfit sqrt(sum |c - t|^2 / sum |t|^2), l >= 1: " + columns_text(paper_misfits(expansion, table)) + "\n");

  const std::string within = fields_text(converged_within(result), 3);
  if (result.flow)
    sink(fmt::format(
        "\nconverged values of signed sheets, extrapolated over {} refinements, and how far the paper's are "
        "from them;\nuncertain by at most {}\n",
        result.flow->sheets.size() - 1, within));
  else
    sink(fmt::format(
        "\nconverged values, and how far the paper's are from them: a grid of half the {} rings moves degrees "
        "0 to 3 by\nat most {}\n",
        result.report.rings, within));
  sink(fmt::format("  {:>2} {:>2}", "l", "m"));
  for (int f = 0; f < 3; ++f) sink(fmt::format("  {:<22} {:<8}", surface_field_names[std::size_t(f)], "paper's"));
  sink("\n");
  for (const PaperRow& row : table) {
    std::string line = fmt::format("  {:>2} {:>2}", row.l, row.m);
    for (int f = 0; f < 3; ++f) {
      const std::complex<double> value = converged.coefficients.at(f, row.l, row.m);
      line += fmt::format("  {:<22} {:<8.5f}", fmt::format("{:+.6f}{:+.6f}i", value.real(), value.imag()),
                          std::abs(value - row.values[std::size_t(f)]));
    }
    sink(line + "\n");
  }
  const auto distances = paper_distances(converged, table);
  sink("the paper's largest distance: " + columns_text(distances) + "\n");
  if (result.flow) sink(verdict_text(distances, converged_within(result)));
}

} // namespace

std::string lookup_name(const SurfaceResult& result) {
  if (result.flow && result.flow->meaning == "level-set") return "level set";
  if (result.flow && result.flow->meaning == "sheets") return "sheets";
  return result.closest_point ? "closest point" : "ray";
}

std::span<const PaperRow> paper_table(const SurfaceResult& result) {
  return result.flow ? paper_flow_table() : paper_harmonic_table();
}

const SurfaceExpansion& converged_expansion(const SurfaceResult& result) {
  return result.flow && result.flow->converged ? result.flow->converged->expansion : result.expansion;
}

std::array<double, 6> converged_within(const SurfaceResult& result) {
  return largest_of(
      result.flow && result.flow->converged ? result.flow->converged->uncertainty : result.report.aliasing, 3);
}

void write_surface_screen(const SurfaceResult& result, const Sink& sink) {
  const SurfaceExpansion& expansion = result.expansion;
  const SphereCoefficients& a = expansion.coefficients;
  const Vec3& o = expansion.origin;
  sink(fmt::format("\nsurface over the {} map{}, recipe {}, to degree {}: {} coefficients of each of six fields\n",
                   name(result.of), result.map_file.empty() ? "" : " of " + result.map_file, result.recipe, a.lmax,
                   SphereCoefficients::count(a.lmax)));
  for (const std::string& note : result.map.notes) sink("  map: " + note + "\n");
  for (const std::string& sentence : result.quality.sentences) sink("  map: " + sentence + "\n");
  sink(fmt::format("  origin ({:.9g}, {:.9g}, {:.9g}) ({}); grid of {} rings of {} points, looked up {}\n", o.x(),
                   o.y(), o.z(), result.origin_kind, result.report.rings, result.report.ring_length,
                   lookup_words(result)));
  if (result.flow) write_flow_screen(*result.flow, sink);
  sink(fmt::format("  time: map {:.3f} s, sample {:.3f} s, analyse {:.3f} s\n", result.map_seconds,
                   result.report.sample_seconds, result.report.analyse_seconds));
  sink(fmt::format("  means removed: f_dtheta {:.9g}, f_dphi {:.9g} radians; f_dphi is {}\n", expansion.mean_dtheta,
                   expansion.mean_dphi, expansion.signed_dphi ? "signed" : "absolute"));
  sink(fmt::format("  left above degree {} (root mean square): {}\n", a.lmax,
                   fields_text(result.report.truncation.back(), 6)));
  if (!result.report.aliasing.empty())
    sink(fmt::format("  aliasing at degree {}, as a grid of half the rings shows it: {}\n", a.lmax,
                     fields_text(result.report.aliasing.back(), 6)));
  if (result.flow && !result.flow->uncertainty.empty())
    sink(fmt::format("  uncertain among degrees 0 to {}: {}\n", std::min(a.lmax, 8),
                     fields_text(largest_of(result.flow->uncertainty, 8), 6)));
  std::string head = fmt::format("  {:>2} {:>2}", "l", "m");
  const int last = std::min(a.lmax, 3);
  const bool decimals = fits_decimals(a.at(0, 0, 0).real()); // the mean distance tells the scale of lengths
  const auto scaled = [&](int f) { return !decimals && f != 1 && f != 2; };
  for (int f = 0; f < a.fields; ++f)
    head += fmt::format("  {:<{}}", surface_field_names[std::size_t(f)], scaled(f) ? 24 : 16);
  sink(head + "\n");
  for (int l = 0; l <= last; ++l)
    for (int m = 0; m <= l; ++m) {
      std::string line = fmt::format("  {:>2} {:>2}", l, m);
      for (int f = 0; f < a.fields; ++f)
        line += scaled(f) ? fmt::format("  {:<24}", scaled_text(a.at(f, l, m)))
                          : fmt::format("  {:<16}", coefficient_text(a.at(f, l, m)));
      sink(line + "\n");
    }
  if (result.beside_paper) write_beside_paper(result, sink);
}

} // namespace cowgpu

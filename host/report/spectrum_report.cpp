#include "host/report/spectrum_report.hpp"

#include "host/io/shown.hpp"
#include "host/report/document_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

constexpr int bar_width = 40;
constexpr double bar_range = 20; // decades at most

// Ends of the logarithmic scale: the powers that are not 0, at most bar_range decades of them.
struct Scale {
  int low = 0, high = 0; // powers of ten
  explicit Scale(const std::vector<double>& power) {
    double smallest = 0, largest = 0;
    for (const double value : power) {
      const double s = std::fabs(value);
      if (s > 0) smallest = smallest > 0 ? std::min(smallest, s) : s;
      largest = std::max(largest, s);
    }
    if (!(largest > 0)) return;
    high = int(std::ceil(std::log10(largest)));
    low = std::max(int(std::floor(std::log10(smallest))), high - int(bar_range));
    if (low == high) --low;
  }
  std::string bar(double value) const {
    const double s = std::fabs(value);
    if (!(s > 0) || high == low) return "";
    const double part = (std::log10(s) - low) / (high - low);
    return std::string(std::size_t(std::clamp(int(std::lround(bar_width * part)), 0, bar_width)),
                       value < 0 ? '-' : '#');
  }
};

void write_column(const PowerSpectrum& column, const char* symbol, const char* sum, const Sink& sink) {
  const Scale scale(column.power);
  sink(fmt::format("\n{}: {} {:.15g}\n", shown(column.name), sum, column.total()));
  sink(fmt::format("  {:>4}  {:>22}  {:>12}  log10 from 1e{:+03d} to 1e{:+03d}\n", "l", symbol,
                   fmt::format("{}/(2l+1)", symbol), scale.low, scale.high));
  for (std::size_t l = 0; l < column.power.size(); ++l) {
    const double s = column.power[l];
    std::string line = fmt::format("  {:>4}  {:>22.15e}  {:>12.5e}  {}", l, s, s / double(2 * l + 1), scale.bar(s));
    line.erase(line.find_last_not_of(' ') + 1);
    sink(line + "\n");
  }
}

} // namespace

double PowerSpectrum::total() const {
  double sum = 0;
  for (const double s : power) sum += s;
  return sum;
}

void write_screen(const SpectrumResult& result, const Sink& sink) {
  const std::size_t n = result.fields.size();
  sink(fmt::format("{}: {} to degree {}\n", result.input, n == 1 ? "1 field" : fmt::format("{} fields", n),
                   result.lmax));
  for (const std::string& note : result.notes) sink("note: " + note + "\n");
  sink("S_l = sum over m = -l ... l of |a_lm|^2, orthonormal harmonics, in the square of the field's unit\n");
  for (const PowerSpectrum& field : result.fields)
    write_column(field, "S_l", "integral of f^2 over the unit sphere", sink);
  if (!result.cross) return;
  sink("\nX_l = sum over m of conj(a_lm) b_lm; bars of '-' are negative\n");
  write_column(*result.cross, "X_l", "integral of f g over the unit sphere", sink);
}

Object document(const SpectrumResult& result) {
  List fields;
  for (const PowerSpectrum& field : result.fields)
    fields.push_back(Object{{"name", field.name}, {"total", field.total()}, {"power", field.power}});
  Object all = opening("cowgpu.spectrum.v1", result.command, result.created);
  all.add({{"input", result.input},
           {"notes", result.notes},
           {"lmax", result.lmax},
           {"harmonics", "orthonormal"},
           {"fields", fields}});
  if (result.cross) all.add("cross", Object{{"total", result.cross->total()}, {"power", result.cross->power}});
  return all;
}

} // namespace cowgpu

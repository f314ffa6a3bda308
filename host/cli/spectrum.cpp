#include "host/cli/commands.hpp"

#include "host/cli/quantities.hpp"
#include "host/io/shown.hpp"
#include "host/report/json_parts.hpp"
#include "host/requests/spectrum.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string input, length_unit;
  bool cross = false;
  bool json = false;
};

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

void write_column(const PowerSpectrum& column, const char* symbol, const char* sum) {
  const Scale scale(column.power);
  write_stdout(fmt::format("\n{}: {} {:.15g}\n", shown(column.name), sum, column.total()));
  write_stdout(fmt::format("  {:>4}  {:>22}  {:>12}  log10 from 1e{:+03d} to 1e{:+03d}\n", "l", symbol,
                           fmt::format("{}/(2l+1)", symbol), scale.low, scale.high));
  for (std::size_t l = 0; l < column.power.size(); ++l) {
    const double s = column.power[l];
    std::string line = fmt::format("  {:>4}  {:>22.15e}  {:>12.5e}  {}", l, s, s / double(2 * l + 1), scale.bar(s));
    line.erase(line.find_last_not_of(' ') + 1);
    write_stdout(line + "\n");
  }
}

void write_json(const Options& options, const Common& common, const SpectrumResult& result) {
  nlohmann::ordered_json fields = nlohmann::ordered_json::array();
  for (const PowerSpectrum& field : result.fields)
    fields.push_back({{"name", field.name}, {"total", field.total()}, {"power", field.power}});
  nlohmann::ordered_json all = {{"schema", "cowgpu.spectrum.v1"},
                                {"program", program_json()},
                                {"command", common.command},
                                {"created", utc_now()},
                                {"input", options.input},
                                {"notes", result.notes},
                                {"lmax", result.lmax},
                                {"harmonics", "orthonormal"},
                                {"fields", fields}};
  if (result.cross) all["cross"] = {{"total", result.cross->total()}, {"power", result.cross->power}};
  write_stdout(json_text(all) + "\n");
}

void write_screen(const Options& options, const SpectrumResult& result) {
  const std::size_t n = result.fields.size();
  write_stdout(fmt::format("{}: {} to degree {}\n", options.input, n == 1 ? "1 field" : fmt::format("{} fields", n),
                           result.lmax));
  for (const std::string& note : result.notes) write_stdout("note: " + note + "\n");
  write_stdout("S_l = sum over m = -l ... l of |a_lm|^2, orthonormal harmonics, in the square of the field's unit\n");
  for (const PowerSpectrum& field : result.fields) write_column(field, "S_l", "integral of f^2 over the unit sphere");
  if (!result.cross) return;
  write_stdout("\nX_l = sum over m of conj(a_lm) b_lm; bars of '-' are negative\n");
  write_column(*result.cross, "X_l", "integral of f g over the unit sphere");
}

void run(const Options& options, const Common& common) {
  const SpectrumResult result = spectrum({options.input, stated_metres(options.length_unit), options.cross});
  if (options.json)
    write_json(options, common, result);
  else
    write_screen(options, result);
}

} // namespace

void add_spectrum(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand("spectrum", "Power per degree of coefficients in a file");
  command
      ->add_option("FILE", options->input,
                   "Coefficients of any format that `convert` reads, recognised by their content")
      ->required();
  add_length_unit_option(*command, options->length_unit, "FILE");
  command->add_flag("--cross", options->cross, "For two fields: their cross spectrum too");
  command->add_flag("--json", options->json, "As JSON (data/schemas/cowgpu.spectrum.v1.json)");
  command->footer(
      "S_l is the sum over m = -l ... l of |a_lm|^2 with orthonormal harmonics, whatever convention the file has; "
      "the\nS_l add up to the integral of f^2 over the unit sphere. Unit: the square of the field's. The bar is "
      "logarithmic\nbetween the powers of ten that its head names.\n"
      "Example: cowgpu expand --lmax 16 -o moments.csv && cowgpu spectrum moments.csv");
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli

#include "host/cli/commands.hpp"

#include "host/cli/quantities.hpp"
#include "host/error.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/shown.hpp"
#include "host/report/json_parts.hpp"
#include "host/spectrum/power.hpp"

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

struct Column {
  std::string name;
  std::vector<double> power;
};

constexpr int bar_width = 40;
constexpr double bar_range = 20; // decades at most

double total(const std::vector<double>& power) {
  double sum = 0;
  for (const double s : power) sum += s;
  return sum;
}

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

void write_column(const Column& column, const char* symbol, const char* sum) {
  const Scale scale(column.power);
  write_stdout(fmt::format("\n{}: {} {:.15g}\n", shown(column.name), sum, total(column.power)));
  write_stdout(fmt::format("  {:>4}  {:>22}  {:>12}  log10 from 1e{:+03d} to 1e{:+03d}\n", "l", symbol,
                           fmt::format("{}/(2l+1)", symbol), scale.low, scale.high));
  for (std::size_t l = 0; l < column.power.size(); ++l) {
    const double s = column.power[l];
    std::string line = fmt::format("  {:>4}  {:>22.15e}  {:>12.5e}  {}", l, s, s / double(2 * l + 1), scale.bar(s));
    line.erase(line.find_last_not_of(' ') + 1);
    write_stdout(line + "\n");
  }
}

void run(const Options& options, const Common& common) {
  const CoefficientFile file = read_coefficients(options.input, stated_metres(options.length_unit));
  const SphereCoefficients& a = file.coefficients;
  if (options.cross && a.fields != 2)
    throw Error(Fault::bad_argument,
                fmt::format("--cross takes a file of two fields; {} has {}", options.input, a.fields));
  std::vector<Column> columns;
  for (int f = 0; f < a.fields; ++f) {
    const std::string& name = file.names[std::size_t(f)];
    columns.push_back({!name.empty() ? name : a.fields == 1 ? "field" : fmt::format("field_{}", f + 1), power(a, f)});
  }
  for (const Column& column : columns)
    if (!std::isfinite(total(column.power)))
      throw Error(Fault::file_format,
                  fmt::format("{}: the squares of the coefficients of {} overflow double precision; "
                              "scale the field down",
                              options.input, shown(column.name)));
  const Column cross =
      options.cross ? Column{columns[0].name + " and " + columns[1].name, cross_power(a, 0, a, 1)} : Column{};
  if (options.json) {
    nlohmann::ordered_json fields = nlohmann::ordered_json::array();
    for (const Column& column : columns)
      fields.push_back({{"name", column.name}, {"total", total(column.power)}, {"power", column.power}});
    nlohmann::ordered_json all = {{"schema", "cowgpu.spectrum.v1"},
                                  {"program", program_json()},
                                  {"command", common.command},
                                  {"created", utc_now()},
                                  {"input", options.input},
                                  {"notes", file.notes},
                                  {"lmax", a.lmax},
                                  {"harmonics", "orthonormal"},
                                  {"fields", fields}};
    if (options.cross) all["cross"] = {{"total", total(cross.power)}, {"power", cross.power}};
    write_stdout(json_text(all) + "\n");
    return;
  }
  write_stdout(fmt::format("{}: {} to degree {}\n", options.input,
                           a.fields == 1 ? "1 field" : fmt::format("{} fields", a.fields), a.lmax));
  for (const std::string& note : file.notes) write_stdout("note: " + note + "\n");
  write_stdout("S_l = sum over m = -l ... l of |a_lm|^2, orthonormal harmonics, in the square of the field's unit\n");
  for (const Column& column : columns) write_column(column, "S_l", "integral of f^2 over the unit sphere");
  if (!options.cross) return;
  write_stdout("\nX_l = sum over m of conj(a_lm) b_lm; bars of '-' are negative\n");
  write_column(cross, "X_l", "integral of f g over the unit sphere");
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

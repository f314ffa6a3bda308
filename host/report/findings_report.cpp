#include "host/report/findings_report.hpp"

#include "host/report/json_parts.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

using nlohmann::ordered_json;
using namespace physics;

ordered_json vector_json(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

// No number is -0 to a reader.
double shown_number(double value) {
  return value == 0 ? 0.0 : value;
}

struct ToJson {
  ordered_json operator()(std::monostate) const { return nullptr; }
  ordered_json operator()(double value) const { return shown_number(value); } // infinity becomes null
  ordered_json operator()(const std::string& value) const { return value; }
  ordered_json operator()(bool value) const { return value; }
  ordered_json operator()(const Vec3& value) const { return vector_json(value); }
  ordered_json operator()(const Eigen::Matrix3d& value) const {
    return {vector_json(value.row(0)), vector_json(value.row(1)), vector_json(value.row(2))};
  }
};

std::string row_text(const Vec3& v) {
  return fmt::format("{:>22.14e}  {:>22.14e}  {:>22.14e}", shown_number(v.x()), shown_number(v.y()),
                     shown_number(v.z()));
}

struct ToText {
  std::string operator()(std::monostate) const { return "-"; }
  std::string operator()(double value) const { return fmt::format("{:.12g}", shown_number(value)); }
  std::string operator()(const std::string& value) const { return value; }
  std::string operator()(bool value) const { return value ? "yes" : "no"; }
  std::string operator()(const Vec3& value) const {
    return fmt::format("({:.12g}, {:.12g}, {:.12g})", shown_number(value.x()), shown_number(value.y()),
                       shown_number(value.z()));
  }
  std::string operator()(const Eigen::Matrix3d& m) const {
    return fmt::format("\n    {}\n    {}\n    {}", row_text(m.row(0)), row_text(m.row(1)), row_text(m.row(2)));
  }
};

ordered_json entries_json(const Table& table) {
  ordered_json entries = ordered_json::array();
  for (const auto& row : table.rows) {
    ordered_json entry = ordered_json::object();
    for (std::size_t c = 0; c < row.size(); ++c) entry[table.columns[c].name] = std::visit(ToJson{}, row[c]);
    entries.push_back(std::move(entry));
  }
  return entries;
}

ordered_json table_json(const Table& table) {
  ordered_json columns = ordered_json::array(), units = ordered_json::array(), rows = ordered_json::array();
  for (const Column& column : table.columns) {
    columns.push_back(column.name);
    units.push_back(column.unit);
  }
  for (const auto& row : table.rows) {
    ordered_json values = ordered_json::array();
    for (const Value& value : row) values.push_back(std::visit(ToJson{}, value));
    rows.push_back(std::move(values));
  }
  return {{"columns", columns}, {"units", units}, {"rows", rows}};
}

// Cells are shorter than lines of their own: six digits tell what a table is for, and the JSON has all of them.
std::string cell_text(const Value& value) {
  if (const double* number = std::get_if<double>(&value)) return fmt::format("{:.6g}", shown_number(*number));
  return std::visit(ToText{}, value);
}

void write_table(const Table& table, const Sink& sink) {
  std::vector<std::string> lines(1 + table.rows.size());
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const Column& column = table.columns[c];
    if (!column.on_screen) continue;
    std::vector<std::string> cells = {column.unit.empty() ? column.name
                                                          : fmt::format("{} [{}]", column.name, column.unit)};
    for (const auto& row : table.rows) cells.push_back(cell_text(row[c]));
    std::size_t width = 0;
    for (const std::string& cell : cells) width = std::max(width, cell.size());
    // Remarks at the end of the rows begin at one place and have any length.
    const bool remarks = c + 1 == table.columns.size() && !table.rows.empty() &&
                         std::holds_alternative<std::string>(table.rows.back().back());
    for (std::size_t r = 0; r < cells.size(); ++r)
      lines[r] += remarks ? "  " + cells[r] : fmt::format("  {:>{}}", cells[r], width);
  }
  sink(fmt::format("\n{}\n", table.label));
  for (const std::string& line : lines) sink(line + "\n");
}

double relative(const Comparison& row) {
  return row.printed == 0 ? row.ours - row.printed : row.ours / row.printed - 1;
}

} // namespace

ordered_json findings_json(const Findings& findings, const std::string& schema,
                           const std::vector<std::string>& command) {
  ordered_json input = {{"kind", findings.input_kind}, {"name", findings.input_name}};
  if (!findings.input_sha256.empty()) input["sha256"] = findings.input_sha256;
  ordered_json all = {{"schema", schema}, {"program", program_json()}, {"command", command}, {"created", utc_now()},
                      {"input", input},   {"notes", findings.notes}};
  ordered_json units = ordered_json::object();
  for (const Finding& row : findings.rows) {
    all[row.key] = std::visit(ToJson{}, row.value);
    if (!row.unit.empty()) units[row.key] = row.unit;
  }
  for (const Table& table : findings.tables) {
    all[table.key] = table.as_entries ? entries_json(table) : table_json(table);
    for (const Column& column : table.columns)
      if (table.as_entries && !column.unit.empty()) units[table.key + "." + column.name] = column.unit;
  }
  all["units"] = units;
  if (findings.paper.empty()) return all;
  ordered_json paper = ordered_json::array();
  for (const Comparison& row : findings.paper)
    paper.push_back({{"quantity", row.quantity},
                     {"ours", row.ours},
                     {"paper", row.printed},
                     {"relative_difference", relative(row)},
                     {"why", row.why}});
  all["paper"] = paper;
  return all;
}

void write_findings(const Findings& findings, const Sink& sink) {
  sink(findings.title + "\n");
  for (const std::string& note : findings.notes) sink("note: " + note + "\n");
  for (const Finding& row : findings.rows) {
    if (std::holds_alternative<std::monostate>(row.value)) {
      if (!row.missing.empty()) sink(fmt::format("  {:<38} {}\n", row.label, row.missing));
      continue;
    }
    const bool matrix = std::holds_alternative<Eigen::Matrix3d>(row.value);
    const std::string value = std::visit(ToText{}, row.value);
    if (matrix)
      sink(fmt::format("  {}{}{}\n", row.label, row.unit.empty() ? "" : ", " + row.unit, value));
    else
      sink(fmt::format("  {:<38} {}{}\n", row.label, value, row.unit.empty() ? "" : " " + row.unit));
  }
  for (const Table& table : findings.tables) write_table(table, sink);
  if (findings.paper.empty()) return;
  sink(fmt::format("\nbeside the paper's numbers\n  {:<34} {:>14} {:>14} {:>10}\n", "", "here", "paper", "difference"));
  for (const Comparison& row : findings.paper)
    sink(fmt::format("  {:<34} {:>14.6g} {:>14.6g} {:>+10.2g}{}\n", row.quantity, row.ours, row.printed, relative(row),
                     row.why.empty() ? "" : "  " + row.why));
}

} // namespace cowgpu

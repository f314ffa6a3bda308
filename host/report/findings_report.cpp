#include "host/report/findings_report.hpp"

#include "host/report/document_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

using namespace physics;

// No number is -0 to a reader.
double shown_number(double value) {
  return value == 0 ? 0.0 : value;
}

Value shown_value(const Value& value) {
  const double* number = value.get<double>();
  return number ? Value(shown_number(*number)) : value;
}

std::string row_text(const Vec3& v) {
  return fmt::format("{:>22.14e}  {:>22.14e}  {:>22.14e}", shown_number(v.x()), shown_number(v.y()),
                     shown_number(v.z()));
}

struct ToText {
  std::string operator()(std::monostate) const { return "-"; }
  std::string operator()(double value) const { return fmt::format("{:.12g}", shown_number(value)); }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(std::uint64_t value) const { return std::to_string(value); }
  std::string operator()(const std::string& value) const { return value; }
  std::string operator()(bool value) const { return value ? "yes" : "no"; }
  std::string operator()(const Vec3& value) const {
    return fmt::format("({:.12g}, {:.12g}, {:.12g})", shown_number(value.x()), shown_number(value.y()),
                       shown_number(value.z()));
  }
  std::string operator()(const Eigen::Matrix3d& m) const {
    return fmt::format("\n    {}\n    {}\n    {}", row_text(m.row(0)), row_text(m.row(1)), row_text(m.row(2)));
  }
  // Lists, objects and coefficients are in the document alone.
  template <class Several>
  std::string operator()(const Several&) const {
    return "...";
  }
};

List entries(const Table& table) {
  List all;
  for (const auto& row : table.rows) {
    Object entry;
    for (std::size_t c = 0; c < row.size(); ++c) entry.add(table.columns[c].name, shown_value(row[c]));
    all.push_back(std::move(entry));
  }
  return all;
}

Object members(const Table& table) {
  List columns, units, rows;
  for (const Column& column : table.columns) {
    columns.push_back(column.name);
    units.push_back(column.unit);
  }
  for (const auto& row : table.rows) {
    List values;
    for (const Value& value : row) values.push_back(shown_value(value));
    rows.push_back(std::move(values));
  }
  return {{"columns", columns}, {"units", units}, {"rows", rows}};
}

// Cells are shorter than lines of their own: six digits tell what a table is for, and the JSON has all of them.
std::string cell_text(const Value& value) {
  if (const double* number = value.get<double>()) return fmt::format("{:.6g}", shown_number(*number));
  return std::visit(ToText{}, value.content);
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
    const bool remarks =
        c + 1 == table.columns.size() && !table.rows.empty() && table.rows.back().back().get<std::string>();
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

Object document(const Findings& findings, const std::string& schema, const std::vector<std::string>& command) {
  Object input = {{"kind", findings.input_kind}, {"name", findings.input_name}};
  if (!findings.input_sha256.empty()) input.add("sha256", findings.input_sha256);
  Object all = opening(schema, command), units;
  all.add({{"input", input}, {"notes", findings.notes}});
  for (const Finding& row : findings.rows) {
    all.add(row.key, shown_value(row.value));
    if (!row.unit.empty()) units.add(row.key, row.unit);
  }
  for (const Table& table : findings.tables) {
    all.add(table.key, table.as_entries ? Value(entries(table)) : Value(members(table)));
    for (const Column& column : table.columns)
      if (table.as_entries && !column.unit.empty()) units.add(table.key + "." + column.name, column.unit);
  }
  all.add("units", units);
  if (findings.paper.empty()) return all;
  List paper;
  for (const Comparison& row : findings.paper)
    paper.push_back(Object{{"quantity", row.quantity},
                           {"ours", row.ours},
                           {"paper", row.printed},
                           {"relative_difference", relative(row)},
                           {"why", row.why}});
  all.add("paper", paper);
  return all;
}

void write_findings(const Findings& findings, const Sink& sink) {
  sink(findings.title + "\n");
  for (const std::string& note : findings.notes) sink("note: " + note + "\n");
  for (const Finding& row : findings.rows) {
    if (row.value.get<std::monostate>()) {
      if (!row.missing.empty()) sink(fmt::format("  {:<38} {}\n", row.label, row.missing));
      continue;
    }
    const bool matrix = row.value.get<Eigen::Matrix3d>();
    const std::string value = std::visit(ToText{}, row.value.content);
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

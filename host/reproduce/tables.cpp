#include "host/reproduce/tables.hpp"

#include <fmt/format.h>

#include <cmath>

namespace cowgpu::reproduce {
namespace {

using nlohmann::json;
using paper::Printed;

// The value at a JSON pointer of a document, or null.
const json& at(const Documents& documents, const std::string& file, const std::string& pointer) {
  static const json null;
  const auto document = documents.find(file);
  if (document == documents.end()) return null;
  const json::json_pointer where(pointer);
  return document->second.contains(where) ? document->second.at(where) : null;
}

std::vector<double> numbers(const json& value) {
  if (value.is_number()) return {value.get<double>()};
  return {};
}

// Coefficient (l, m) of a list of rows l, m, numbers; nullptr if it has none.
const json* coefficient(const json& list, int l, int m) {
  const std::size_t place = std::size_t(l) * std::size_t(l + 1) / 2 + std::size_t(m);
  if (!list.is_array() || list.size() <= place || list[place][0] != l || list[place][1] != m) return nullptr;
  return &list[place];
}

Row box(const Printed& p, const Documents& documents) {
  const json& corners = at(documents, "mass.json", "/mesh/bounding_box");
  std::vector<double> ours;
  if (corners.is_array() && corners.size() == 2) {
    const auto axis = std::size_t(p.item[0] - 'x');
    ours = {corners[1][axis].get<double>() - corners[0][axis].get<double>()};
  }
  return compared(p, ours, "mass.json");
}

Row multipole(const Printed& p, const Documents& documents) {
  const json& list = at(documents, "mass.json", "/expansions/mass/coefficients");
  const json& radius = at(documents, "mass.json", "/expansions/mass/reference_radius");
  std::vector<double> ours;
  if (const json* row = coefficient(list, p.l, p.m); row && radius.is_number()) {
    const double scale = std::pow(radius.get<double>(), p.l);
    ours = {(*row)[2].get<double>() * scale};
    if (p.m > 0) ours.push_back(-(*row)[3].get<double>() * scale);
  }
  return compared(p, ours, "mass.json");
}

// What `cowgpu tensors`, `radiate` and `tip` lay beside the paper's numbers.
Row beside(const Printed& p, const Documents& documents, const std::string& file) {
  const json& list = at(documents, file, "/paper");
  if (list.is_array())
    for (const json& entry : list)
      if (entry.at("quantity") == p.item) return compared(p, numbers(entry.at("ours")), file);
  Row row;
  row.table = p.table;
  row.item = p.item;
  row.source = file;
  const bool written = documents.contains(file); // the file has this body's numbers alone
  row.verdict = written ? Verdict::not_compared : Verdict::not_computed;
  row.reason = written ? "data/" + file + " has this body's" : "there is no data/" + file;
  return row;
}

// The spin now is a decimal number with more digits than a double.
Row spin(const Printed& p, const Documents& documents) {
  const json& ours = at(documents, "radiate.json", "/omega_after");
  Row row{p.table, p.item, p.parts[0], {}, {}, {}, {}, {}, "radiate.json"};
  if (ours.is_string()) {
    const std::string digits = ours.get<std::string>();
    const bool same = digits.substr(0, row.printed.size()) == row.printed;
    row.verdict = same ? Verdict::agrees : Verdict::differs;
    if (!same) row.reason = "ours is " + digits + "; " + p.reason;
  }
  return row;
}

Row radiation(const Printed& p, const Documents& documents) {
  return p.item == "omega now in 1/s" ? spin(p, documents) : beside(p, documents, "radiate.json");
}

Row surface(const Printed& p, const Documents& documents, const std::string& map) {
  const std::string file = map + ".json";
  const json& list = at(documents, file, "/expansions/" + map + "/coefficients");
  std::vector<double> ours;
  if (const json* found = coefficient(list, p.l, p.m)) {
    const auto first = std::size_t(2 + 2 * p.field);
    ours = {(*found)[first].get<double>()};
    if (p.m > 0) ours.push_back((*found)[first + 1].get<double>());
  }
  return compared(p, ours, file);
}

// The paper prints no force, but that a cow is out of reach of 500 N "by a factor of a few".
Row tipping(const Printed& p, const Documents& documents) {
  constexpr double few = 2, many = 6;
  Row row = beside(p, documents, "tip.json");
  if (row.ours.size() == 1 && row.paper.size() == 1 && row.paper[0] > 0) {
    const double times = row.ours[0] / row.paper[0];
    row.printed = fmt::format("a few times {} N", row.printed);
    row.verdict = times >= few && times < many ? Verdict::agrees : Verdict::differs;
    row.reason = row.verdict == Verdict::agrees ? "" : p.reason;
  }
  return row;
}

// "Negligible for l >~ 20": less than a hundredth of what is above the monopole.
Row spectrum(const Printed& p, const Documents& documents) {
  const std::string list = "/expansions/harmonic/truncation/";
  const json& whole = at(documents, "harmonic.json", fmt::format("{}0/{}", list, p.field));
  const json& above = at(documents, "harmonic.json", fmt::format("{}20/{}", list, p.field));
  Row row{p.table, p.item, p.parts[0], {}, {}, {}, {}, {}, "harmonic.json"};
  if (whole.is_number() && above.is_number() && whole.get<double>() > 0) {
    const double part = above.get<double>() / whole.get<double>();
    row.ours = {part * part};
    row.verdict = part * part < 0.01 ? Verdict::agrees : Verdict::differs;
    if (row.verdict == Verdict::differs) row.reason = p.reason;
  }
  return row;
}

Row row_of(const Printed& p, const Documents& documents) {
  if (p.table == "bounding box") return box(p, documents);
  if (p.table == "mass multipoles") return multipole(p, documents);
  if (p.table == "tensors") return beside(p, documents, "tensors.json");
  if (p.table == "radiation") return radiation(p, documents);
  if (p.table == "gradient flow") return surface(p, documents, "flow");
  if (p.table == "harmonic map") return surface(p, documents, "harmonic");
  if (p.table == "tipping") return tipping(p, documents);
  return spectrum(p, documents);
}

} // namespace

std::vector<Row> paper_rows(const Documents& documents) {
  std::vector<Row> rows;
  for (const Printed& p : paper::printed())
    if (p.table != "potential") rows.push_back(row_of(p, documents)); // formulas of every body
  return rows;
}

void not_the_papers_body(std::vector<Row>& rows, const std::string& body) {
  for (Row& row : rows) {
    row.difference.reset();
    if (row.verdict != Verdict::not_computed) row.verdict = Verdict::not_compared;
    const bool pointed = row.reason.ends_with("has this body's"); // to the file that has it
    if (row.verdict == Verdict::not_compared && !pointed) row.reason = "ours is of " + body;
  }
}

} // namespace cowgpu::reproduce

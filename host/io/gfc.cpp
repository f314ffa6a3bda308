#include "host/io/gfc.hpp"

#include "host/io/coefficient_file.hpp"
#include "host/io/coefficient_formats.hpp"
#include "host/io/coefficient_lines.hpp"
#include "host/io/coefficient_metadata.hpp"
#include "host/io/length_unit.hpp"
#include "host/io/number.hpp"
#include "host/io/shown.hpp"
#include "host/io/words.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace cowgpu {
namespace {

constexpr std::size_t most_keywords = 1000; // those beyond are none of the format's

// What stands before end_of_head.
struct Head {
  std::map<std::string, std::string, std::less<>> values; // by keyword
  std::map<std::string, std::size_t, std::less<>> lines;
  Metadata metadata;
};

Head read_head(WordLines& lines) {
  Head head;
  while (lines.next()) {
    if (lines.words.empty()) continue;
    const std::string_view keyword = lines.words[0];
    if (keyword == "end_of_head") return head;
    if (keyword.starts_with('#')) take_comment(lines.line, lines.number, head.metadata);
    if (keyword == "begin_of_head") {
      head.values.clear(); // what stands above it is no head
    } else if (lines.words.size() > 1 && head.values.size() < most_keywords) {
      head.values[std::string(keyword)] = lines.words[1];
      head.lines[std::string(keyword)] = lines.number;
    }
  }
  lines.fail(lines.number == 0 || head.values.empty() ? Fault::file_format : Fault::file_truncated,
             "the file ends before a line end_of_head, which closes the head of a gravity model");
}

// A keyword's text; the line that messages name is then that of the keyword.
const std::string& required(const Head& head, WordLines& lines, std::string_view keyword) {
  const auto found = head.values.find(keyword);
  if (found == head.values.end()) lines.fail(Fault::file_syntax, fmt::format("the head has no line '{} ...'", keyword));
  lines.number = head.lines.find(keyword)->second;
  return found->second;
}

// The convention, and everything about the body.
CoefficientSet read_facts(const Head& head, WordLines& lines, int& lmax) {
  const std::size_t end = lines.number;
  CoefficientSet set(0, 1);
  if (!head.values.contains("product_type"))
    set.notes.push_back("the head has no product_type; gravity_field was assumed");
  else if (const std::string& product = required(head, lines, "product_type"); product != "gravity_field")
    lines.fail(Fault::file_format, fmt::format("product_type is '{}'; only gravity_field can be read", shown(product)));
  if (head.values.contains("norm")) {
    const std::string& norm = required(head, lines, "norm");
    if (norm != "fully_normalized" && norm != "unnormalized")
      lines.fail(Fault::file_syntax,
                 fmt::format("norm is '{}'; there are fully_normalized and unnormalized", shown(norm)));
    set.convention = {norm == "unnormalized" ? Normalisation::unnormalised : Normalisation::four_pi, Phase::none};
  } else {
    set.convention = {Normalisation::four_pi, Phase::none};
    set.normalisation_stated = false;
    set.notes.push_back(assumed_convention(set));
  }
  lines.number = end;
  const bool earth = head.values.contains("earth_gravity_constant") || !head.values.contains("gravity_constant");
  set.gm = lines.real(required(head, lines, earth ? "earth_gravity_constant" : "gravity_constant"));
  lines.number = end;
  set.reference_radius = lines.real(required(head, lines, "radius"));
  if (!(*set.reference_radius > 0)) lines.fail(Fault::file_syntax, "radius must be above 0");
  lines.number = end;
  lmax = lines.whole(required(head, lines, "max_degree"), "max_degree", largest_file_degree);
  lines.number = end;
  set.kind = CoefficientKind::potential;
  if (words_of_this_program(head.metadata)) {
    const Convention stated = set.convention;
    take_metadata(head.metadata, lines.file(), set);
    set.convention = stated;
  } else {
    set.units_stated = false;
    if (head.values.contains("modelname")) set.provenance.mesh = one_line(head.values.find("modelname")->second);
  }
  return set;
}

bool is_comment(std::string_view word) {
  return word.starts_with('#') || word.starts_with('!') || word.starts_with('%') || same_word(word, "cmmt") ||
         same_word(word, "comment");
}

std::vector<CoefficientRow> read_data(WordLines& lines, int lmax, CoefficientSet& set) {
  std::vector<CoefficientRow> rows;
  std::size_t comments = 0, first_comment = 0;
  bool errors = false;
  while (lines.next()) {
    if (lines.words.empty()) continue;
    const std::string_view key = lines.words[0];
    if (is_comment(key)) {
      if (comments++ == 0) first_comment = lines.number;
      continue;
    }
    for (const char* moving : {"gfct", "trnd", "dot", "asin", "acos"})
      if (key == moving)
        lines.fail(
            Fault::file_format,
            fmt::format("a term '{}', which varies with time; only static models (lines 'gfc') can be read", key));
    if (key != "gfc") lines.fail(Fault::file_syntax, fmt::format("a line 'gfc ...' expected, found '{}'", shown(key)));
    if (lines.words.size() < 5)
      lines.fail(Fault::file_truncated,
                 fmt::format("gfc, degree, order, C and S expected, found {} words", lines.words.size()));
    CoefficientRow row;
    row.l = lines.whole(lines.words[1], "the degree", lmax);
    row.m = lines.whole(lines.words[2], "the order", row.l);
    row.c = lines.real(lines.words[3]);
    row.s = lines.real(lines.words[4]);
    row.line = lines.number;
    if (row.m == 0 && row.s != 0) lines.fail(Fault::file_syntax, "S of order 0 must be 0");
    errors = errors || lines.words.size() > 5;
    rows.push_back(row);
  }
  if (comments > 0)
    set.notes.push_back(fmt::format("{} comment{} among the rows {} passed over, the first is line {}", comments,
                                    comments == 1 ? "" : "s", comments == 1 ? "was" : "were", first_comment));
  if (errors) set.notes.push_back("the errors of the coefficients were left out");
  return rows;
}

} // namespace

CoefficientSet parse_gfc(std::string_view bytes, const std::string& name, std::optional<double> metres) {
  WordLines lines(name, without_byte_order_mark(bytes));
  const Head head = read_head(lines);
  const bool ours = head.metadata.contains("cowgpu"), units = words_of_this_program(head.metadata);
  int lmax = 0;
  CoefficientSet set = read_facts(head, lines, lmax);
  std::vector<CoefficientRow> rows = read_data(lines, lmax, set);
  lines.judge_end(ours, set.notes);
  take_rows(rows, lmax, ours, lines, set);
  if (!units) settle_length_unit(set, metres, true);
  return set;
}

void write_gfc(const CoefficientSet& set, AtomicFile& file) {
  // Readers look for the keywords anywhere in a line and let later lines win, so comments stand above the head.
  std::string text = fmt::format("# cowgpu {}\n", version);
  text += comment_lines(set, {"coefficients_of", "lmax", "normalisation", "phase", "reference_radius", "gm"});
  for (auto at = text.find("of_head"); at != std::string::npos; at = text.find("of_head", at)) text[at + 2] = '-';
  const bool si = set.in_si();
  text +=
      "# C_lm + i S_lm = (-1)^m sqrt((2 - delta_m0) 4 pi) Q_lm / ((2l + 1) M R^l); axes of the mesh, theta from +z,\n"
      "# phi from +x towards +y, about the origin above\n";
  if (!si)
    text += "# lengths are in the unit of the mesh, the mass is density times its cube, and GM below is the mass times "
            "the\n"
            "# constant above\n";
  std::string model = set.provenance.mesh;
  std::replace_if(
      model.begin(), model.end(), [](char c) { return c <= ' ' || c > '~'; }, '_');
  text += fmt::format("begin_of_head\n{:<24}gravity_field\n{:<24}{}\n{:<24}", "product_type", "modelname",
                      model.empty() ? "cowgpu" : model, "earth_gravity_constant");
  append_number(text, set.gm.value_or(0));
  text += fmt::format("\n{:<24}", "radius");
  append_number(text, set.reference_radius.value_or(1));
  text += fmt::format("\n{:<24}{}\n{:<24}no\n{:<24}{}\n{:<24}unknown\n\nkey l m C S\nend_of_head\n", "max_degree",
                      set.lmax, "errors", "norm",
                      set.convention.normalisation == Normalisation::unnormalised ? "unnormalized" : "fully_normalized",
                      "tide_system");
  file.write(text);
  write_rows(set.lmax, file, [&](std::string& row, int l, int m) {
    const std::size_t at = set.index(0, l, m);
    row += fmt::format("gfc {} {} ", l, m);
    append_pair(row, set.first[at], set.second[at], " ");
    row += "\n";
  });
}

} // namespace cowgpu

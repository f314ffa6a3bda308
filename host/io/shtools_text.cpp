#include "host/io/shtools_text.hpp"

#include "host/io/coefficient_file.hpp"
#include "host/io/coefficient_formats.hpp"
#include "host/io/coefficient_lines.hpp"
#include "host/io/coefficient_metadata.hpp"
#include "host/io/foreign_file.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

// What is missing below must not make us allocate.
constexpr int largest_first_degree = 100;

struct Row {
  double c = 0, s = 0;
};

bool all_digits(std::string_view word) {
  return !word.empty() && word.size() < 6 &&
         std::all_of(word.begin(), word.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool is_comment(const WordLines& lines) {
  return lines.words.empty() || lines.words[0].starts_with('#');
}

// "r0, gm, omega, lmax": its first two numbers are no degree and order.
bool is_header(const WordLines& lines) {
  return lines.words.size() == 4 && !(all_digits(lines.words[0]) && all_digits(lines.words[1]));
}

// Returns lmax as it stands there.
double read_header(const WordLines& lines, CoefficientSet& set) {
  set.kind = CoefficientKind::potential;
  set.reference_radius = lines.real(lines.words[0]);
  set.gm = lines.real(lines.words[1]);
  lines.real(lines.words[2]);
  if (!(*set.reference_radius > 0)) lines.fail(Fault::file_syntax, "r0 must be above 0");
  return lines.real(lines.words[3]);
}

Row read_row(const WordLines& lines, int l, int m) {
  const auto& words = lines.words;
  const int row_l = lines.whole(words[0], "the degree", largest_file_degree);
  if (words.size() < 3)
    lines.fail(Fault::file_truncated, fmt::format("l, m, C and S expected, found {} words", words.size()));
  const int row_m = lines.whole(words[1], "the order", largest_file_degree);
  if (row_l != l || row_m != m)
    lines.fail(Fault::file_syntax, fmt::format("degree {}, order {} expected, found {}, {}", l, m, row_l, row_m));
  if (words.size() < 4 && m > 0) lines.fail(Fault::file_truncated, "S is missing");
  if (words.size() > 6) lines.fail(Fault::file_syntax, fmt::format("{} words, and a row has at most 6", words.size()));
  if (words[2].starts_with('('))
    lines.fail(Fault::file_format, "complex coefficients, which are not read; .csv and .json can hold them");
  Row row{lines.real(words[2]), words.size() > 3 ? lines.real(words[3]) : 0};
  if (m == 0 && row.s != 0) lines.fail(Fault::file_syntax, "S of order 0 must be 0");
  return row;
}

void assume_defaults(CoefficientSet& set) {
  set.convention = {Normalisation::four_pi, Phase::none};
  set.convention_stated = false;
  set.notes.push_back("the file does not say its convention; pyshtools' default was assumed: 4pi, without the "
                      "Condon-Shortley phase");
  if (set.kind != CoefficientKind::potential) return;
  set.length_unit = "m";
  set.mass_unit = "kg";
  set.gravitational_constant = gravitational_constant_si;
}

} // namespace

CoefficientSet read_shtools_text(const std::filesystem::path& path) {
  const std::string bytes = read_input_file(path);
  std::string_view text = bytes;
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  WordLines lines(path.string(), text);
  CoefficientSet set(0, 1);
  Metadata metadata;
  std::vector<Row> rows; // by l, then m
  int first_degree = 0, l = -1, m = 0;
  bool header = false, errors = false;
  double header_lmax = -1;
  while (lines.next()) {
    if (is_comment(lines)) {
      take_comment(lines.line, lines.number, metadata);
      continue;
    }
    if (l < 0 && !header && is_header(lines)) {
      header = true;
      header_lmax = read_header(lines, set);
      continue;
    }
    if (l < 0) l = first_degree = lines.whole(lines.words[0], "the first degree", largest_first_degree);
    rows.push_back(read_row(lines, l, m));
    errors = errors || lines.words.size() > 4;
    if (++m > l) {
      ++l;
      m = 0;
    }
  }
  if (rows.empty()) lines.fail(Fault::file_truncated, "the file ends before the first row l, m, C, S");
  if (m > 0) lines.fail(Fault::file_truncated, fmt::format("the file ends before degree {}, order {}", l, m));
  set.lmax = l - 1;
  if (header && header_lmax != set.lmax)
    lines.fail(
        header_lmax > set.lmax ? Fault::file_truncated : Fault::file_syntax,
        fmt::format("the rows end at degree {}, and the line r0, gm, omega, lmax says {}", set.lmax, header_lmax));
  const bool ours = metadata.contains("cowgpu");
  lines.judge_end(ours, set.notes);
  if (ours && metadata.contains("lmax")) {
    lines.number = metadata["lmax"].line;
    const int lmax = lines.whole(metadata["lmax"].text, "lmax", largest_file_degree);
    if (lmax != set.lmax)
      lines.fail(Fault::file_truncated, fmt::format("the rows end at degree {}, and lmax is {}", set.lmax, lmax));
  }
  set.first.assign(SphereCoefficients::count(set.lmax), 0);
  set.second = set.first;
  std::size_t at = 0;
  for (int degree = first_degree; degree <= set.lmax; ++degree)
    for (int order = 0; order <= degree; ++order, ++at) {
      set.first[set.index(0, degree, order)] = rows[at].c;
      set.second[set.index(0, degree, order)] = rows[at].s;
    }
  if (ours) metadata.erase("form");
  if (ours && !header && metadata.contains("kind"))
    lines.fail(Fault::file_truncated, "the file says that it is of a potential and has no line r0, gm, omega, lmax");
  if (!ours || !take_metadata(metadata, path.string(), set)) assume_defaults(set);
  if (first_degree > 0) {
    if (set.kind == CoefficientKind::potential) set.first[0] = 1;
    set.notes.push_back(fmt::format("degrees below {}, which the file leaves out, were taken as 0{}", first_degree,
                                    set.kind == CoefficientKind::potential ? ", and C_00 as 1" : ""));
  }
  if (errors) set.notes.push_back("the errors of the coefficients were left out");
  return set;
}

void write_shtools_text(const CoefficientSet& set, AtomicFile& file) {
  const bool potential = set.kind == CoefficientKind::potential;
  std::string text = fmt::format("# cowgpu {}\n", version);
  text += potential ? comment_lines(set, {"reference_radius", "gm"}) : comment_lines(set);
  if (potential)
    text += fmt::format("{:.16e}, {:.16e}, {:.16e}, {}\n", set.reference_radius.value_or(1), set.gm.value_or(0), 0.0,
                        set.lmax);
  file.write(text);
  write_rows(set.lmax, file, [&](std::string& row, int l, int m) {
    const std::size_t at = set.index(0, l, m);
    row += fmt::format("{}, {}, ", l, m);
    append_pair(row, set.first[at], set.second[at], ", ");
    row += "\n";
  });
}

} // namespace cowgpu

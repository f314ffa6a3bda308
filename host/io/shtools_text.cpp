#include "host/io/shtools_text.hpp"

#include "host/io/coefficient_file.hpp"
#include "host/io/coefficient_formats.hpp"
#include "host/io/coefficient_lines.hpp"
#include "host/io/coefficient_metadata.hpp"
#include "host/io/length_unit.hpp"
#include "host/io/shown.hpp"
#include "host/io/words.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

namespace cowgpu {
namespace {

constexpr std::size_t shortest_header = 4, longest_header = 8, longest_row = 6;

// A row as it stands there. `m` is below 0 where the table has rows of negative orders.
struct RawRow {
  int l = 0, m = 0;
  std::size_t words = 0;
  double first = 0, second = 0;
  std::size_t line = 0;
};

std::optional<int> integer_in(std::string_view word) {
  const auto value = to_integer(word);
  if (!value || std::abs(*value) > largest_file_degree) return {};
  return int(*value);
}

bool is_comment(const WordLines& lines) {
  return lines.words.empty() || lines.words[0].starts_with('#');
}

bool begins_as_number(std::string_view word) {
  return word[0] == '(' || word[0] == '+' || word[0] == '-' || word[0] == '.' || (word[0] >= '0' && word[0] <= '9');
}

bool all_numbers(const WordLines& lines) {
  return std::all_of(lines.words.begin(), lines.words.end(),
                     [](std::string_view word) { return WordLines::number_in(word).has_value(); });
}

// A line that begins with a number, and most of its words are numbers, finite or not.
bool mostly_numbers(const WordLines& lines) {
  const auto count = std::count_if(lines.words.begin(), lines.words.end(),
                                   [](std::string_view word) { return WordLines::number_in(word) || to_number(word); });
  return lines.words.size() >= shortest_header && WordLines::number_in(lines.words[0]) &&
         2 * std::size_t(count) > lines.words.size();
}

// A degree, an order that it can have, and more.
bool begins_as_row(const WordLines& lines) {
  if (lines.words.size() < 3) return false;
  const auto l = integer_in(lines.words[0]), m = integer_in(lines.words[1]);
  return l && m && *l >= 0 && std::abs(*m) <= *l;
}

class Table {
public:
  Table(std::string_view bytes, const std::string& name) : lines_(name, without_byte_order_mark(bytes)) {}

  CoefficientSet read(std::optional<double> metres) {
    while (lines_.next()) take_line();
    if (rows_.empty()) lines_.fail(Fault::file_truncated, "the file ends before the first row l, m, C, S");
    judge_first_row();
    const bool ours = metadata_.contains("cowgpu");
    lines_.judge_end(ours, set_.notes);
    if (!header_.empty()) set_.kind = CoefficientKind::potential;
    const std::size_t end = lines_.number;
    std::vector<CoefficientRow> rows = plain_rows();
    lines_.number = end;
    int lmax = std::max_element(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.l < b.l; })->l;
    check_lmax(lmax, ours);
    lines_.number = end;
    take_rows(rows, lmax, ours, lines_, set_, orders_to(rows, lmax));
    take_facts(metres);
    if (text_lines_ > 0)
      set_.notes.push_back(fmt::format("{} line{} of text {} passed over, the first is line {}: '{}'", text_lines_,
                                       text_lines_ == 1 ? "" : "s", text_lines_ == 1 ? "was" : "were", first_text_,
                                       text_));
    if (errors_) set_.notes.push_back("the errors of the coefficients were left out");
    return std::move(set_);
  }

private:
  void take_line() {
    if (is_comment(lines_)) return take_comment(lines_.line, lines_.number, metadata_);
    if (rows_.empty() ? begins_as_row(lines_) : begins_as_number(lines_.words[0])) return take_row();
    if (rows_.empty() && all_numbers(lines_)) return take_header();
    if (rows_.empty() && mostly_numbers(lines_))
      for (const std::string_view word : lines_.words) lines_.real(word); // a header, and one of its values is none
    if (metadata_.contains("cowgpu"))
      lines_.fail(Fault::file_syntax, fmt::format("l, m, C, S expected, found '{}'", shown(lines_.line)));
    if (std::find(lines_.words.begin(), lines_.words.end(), "re") != lines_.words.end() &&
        std::find(lines_.words.begin(), lines_.words.end(), "im") != lines_.words.end())
      lines_.fail(Fault::file_format, fmt::format("complex coefficients, by '{}', which are not read from tables; .csv "
                                                  "and .json can hold them",
                                                  shown(lines_.line, 40)));
    if (text_lines_++ > 0) return;
    first_text_ = lines_.number;
    text_ = shown(lines_.line, 40);
  }

  void take_header() {
    const std::size_t size = lines_.words.size();
    if (size < shortest_header || size > longest_header)
      lines_.fail(Fault::file_format,
                  fmt::format("a header of {} value{}, and headers of 4 (r0, gm, omega, lmax) to 8 (r0, gm, its error, "
                              "lmax, mmax, normalised, longitude, latitude) are known{}",
                              size, size == 1 ? "" : "s",
                              size == 2
                                  ? "; coefficients of magnetic fields, which have r0 and lmax, are read without it"
                                  : ""));
    if (!header_.empty()) lines_.fail(Fault::file_syntax, fmt::format("a second header; line {} is one", header_line_));
    header_line_ = lines_.number;
    for (const std::string_view word : lines_.words) header_.push_back(lines_.real(word));
    check_header();
  }

  void check_header() const {
    if (!(header_[0] > 0)) lines_.fail(Fault::file_syntax, "r0 must be above 0");
    if (!(header_[3] >= 0 && header_[3] <= largest_file_degree && header_[3] == std::floor(header_[3])))
      lines_.fail(Fault::file_syntax,
                  fmt::format("lmax is {}, the fourth value of the header; whole numbers from 0 to {} "
                              "are possible",
                              header_[3], largest_file_degree));
    if (header_.size() > 5 && header_[5] != 1 && header_[5] != 0)
      lines_.fail(
          Fault::file_format,
          fmt::format("the sixth value of the header, which says whether the coefficients are normalised, is {}; 1 "
                      "(4pi) and 0 (unnormalised) are read",
                      header_[5]));
  }

  void take_row() {
    const auto& words = lines_.words;
    RawRow row;
    row.line = lines_.number;
    row.words = words.size();
    row.l = lines_.whole(words[0], "the degree", largest_file_degree);
    if (words.size() < 3)
      lines_.fail(Fault::file_truncated, fmt::format("l, m, C and S expected, found {} words", words.size()));
    const bool below = words[1].starts_with('-') && words[1].size() > 1;
    row.m = lines_.whole(words[1].substr(below ? 1 : 0), "the order", row.l) * (below ? -1 : 1);
    if (words.size() > longest_row)
      lines_.fail(Fault::file_syntax, fmt::format("{} words, and a row has at most {}", words.size(), longest_row));
    if (words[2].starts_with('('))
      lines_.fail(Fault::file_format, "complex coefficients, which are not read; .csv and .json can hold them");
    row.first = lines_.real(words[2]);
    for (std::size_t i = words.size(); i-- > 3;) row.second = lines_.real(words[i]);
    dov_ = dov_ || row.m < 0;
    if (rows_.empty() && words.size() >= shortest_header) {
      for (const std::string_view word : words) doubtful_.push_back(lines_.real(word));
    }
    rows_.push_back(row);
  }

  // A header of whole numbers, "1 1 0 2", has the look of a row: it is one where its row comes again or its degree lies above
  // all others, and its lmax is right.
  void judge_first_row() {
    if (!header_.empty() || doubtful_.empty() || rows_.size() < 2) return;
    const RawRow first = rows_.front();
    bool again = false;
    int lmax = 0;
    for (std::size_t i = 1; i < rows_.size(); ++i) {
      again = again || (rows_[i].l == first.l && rows_[i].m == first.m);
      lmax = std::max(lmax, rows_[i].l);
    }
    if ((!again && first.l <= lmax) || doubtful_[3] != lmax) return;
    rows_.erase(rows_.begin());
    header_ = doubtful_;
    header_line_ = first.line;
    check_header();
  }

  std::vector<CoefficientRow> plain_rows() {
    std::vector<CoefficientRow> rows;
    rows.reserve(rows_.size());
    for (const RawRow& raw : rows_) {
      lines_.number = raw.line;
      if (dov_ && raw.words > 4)
        lines_.fail(Fault::file_syntax,
                    fmt::format("{} words; a table with rows of negative orders has degree, order, value "
                                "and perhaps its error",
                                raw.words));
      if (dov_ && raw.second < 0)
        lines_.fail(Fault::file_syntax,
                    "a fourth value below 0 in a table with rows of negative orders, where it is an error; complex "
                    "coefficients are not read from tables, .csv and .json can hold them");
      if (!dov_ && raw.words < 4 && raw.m > 0)
        lines_.fail(Fault::file_truncated,
                    "S is missing; it may also stand in a row of order -m (degree, order, value), but "
                    "this file has no negative orders");
      if (!dov_ && raw.m == 0 && raw.second != 0) lines_.fail(Fault::file_syntax, "S of order 0 must be 0");
      errors_ = errors_ || raw.words > (dov_ ? 3U : 4U);
      if (raw.m < 0)
        rows.push_back({raw.l, -raw.m, 0, raw.first, raw.line});
      else
        rows.push_back({raw.l, raw.m, raw.first, dov_ ? 0 : raw.second, raw.line});
    }
    return dov_ ? paired(std::move(rows)) : rows;
  }

  // C and S of each degree and order, which stand in rows of their own, in one.
  std::vector<CoefficientRow> paired(std::vector<CoefficientRow> halves) {
    std::vector<std::size_t> order(halves.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto key = [&](std::size_t i) {
      return std::tuple(halves[i].l, halves[i].m, rows_[i].m < 0, halves[i].line);
    };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
    std::vector<CoefficientRow> rows;
    std::size_t alone = 0;
    for (std::size_t at = 0; at < order.size(); ++at) {
      const std::size_t i = order[at];
      CoefficientRow row = halves[i];
      const bool sine = rows_[i].m < 0;
      bool whole = row.m == 0;
      if (!sine && row.m > 0 && at + 1 < order.size()) {
        const std::size_t next = order[at + 1];
        whole = halves[next].l == row.l && halves[next].m == row.m && rows_[next].m < 0;
        if (whole) {
          row.s = halves[next].s;
          ++at;
        }
      }
      alone += !whole;
      rows.push_back(row);
    }
    set_.notes.push_back("the rows are degree, order and value; those of order -m were taken as S");
    if (alone > 0)
      set_.notes.push_back(fmt::format("{} value{} C or S without the other, which {} taken as 0", alone,
                                       alone == 1 ? "" : "s", alone == 1 ? "was" : "were"));
    return rows;
  }

  void check_lmax(int lmax, bool ours) {
    const auto differs = [&](double stated) { return stated > lmax ? Fault::file_truncated : Fault::file_syntax; };
    if (!header_.empty() && header_[3] != lmax)
      lines_.fail(differs(header_[3]), fmt::format("the rows end at degree {}, and the header, line {}, says lmax {}",
                                                   lmax, header_line_, header_[3]));
    if (!ours || !metadata_.contains("lmax")) return;
    lines_.number = metadata_["lmax"].line;
    const int stated = lines_.whole(metadata_["lmax"].text, "lmax", largest_file_degree);
    if (stated != lmax)
      lines_.fail(differs(stated), fmt::format("the rows end at degree {}, and lmax is {}", lmax, stated));
  }

  // The largest order, where the header says one below lmax.
  int orders_to(const std::vector<CoefficientRow>& rows, int lmax) {
    if (header_.size() < 5 || !(header_[4] >= 0 && header_[4] < lmax) || header_[4] != std::floor(header_[4]))
      return lmax;
    const int mmax = int(header_[4]);
    const int found =
        std::max_element(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.m < b.m; })->m;
    if (found <= mmax) return mmax;
    set_.notes.push_back(
        fmt::format("the header says that orders end at {}, and rows have orders to {}: all were read", mmax, found));
    return lmax;
  }

  // Convention, body and units.
  void take_facts(std::optional<double> metres) {
    if (!header_.empty()) {
      set_.reference_radius = header_[0];
      set_.gm = header_[1];
    }
    const bool ours = words_of_this_program(metadata_);
    if (ours) metadata_.erase("form");
    if (ours && header_.empty() && (metadata_.contains("kind") || metadata_.contains("coefficients_of")))
      lines_.fail(Fault::file_truncated, "the file says that it is of a potential and has no line r0, gm, omega, lmax");
    for (const char* key : {"normalisation", "phase"})
      if (ours && !metadata_.contains(key))
        lines_.fail(
            Fault::file_syntax,
            fmt::format("by its other comments the file is one of this program, and it has no line '# {0} ...': "
                        "what its numbers mean is not known. Put the line back ('# {0} {1}' where it was so), "
                        "or convert the original again",
                        key, key == std::string_view("phase") ? "none" : "4pi"));
    if (ours) {
      take_metadata(metadata_, lines_.file(), set_);
      agree_with_header(metadata_["normalisation"].line);
      return;
    }
    take_convention();
    if (set_.kind != CoefficientKind::potential) return;
    if (set_.first[0] == 0) {
      set_.first[0] = 1;
      set_.notes.push_back("C_00 is 0 in the file and was taken as 1: the body's mass is in GM");
    }
    if ((header_.size() > 6 && header_[6] != 0) || (header_.size() > 7 && header_[7] != 0))
      set_.notes.push_back(
          fmt::format("the header's reference longitude and latitude, {} and {} degrees, were left out", header_[6],
                      header_.size() > 7 ? header_[7] : 0));
    set_.units_stated = false;
    settle_length_unit(set_, metres, false);
  }

  // Of a file of another program: what its header and its comments say, else what is usual.
  void take_convention() {
    const auto normalisation = normalisation_named(metadata_["normalisation"].text);
    const auto phase = phase_named(metadata_["phase"].text);
    const bool by_header = header_.size() > 5;
    const Normalisation in_header = by_header && header_[5] == 0 ? Normalisation::unnormalised : Normalisation::four_pi;
    set_.convention = {normalisation.value_or(in_header), phase.value_or(Phase::none)};
    set_.normalisation_stated = normalisation || by_header;
    set_.phase_stated = phase.has_value();
    if (normalisation) agree_with_header(metadata_["normalisation"].line);
    if (by_header)
      set_.notes.push_back(fmt::format("the header says that the coefficients are {}normalised: {}",
                                       header_[5] == 1 ? "" : "un", name(set_.convention.normalisation)));
    if (const std::string assumed = assumed_convention(set_); !assumed.empty()) set_.notes.push_back(assumed);
  }

  // The sixth value of a header and a comment say the same.
  void agree_with_header(std::size_t line) {
    if (header_.size() < 6) return;
    const Normalisation in_header = header_[5] == 0 ? Normalisation::unnormalised : Normalisation::four_pi;
    if (in_header == set_.convention.normalisation) return;
    lines_.number = header_line_;
    lines_.fail(Fault::file_syntax,
                fmt::format("the sixth value of the header is {}, which means {}, and line {} says that the "
                            "normalisation is {}; one of them is wrong",
                            header_[5], name(in_header), line, name(set_.convention.normalisation)));
  }

  WordLines lines_;
  CoefficientSet set_{0, 1};
  Metadata metadata_;
  std::vector<RawRow> rows_;
  std::vector<double> header_, doubtful_;
  std::size_t header_line_ = 0, text_lines_ = 0, first_text_ = 0;
  std::string text_;
  bool errors_ = false, dov_ = false;
};

} // namespace

CoefficientSet parse_shtools_text(std::string_view bytes, const std::string& name, std::optional<double> metres) {
  return Table(bytes, name).read(metres);
}

bool looks_like_shtools_text(std::string_view bytes) {
  WordLines lines("", without_byte_order_mark(bytes));
  std::size_t numbers = 0, rows = 0;
  std::set<std::pair<int, int>> seen;
  constexpr std::size_t enough = 200, most_lines = 10000;
  while (numbers < enough && lines.number < most_lines && lines.next()) {
    if (is_comment(lines) || !all_numbers(lines)) continue;
    ++numbers;
    if (!begins_as_row(lines) || lines.words.size() > longest_row) continue;
    ++rows;
    seen.emplace(*integer_in(lines.words[0]), *integer_in(lines.words[1]));
  }
  return 2 * rows > numbers && 10 * (rows - seen.size()) <= rows + 9;
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

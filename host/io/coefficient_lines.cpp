#include "host/io/coefficient_lines.hpp"

#include "host/io/coefficient_metadata.hpp"
#include "host/io/shown.hpp"
#include "host/io/words.hpp"
#include "host/number.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {

bool WordLines::next() {
  if (rest_.empty()) return false;
  const auto end = rest_.find_first_of("\n\r");
  line = rest_.substr(0, end);
  unterminated = end == std::string_view::npos;
  const bool two = !unterminated && end + 1 < rest_.size() && rest_[end] == '\r' && rest_[end + 1] == '\n';
  rest_.remove_prefix(unterminated ? rest_.size() : end + (two ? 2 : 1));
  ++number;
  words.clear();
  constexpr std::string_view gaps = " \t,;";
  for (auto at = line.find_first_not_of(gaps); at != std::string_view::npos;) {
    const auto stop = line.find_first_of(gaps, at);
    words.push_back(line.substr(at, stop - at));
    if (words.size() > 16) break; // no line of these formats has so many
    at = stop == std::string_view::npos ? stop : line.find_first_not_of(gaps, stop);
  }
  return true;
}

std::optional<double> WordLines::number_in(std::string_view word) {
  std::string text(word);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == 'D' || c == 'd'; }, 'e');
  return read_number(text);
}

double WordLines::real(std::string_view word) const {
  if (has_mixed_gaps(line))
    fail(Fault::file_syntax, fmt::format("blanks and commas both part the numbers of '{}'; if a comma stands for the "
                                         "point in one of them, write a point",
                                         shown(line, 60)));
  if (line.find(';') != std::string_view::npos && line.find(',') != std::string_view::npos)
    fail(Fault::file_syntax, fmt::format("semicolons and commas both part the numbers of '{}'; if a comma stands for "
                                         "the point in one of them, write a point",
                                         shown(line, 60)));
  const auto value = number_in(word);
  if (!value) fail(Fault::file_syntax, fmt::format("a number expected; '{}' {}", shown(word), not_a_number(word)));
  return *value;
}

int WordLines::whole(std::string_view word, const char* what, int largest) const {
  const auto value = read_whole(word, 0, largest);
  if (!value)
    fail(Fault::file_syntax,
         fmt::format("{} is '{}'; whole numbers from 0 to {} are possible", what, shown(word), largest));
  return *value;
}

void WordLines::judge_end(bool ours, std::vector<std::string>& notes) const {
  if (!unterminated) return;
  if (ours) fail(Fault::file_truncated, "the last line has no end: the file was cut, perhaps within a number");
  notes.push_back("the last line has no end; if the file was cut there, its last number is a part of one");
}

void WordLines::fail(Fault fault, const std::string& sentence) const {
  throw Error(fault, fmt::format("{}: {}", place(file_, number), sentence));
}

namespace {

// Where (l, m) stands among all coefficients, by l, then m.
std::size_t place_of(int l, int m) {
  return std::size_t(l) * (std::size_t(l) + 1) / 2 + std::size_t(m);
}

// Degree and order at a place.
std::pair<int, int> degree_and_order(std::size_t at) {
  int l = 0;
  while (place_of(l + 1, 0) <= at) ++l;
  return {l, int(at - place_of(l, 0))};
}

// The first place from `next` on, of orders to `mmax`, that no row has.
std::size_t first_gap(const std::vector<CoefficientRow>& rows, std::size_t next, int mmax) {
  auto [l, m] = degree_and_order(next);
  for (const CoefficientRow& row : rows) {
    const std::size_t at = place_of(row.l, row.m);
    if (at == place_of(l, m)) {
      m = m < std::min(l, mmax) ? m + 1 : 0;
      l += m == 0;
    }
    if (at > place_of(l, m)) break;
  }
  return place_of(l, m);
}

// How many coefficients from degree 2 on have orders above `mmax`.
std::size_t count_above(int lmax, int mmax) {
  std::size_t count = 0;
  for (int l = 2; l <= lmax; ++l) count += std::size_t(std::max(l - mmax, 0));
  return count;
}

} // namespace

void take_rows(std::vector<CoefficientRow>& rows, int lmax, bool complete, WordLines& lines, CoefficientSet& set,
               int mmax) {
  mmax = std::min(mmax, lmax);
  const auto before = [](const CoefficientRow& a, const CoefficientRow& b) {
    return std::pair(place_of(a.l, a.m), a.line) < std::pair(place_of(b.l, b.m), b.line);
  };
  if (!std::is_sorted(rows.begin(), rows.end(), before)) std::sort(rows.begin(), rows.end(), before);
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (rows[i].l == rows[i - 1].l && rows[i].m == rows[i - 1].m) {
      lines.number = rows[i].line;
      lines.fail(Fault::file_syntax, fmt::format("degree {}, order {} a second time; line {} has it too", rows[i].l,
                                                 rows[i].m, rows[i - 1].line));
    }
  const std::size_t count = SphereCoefficients::count(lmax);
  const std::size_t low_places = std::min<std::size_t>(count, 3);
  const auto low =
      std::size_t(std::count_if(rows.begin(), rows.end(), [](const CoefficientRow& row) { return row.l < 2; }));
  const std::size_t missing_low = low_places - low,
                    missing = count - rows.size() - missing_low - count_above(lmax, mmax);
  const std::size_t last = rows.empty() ? 0 : place_of(rows.back().l, rows.back().m);
  const auto cut_off = [&](std::size_t at) {
    const auto [l, m] = degree_and_order(at);
    lines.fail(Fault::file_truncated,
               fmt::format("the file ends without a row of degree {}, order {}; its largest degree is {}", l, m, lmax));
  };
  if (complete && missing_low > 0) cut_off(first_gap(rows, 0, mmax));
  if (mmax < lmax)
    set.notes.push_back(fmt::format("the header says that orders end at {}: the rows of higher ones, which the file "
                                    "leaves out, were taken as 0",
                                    mmax));
  if (missing > 0) {
    const std::size_t gap = first_gap(rows, place_of(2, 0), mmax);
    if (complete || gap > last || rows.empty() || rows.back().l < lmax) cut_off(gap);
    if (count > 100000 + 1000 * rows.size())
      lines.fail(
          Fault::too_large,
          fmt::format("{} rows, and the {} coefficients to degree {} are more than 1000 a row: almost all of them "
                      "would be 0",
                      rows.size(), count, lmax));
    const auto [l, m] = degree_and_order(gap);
    set.notes.push_back(
        fmt::format("{} row{} that the file leaves out, the first of degree {}, order {}, {} taken as 0", missing,
                    missing == 1 ? "" : "s", l, m, missing == 1 ? "was" : "were"));
  }
  set.lmax = lmax;
  set.first.assign(count, 0);
  set.second.assign(count, 0);
  const bool constant = !rows.empty() && rows[0].l == 0, unit = set.kind == CoefficientKind::potential && !constant;
  if (missing_low > 0)
    set.notes.push_back(fmt::format("rows of degree{} 1 that the file leaves out were taken as {}",
                                    constant ? "" : "s 0 and", unit ? "C_00 = 1 and 0" : "0"));
  if (unit) set.first[0] = 1;
  for (const CoefficientRow& row : rows) {
    set.first[set.index(0, row.l, row.m)] = row.c;
    set.second[set.index(0, row.l, row.m)] = row.s;
  }
}

} // namespace cowgpu

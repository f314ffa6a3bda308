#include "host/io/plates.hpp"

#include "host/error.hpp"
#include "host/io/sha256.hpp"
#include "host/io/shown.hpp"
#include "host/io/words.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

namespace cowgpu {
namespace {

constexpr std::int64_t most_rows = 0xffffffff;
constexpr std::size_t min_row_bytes = 6; // "0 0 0\n"
constexpr std::size_t most_words = 4;

/// The words of a line that has some.
struct Row {
  std::array<std::string_view, most_words> words;
  std::size_t count = 0; ///< more than most_words: the rest is not kept
  std::size_t line = 0;
};

Row next_row(WordScanner& scan) {
  Row row;
  for (std::string_view word = scan.word(); !word.empty(); word = scan.word_on_line(), ++row.count) {
    if (row.count < most_words) row.words[row.count] = word;
    row.line = scan.line();
  }
  return row;
}

class PlateParser {
public:
  PlateParser(std::string_view text, const std::string& name) : scan_(text) { mesh_.name = name; }

  RawMesh parse() {
    const Row counts = row();
    if (counts.count > 2)
      fail(Fault::file_format, "the first line of a plate model has the numbers of vertices and plates.");
    vertex_count_ = count(counts.words[0], "vertices");
    if (counts.count == 2) plate_count_ = count(counts.words[1], "plates");
    vertices();
    if (counts.count == 1) {
      const Row plates = row();
      if (plates.count != 1) fail(Fault::file_syntax, "the number of plates expected, alone on its line.");
      plate_count_ = count(plates.words[0], "plates");
    }
    plates();
    number_from_zero();
    if (const Row more = next_row(scan_); more.count != 0)
      mesh_.notes.push_back(fmt::format("Data after the last announced plate were ignored (from line {}).", more.line));
    return std::move(mesh_);
  }

private:
  [[noreturn]] void fail(Fault fault, const std::string& sentence) const {
    throw Error(fault, fmt::format("{}:{}: {}", mesh_.name, line_, sentence));
  }

  Row row() {
    const Row row = next_row(scan_);
    line_ = row.count == 0 ? scan_.line() : row.line;
    if (row.count == 0)
      fail(Fault::file_truncated,
           fmt::format(
               "the file ends after {} of {} vertices and {} of {} plates. It was cut off, or its counts are wrong; "
               "fetch it again.",
               mesh_.vertices.size(), vertex_count_, mesh_.faces.size(), plate_count_));
    return row;
  }

  std::int64_t integer(std::string_view word, const char* what) const {
    const auto value = to_integer(word);
    if (!value) fail(Fault::file_syntax, fmt::format("{} expected, found '{}'.", what, shown(word)));
    return *value;
  }

  std::uint64_t count(std::string_view word, const char* what) const {
    const std::int64_t value = integer(word, "a number of rows");
    if (value < 0 || value > most_rows)
      fail(Fault::file_syntax,
           fmt::format("'{}' {} are announced; from 0 to {} are possible.", shown(word), what, most_rows));
    return static_cast<std::uint64_t>(value);
  }

  /// A table of `count` rows of three values. `take` gets their words. A fourth word before them is the row's number, or 3
  /// where `corners` allows a count of corners.
  template <class Take>
  void table(std::uint64_t count, const char* what, bool corners, Take&& take) {
    std::size_t width = 0;
    std::int64_t first = 0;
    bool numbered = false;
    for (std::uint64_t i = 0; i < count; ++i) {
      const Row row = this->row();
      if (i == 0) {
        width = row.count;
        if (width != 3 && width != 4)
          fail(Fault::file_format,
               fmt::format("the first row of the {} has {} values; 3, or 4 with the row's number, are read.", what,
                           width));
        if (width == 4) first = integer(row.words[0], "the row's number");
        numbered = width == 4 && (first == 0 || first == 1);
        if (width == 4 && !numbered && !(corners && first == 3))
          fail(Fault::file_format, fmt::format("the {} are numbered from {}; from 1 or 0 is read.", what, first));
      }
      if (row.count != width) {
        if (scan_.left() == 0 && row.count < width) next_is_missing();
        fail(Fault::file_syntax,
             fmt::format("row {} of the {} has {} values, the first one {}.", i + 1, what, row.count, width));
      }
      const std::int64_t expected = numbered ? first + static_cast<std::int64_t>(i) : first;
      if (width == 4 && integer(row.words[0], "the row's number") != expected)
        fail(Fault::file_syntax, fmt::format("{} expected where row {} of the {} begins, found '{}'.", expected, i + 1,
                                             what, shown(row.words[0])));
      take(row, width - 3);
    }
  }

  [[noreturn]] void next_is_missing() const {
    fail(Fault::file_truncated,
         fmt::format("the file ends within a row, after {} of {} vertices and {} of {} plates. It was "
                     "cut off; fetch it again.",
                     mesh_.vertices.size(), vertex_count_, mesh_.faces.size(), plate_count_));
  }

  std::size_t room(std::uint64_t rows) const { return std::min<std::uint64_t>(rows, scan_.left() / min_row_bytes + 1); }

  void vertices() {
    mesh_.vertices.reserve(room(vertex_count_));
    table(vertex_count_, "vertices", false, [&](const Row& row, std::size_t at) {
      Vec3 p;
      for (int c = 0; c < 3; ++c) {
        const auto value = to_number(row.words[at + std::size_t(c)]);
        if (!value)
          fail(Fault::file_syntax, fmt::format("a coordinate of row {} of the vertices expected, found '{}'.",
                                               mesh_.vertices.size() + 1, shown(row.words[at + std::size_t(c)])));
        p[c] = *value;
      }
      mesh_.vertices.push_back(p);
    });
  }

  /// As the file numbers them; every number but 0 is that of a vertex counted from 1.
  void plates() {
    mesh_.faces.reserve(room(plate_count_));
    mesh_.face_lines.reserve(room(plate_count_));
    table(plate_count_, "plates", true, [&](const Row& row, std::size_t at) {
      Face face;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int64_t vertex = integer(row.words[at + k], "a vertex of a plate");
        if (vertex < 0 || static_cast<std::uint64_t>(vertex) > vertex_count_) no_vertex(vertex);
        face[k] = static_cast<std::uint32_t>(vertex);
        names_zero_ = names_zero_ || vertex == 0;
        names_last_ = names_last_ || static_cast<std::uint64_t>(vertex) == vertex_count_;
        if (names_zero_ && names_last_) no_vertex(vertex);
      }
      mesh_.faces.push_back(face);
      mesh_.face_lines.push_back(static_cast<std::uint32_t>(std::min<std::size_t>(row.line, 0xffffffff)));
    });
  }

  [[noreturn]] void no_vertex(std::int64_t vertex) const {
    fail(Fault::mesh_index_range,
         fmt::format("row {} of the plates names vertex {}, but there are {} vertices{}.", mesh_.faces.size() + 1,
                     vertex, vertex_count_,
                     names_zero_ ? ", and both 0 and that number are named" : ", numbered from 1"));
  }

  void number_from_zero() {
    if (names_zero_)
      mesh_.notes.push_back(
          "The plates name vertex 0, and none the last one counted from 1: vertices were numbered from 0.");
    else
      for (Face& face : mesh_.faces)
        for (std::uint32_t& vertex : face) --vertex;
  }

  WordScanner scan_;
  RawMesh mesh_;
  std::size_t line_ = 1;
  std::uint64_t vertex_count_ = 0, plate_count_ = 0;
  bool names_zero_ = false, names_last_ = false;
};

} // namespace

RawMesh parse_plates(std::string_view bytes, const std::string& name) {
  RawMesh mesh = PlateParser(without_byte_order_mark(bytes), name).parse();
  mesh.sha256 = sha256_hex(bytes);
  return mesh;
}

bool looks_like_plates(std::string_view bytes) {
  WordScanner scan(without_byte_order_mark(bytes));
  const Row counts = next_row(scan), vertex = next_row(scan);
  const auto is_count = [](std::string_view word) { return to_integer(word).value_or(0) > 0; };
  if (counts.count < 1 || counts.count > 2 || vertex.count < 3 || vertex.count > 4) return false;
  for (std::size_t i = 0; i < counts.count; ++i)
    if (!is_count(counts.words[i])) return false;
  for (std::size_t i = 0; i < vertex.count; ++i)
    if (!to_number(vertex.words[i])) return false;
  const auto first = to_integer(vertex.words[0]);
  return counts.count == 2 || (vertex.count == 4 && first && (*first == 0 || *first == 1));
}

} // namespace cowgpu

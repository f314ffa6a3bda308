#include "host/io/stl.hpp"

#include "host/counted.hpp"
#include "host/error.hpp"
#include "host/io/sha256.hpp"
#include "host/io/shown.hpp"
#include "host/io/words.hpp"
#include "host/mesh/topology.hpp"
#include "host/mesh/weld.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>

namespace cowgpu {
namespace {

static_assert(std::endian::native == std::endian::little, "the reader copies memory");

constexpr std::size_t header_bytes = 84, facet_bytes = 50, normal_bytes = 12, corner_bytes = 12;
constexpr std::size_t most_facets = 0x55555554; // three corners each in 32 bits

std::uint64_t announced(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return count;
}

Vec3 floats(const char* at) {
  std::array<float, 3> xyz;
  std::memcpy(xyz.data(), at, sizeof xyz);
  return {double(xyz[0]), double(xyz[1]), double(xyz[2])};
}

class StlParser {
public:
  StlParser(std::string_view bytes, const std::string& name) : bytes_(bytes), welder_(mesh_.vertices) {
    mesh_.name = name;
  }

  RawMesh parse() {
    if (looks_like_binary_stl(bytes_))
      binary();
    else
      ascii();
    notes();
    return std::move(mesh_);
  }

private:
  [[noreturn]] void fail(Fault fault, std::size_t line, const std::string& sentence) const {
    throw Error(fault, fmt::format("{}:{}: {}", mesh_.name, line, sentence));
  }

  void facet(const Vec3& normal, const std::array<Vec3, 3>& corners, std::optional<std::size_t> line) {
    ++facets_;
    const double along = normal.dot((corners[1] - corners[0]).cross(corners[2] - corners[0]));
    against_ += along < 0;
    along_ += along > 0;
    const Face face = {welder_.index(corners[0]), welder_.index(corners[1]), welder_.index(corners[2])};
    if (repeats_vertex(face)) return;
    mesh_.faces.push_back(face);
    if (line) mesh_.face_lines.push_back(static_cast<std::uint32_t>(std::min<std::size_t>(*line, 0xffffffff)));
  }

  void binary() {
    const auto truncated = [&](const std::string& what) {
      throw Error(Fault::file_truncated,
                  fmt::format("{}: at byte {}: {} It was cut off or its header is wrong; fetch or "
                              "export it again.",
                              mesh_.name, bytes_.size(), what));
    };
    if (bytes_.size() < header_bytes) truncated("the file ends within the 84 bytes before the first facet.");
    const std::size_t behind = bytes_.size() - header_bytes;
    const std::uint64_t found = behind / facet_bytes;
    std::uint64_t count = announced(bytes_);
    if (count == 0 && behind != 0) {
      // Programs that write facets as they come leave the number out.
      if (behind % facet_bytes != 0)
        truncated(fmt::format("the header announces 0 facets, and {}, which {} no whole number of facets of {} bytes.",
                              counted(behind, "byte follows", "bytes follow"), behind == 1 ? "is" : "are",
                              facet_bytes));
      count = found;
      mesh_.notes.push_back(
          fmt::format("The header announces 0 facets, but {} bytes follow: {} facets were read, by the file's length.",
                      behind, count));
    }
    if (found < count) truncated(fmt::format("the file ends after {} of {} facets.", found, count));
    if (count > most_facets)
      throw Error(Fault::too_large,
                  fmt::format("{}: the file has {} facets; up to {} are read.", mesh_.name, count, most_facets));
    mesh_.faces.reserve(count);
    mesh_.vertices.reserve(count / 2 + 2); // as many vertices as a closed surface of one shell has
    std::uint64_t attributes = 0;
    for (std::uint64_t f = 0; f < count; ++f) {
      const char* at = bytes_.data() + header_bytes + f * facet_bytes;
      const char* corner = at + normal_bytes;
      facet(floats(at), {floats(corner), floats(corner + corner_bytes), floats(corner + 2 * corner_bytes)}, {});
      attributes += at[facet_bytes - 2] != 0 || at[facet_bytes - 1] != 0;
    }
    if (attributes != 0)
      mesh_.notes.push_back(
          fmt::format("Attribute bytes, colours usually, were skipped (facets that have any: {}).", attributes));
    if (const std::size_t end = header_bytes + count * facet_bytes; end != bytes_.size())
      mesh_.notes.push_back(fmt::format("{} after the last facet {} ignored (from byte {}).",
                                        counted(bytes_.size() - end, "byte", "bytes"),
                                        bytes_.size() - end == 1 ? "was" : "were", end));
  }

  void ascii() {
    WordScanner scan(without_byte_order_mark(bytes_), '\0');
    std::string_view word = keyword(scan);
    if (word.empty()) fail(Fault::file_truncated, scan.line(), "the file is empty. Fetch or export it again.");
    if (!same_word(word, "solid"))
      fail(Fault::file_format, scan.line(),
           fmt::format("this is not an STL file: it begins with '{}' where the word solid belongs.", shown(word)));
    // Less than this no facet takes: "facet normal 0 0 0 outer loop vertex 0 0 0 ... endloop endfacet".
    mesh_.faces.reserve(bytes_.size() / 88);
    mesh_.face_lines.reserve(bytes_.size() / 88);
    while (!word.empty()) {
      require(scan, word, "solid");
      word = solid(scan);
    }
  }

  [[noreturn]] void unexpected(const WordScanner& scan, std::string_view word, std::string_view expected) const {
    if (word.empty() || scan.left() == 0)
      fail(Fault::file_truncated, scan.line(),
           fmt::format("the file ends after {}, before {}. It was cut off; fetch or export it again.",
                       counted(facets_, "facet", "facets"), expected));
    fail(Fault::file_syntax, scan.line(),
         fmt::format("{} expected after {}, found '{}'.", expected, counted(facets_, "facet", "facets"), shown(word)));
  }

  void require(const WordScanner& scan, std::string_view word, std::string_view expected) const {
    if (!same_word(word, expected)) unexpected(scan, word, fmt::format("'{}'", expected));
  }
  void require(WordScanner& scan, std::string_view expected) const { require(scan, scan.word(), expected); }

  /// The next word that is none of a comment or of a colour, which some programs write on lines of their own or behind
  /// what a line holds.
  std::string_view keyword(WordScanner& scan) {
    for (;;) {
      const std::string_view word = scan.word();
      const bool skipped = word.starts_with('#') || word.starts_with(';') || word.starts_with("//") ||
                           same_word(word, "comment") || same_word(word, "color") || same_word(word, "colour");
      if (!skipped) return word;
      scan.skip_line();
      ++skipped_;
    }
  }

  /// Whether the word is `end` with what is ended glued to it, or behind it.
  static bool ends(WordScanner& scan, std::string_view word, std::string_view what) {
    if (same_word(word, "end")) return same_word(scan.word(), what);
    return word.size() > 3 && same_word(word.substr(0, 3), "end") && same_word(word.substr(3), what);
  }

  void require_end(WordScanner& scan, std::string_view what) {
    const std::string_view word = keyword(scan);
    if (!ends(scan, word, what)) unexpected(scan, word, fmt::format("'end{}'", what));
  }

  /// After the word `solid`, to the name behind `endsolid`; returns the word behind that.
  std::string_view solid(WordScanner& scan) {
    std::string_view word = skip_name(scan);
    if (word.empty()) word = keyword(scan);
    for (; same_word(word, "facet"); word = keyword(scan)) {
      const std::size_t line = scan.line();
      require(scan, keyword(scan), "normal");
      const Vec3 normal = vector(scan, false);
      require(scan, keyword(scan), "outer");
      require(scan, "loop");
      std::array<Vec3, 3> corners;
      for (Vec3& corner : corners) {
        require(scan, keyword(scan), "vertex");
        corner = vector(scan, true);
      }
      require_end(scan, "loop");
      require_end(scan, "facet");
      if (facets_ == most_facets) fail(Fault::too_large, line, fmt::format("more than {} facets.", most_facets));
      facet(normal, corners, line);
    }
    if (facets_ != 0 && (word.empty() || same_word(word, "solid"))) {
      mesh_.notes.push_back(fmt::format("Line {}: the word 'endsolid' is missing after {}, the last of which is "
                                        "whole. If facets are missing, fetch or export the file again.",
                                        scan.line(), counted(facets_, "facet", "facets")));
      return word;
    }
    if (!ends(scan, word, "solid")) unexpected(scan, word, "'endsolid'");
    if (!skip_name(scan).empty()) fail(Fault::file_syntax, scan.line(), "a facet after the word endsolid.");
    return keyword(scan);
  }

  /// Skips a solid's name, to the line's end or to the words `facet normal` of a facet; then the word `facet` is returned.
  static std::string_view skip_name(WordScanner& scan) {
    for (std::string_view word = scan.word_on_line(); !word.empty(); word = scan.word_on_line())
      if (same_word(word, "facet") && begins_facet(scan)) return word;
    return {};
  }

  /// Whether behind the word `facet` a facet goes on, and no name with this word: its loop follows, on this line or the next, or
  /// the normal's next number.
  static bool begins_facet(WordScanner ahead) {
    if (!same_word(ahead.word_on_line(), "normal")) return false;
    for (std::string_view word = ahead.word_on_line(); !word.empty(); word = ahead.word_on_line())
      if (same_word(word, "outer")) return true;
    const std::string_view below = ahead.word();
    return same_word(below, "outer") || to_number(below);
  }

  /// Three numbers. What is no number is let pass in normals, where some programs write "-nan(ind)".
  Vec3 vector(WordScanner& scan, bool strict) const {
    Vec3 v;
    for (int c = 0; c < 3; ++c) {
      const std::string_view word = scan.word();
      const auto value = to_number(word);
      if (word.empty() || (!value && (strict || same_word(word, "outer")))) unexpected(scan, word, "a number");
      v[c] = value.value_or(0);
    }
    return v;
  }

  void notes() {
    const std::size_t corners = 3 * facets_, vertices = mesh_.vertices.size(), left_out = facets_ - mesh_.faces.size();
    mesh_.notes.push_back(fmt::format("STL has no topology: {} corners of {} facets were welded into {} vertices where "
                                      "their coordinates are exactly equal.",
                                      corners, facets_, vertices));
    if (skipped_ != 0)
      mesh_.notes.push_back(fmt::format("{} skipped.", skipped_ == 1
                                                           ? "1 comment or colour was"
                                                           : fmt::format("{} comments and colours were", skipped_)));
    if (left_out != 0)
      mesh_.notes.push_back(fmt::format("Facets with two corners at one point were left out: {}.", left_out));
    if (100 * against_ > facets_)
      mesh_.notes.push_back(
          fmt::format("The normals of {} of {} facets look against the order of their corners; the order "
                      "counts.",
                      against_, against_ + along_));
  }

  std::string_view bytes_;
  RawMesh mesh_;
  PointWelder welder_;
  std::size_t facets_ = 0, along_ = 0, against_ = 0, skipped_ = 0;
};

} // namespace

bool looks_like_binary_stl(std::string_view bytes) {
  if (bytes.size() >= header_bytes && (bytes.size() - header_bytes) % facet_bytes == 0 &&
      announced(bytes) == (bytes.size() - header_bytes) / facet_bytes)
    return true;
  for (const std::string_view magic : {"glTF", "ply\n", "ply\r", "\xff\xfe", "\xfe\xff"})
    if (bytes.starts_with(magic)) return false;
  // Text holds no zero byte; the number of facets, their coordinates and their attributes do.
  return bytes.substr(0, 1024).find('\0') != std::string_view::npos;
}

RawMesh parse_stl(std::string_view bytes, const std::string& name) {
  RawMesh mesh = StlParser(bytes, name).parse();
  mesh.sha256 = sha256_hex(bytes);
  return mesh;
}

} // namespace cowgpu

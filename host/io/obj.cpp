#include "host/io/obj.hpp"

#include "host/counted.hpp"
#include "host/error.hpp"
#include "host/io/mesh_faces.hpp"
#include "host/io/sha256.hpp"
#include "host/io/shown.hpp"
#include "host/io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

namespace cowgpu {
namespace {

enum class Statement { vertex, face, line, point, skipped, curve, call };

struct Keyword {
  std::string_view word;
  Statement statement;
};

constexpr Keyword keywords[] = {
    {"v", Statement::vertex},
    {"f", Statement::face},
    {"fo", Statement::face},
    {"l", Statement::line},
    {"p", Statement::point},
    {"vt", Statement::skipped},
    {"vn", Statement::skipped},
    {"vp", Statement::skipped},
    {"g", Statement::skipped},
    {"s", Statement::skipped},
    {"o", Statement::skipped},
    {"mg", Statement::skipped},
    {"usemtl", Statement::skipped},
    {"mtllib", Statement::skipped},
    {"usemap", Statement::skipped},
    {"maplib", Statement::skipped},
    {"bevel", Statement::skipped},
    {"c_interp", Statement::skipped},
    {"d_interp", Statement::skipped},
    {"lod", Statement::skipped},
    {"shadow_obj", Statement::skipped},
    {"trace_obj", Statement::skipped},
    {"ctech", Statement::skipped},
    {"stech", Statement::skipped},
    {"cstype", Statement::curve},
    {"deg", Statement::curve},
    {"bmat", Statement::curve},
    {"step", Statement::curve},
    {"curv", Statement::curve},
    {"curv2", Statement::curve},
    {"surf", Statement::curve},
    {"parm", Statement::curve},
    {"trim", Statement::curve},
    {"hole", Statement::curve},
    {"scrv", Statement::curve},
    {"sp", Statement::curve},
    {"end", Statement::curve},
    {"con", Statement::curve},
    {"bzp", Statement::curve},
    {"bsp", Statement::curve},
    {"cdc", Statement::curve},
    {"cdp", Statement::curve},
    {"res", Statement::curve},
    {"call", Statement::call},
    {"csh", Statement::call},
};

const Keyword* keyword(std::string_view word) {
  const auto found =
      std::find_if(std::begin(keywords), std::end(keywords), [&](const Keyword& k) { return k.word == word; });
  return found == std::end(keywords) ? nullptr : found;
}

/// A word that a line may open with, known or not: a line of numbers, or of bytes that are no text, is a broken line.
bool may_be_keyword(std::string_view word) {
  return std::string_view("0123456789+-.").find(word[0]) == std::string_view::npos &&
         std::none_of(word.begin(), word.end(),
                      [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 0x7f; });
}

/// Thrown where a file that was read as numbered from 1 names vertex 0.
struct VertexZero {
  Error error;
};

class ObjParser {
public:
  /// `base`: the number of the first vertex, 1 or 0.
  ObjParser(std::string_view text, const std::string& name, std::uint32_t base)
      : text_(text), scan_(text), base_(base), faces_(mesh_, base) {
    mesh_.name = name;
  }

  RawMesh parse() {
    count();
    bool empty = true;
    for (std::string_view word = scan_.word(); !word.empty(); word = scan_.word(), empty = false) {
      const Keyword* known = keyword(word);
      if (!known) {
        unknown(word);
        continue;
      }
      ++known_;
      switch (known->statement) {
      case Statement::vertex: vertex(); break;
      case Statement::face: face(); break;
      case Statement::line: ++lines_, scan_.skip_joined_lines(); break;
      case Statement::point: ++points_, scan_.skip_joined_lines(); break;
      case Statement::skipped: scan_.skip_joined_lines(); break;
      case Statement::curve:
        fail(Fault::file_format, fmt::format("free-form curves and surfaces ('{}') are not read. Export the surface "
                                             "as triangles.",
                                             word));
      case Statement::call:
        fail(Fault::file_format,
             fmt::format("'{}' leads out of the file, which is not followed. Export the body into one file.", word));
      }
    }
    if (empty) fail(Fault::file_truncated, "the file is empty. Fetch or export it again.");
    if (known_ == 0)
      fail(Fault::file_format, fmt::format("this is not an OBJ file: it has no statement of OBJ, but '{}'.",
                                           fmt::join(unknown_words_, "', '")));
    notes();
    return std::move(mesh_);
  }

private:
  [[noreturn]] void fail(Fault fault, const std::string& sentence) const {
    throw Error(fault, fmt::format("{}:{}: {}", mesh_.name, scan_.line(), sentence));
  }

  /// A breach of the grammar; at the very end of the file more likely a file cut off.
  [[noreturn]] void fail_syntax(const std::string& sentence) const {
    if (scan_.left() != 0) fail(Fault::file_syntax, sentence);
    fail(Fault::file_truncated, sentence + " The file ends here; if it was cut off, fetch or export it again.");
  }

  /// How many vertices there are, which faces may name before they come, and how much room to make.
  void count() {
    WordScanner scan(text_);
    std::size_t triangles = 0;
    for (std::string_view word = scan.word(); !word.empty(); word = scan.word()) {
      if (word == "v") ++vertex_count_;
      if (word != "f" && word != "fo") {
        scan.skip_joined_lines();
        continue;
      }
      std::size_t corners = 0;
      while (!scan.word_on_joined_lines().empty()) ++corners;
      triangles += corners < 3 ? 0 : corners - 2;
    }
    if (vertex_count_ > 0xffffffff)
      fail(Fault::too_large, fmt::format("{} vertices; up to 4294967295 are possible.", vertex_count_));
    mesh_.vertices.reserve(vertex_count_);
    mesh_.faces.reserve(triangles);
    mesh_.face_lines.reserve(triangles);
  }

  void unknown(std::string_view word) {
    if (!may_be_keyword(word) || same_word(word, "v") || same_word(word, "f") || same_word(word, "fo"))
      fail_syntax(fmt::format("'{}' is not a statement of an OBJ file.", shown(word)));
    ++unknown_lines_;
    const std::string text = shown(word);
    if (unknown_words_.size() < 8 &&
        std::find(unknown_words_.begin(), unknown_words_.end(), text) == unknown_words_.end())
      unknown_words_.push_back(text);
    scan_.skip_joined_lines();
  }

  void vertex() {
    Vec3 p;
    int numbers = 0;
    for (std::string_view word = scan_.word_on_joined_lines(); !word.empty();
         word = scan_.word_on_joined_lines(), ++numbers) {
      const auto value = to_number(word);
      if (!value)
        fail_syntax(
            fmt::format("a coordinate of vertex {} expected, found '{}'.", mesh_.vertices.size() + 1, shown(word)));
      if (numbers < 3) p[numbers] = *value;
      if (numbers == 3) weight_ = *value;
    }
    if (numbers != 3 && numbers != 4 && numbers != 6 && numbers != 7)
      fail_syntax(
          fmt::format("vertex {} has {} numbers; a vertex has 3 coordinates, alone, with a weight (4) or with a "
                      "colour (6, or 7 with its opacity).",
                      mesh_.vertices.size() + 1, numbers));
    weights_ += numbers == 4 && weight_ != 1;
    colours_ += numbers >= 6;
    mesh_.vertices.push_back(p);
  }

  /// The vertex, from 0, of a corner "v/vt/vn".
  std::uint32_t corner(std::string_view word) const {
    const std::size_t slash = std::min(word.find('/'), word.size());
    const auto value = to_integer(word.substr(0, slash));
    if (!value || !texture_and_normal(word.substr(slash)))
      fail_syntax(fmt::format("a corner of face {} expected (v, v/vt, v//vn or v/vt/vn), found '{}'.", faces_found_,
                              shown(word)));
    const auto above = static_cast<std::int64_t>(mesh_.vertices.size());
    const std::int64_t from_first = *value < 0 ? -1 : *value - base_;
    if (from_first >= 0 && static_cast<std::uint64_t>(from_first) < vertex_count_)
      return static_cast<std::uint32_t>(from_first);
    if (*value < 0 && *value >= -above) return static_cast<std::uint32_t>(above + *value);
    const std::string number = shown(word.substr(0, slash));
    const auto refuse = [&](const std::string& why) {
      return Error(Fault::mesh_index_range, fmt::format("{}:{}: face {} names vertex {}, {}", mesh_.name, scan_.line(),
                                                        faces_found_, number, why));
    };
    if (*value < 0)
      throw refuse(fmt::format("counted backwards, but {} above it.",
                               counted(std::uint64_t(above), "vertex stands", "vertices stand")));
    const Error error =
        refuse(fmt::format("but there {} {}, numbered from {}. Export the mesh again.",
                           vertex_count_ == 1 ? "is" : "are", counted(vertex_count_, "vertex", "vertices"), base_));
    if (*value == 0 && base_ == 1) throw VertexZero{error};
    throw error;
  }

  /// "", "/vt", "//vn" or "/vt/vn", where numbers may be missing.
  static bool texture_and_normal(std::string_view rest) {
    for (int parts = 0; !rest.empty(); ++parts) {
      rest.remove_prefix(1); // the slash
      const std::size_t end = std::min(rest.find('/'), rest.size());
      if (parts == 2 || (end != 0 && !to_integer(rest.substr(0, end)))) return false;
      rest.remove_prefix(end);
    }
    return true;
  }

  void face() {
    faces_.begin(scan_.line());
    for (std::string_view word = scan_.word_on_joined_lines(); !word.empty(); word = scan_.word_on_joined_lines())
      faces_.corner(corner(word));
    // A short face at the very end of the file is one that was cut off.
    if (faces_.corners() == 0 || (faces_.corners() < 3 && scan_.left() == 0))
      fail_syntax(fmt::format("face {} has {} corners; a face needs 3.", faces_found_, faces_.corners()));
    faces_.end();
    ++faces_found_;
  }

  void notes() {
    faces_.finish(points_, lines_);
    if (base_ == 0)
      mesh_.notes.push_back(
          "The faces name vertex 0, and none the last one counted from 1: vertices were numbered from 0.");
    if (weights_ != 0)
      mesh_.notes.push_back(
          fmt::format("{} a weight other than 1, which counts for curves only: x, y and z were taken as they are.",
                      counted(weights_, "vertex has", "vertices have")));
    if (colours_ != 0) mesh_.notes.push_back("Colours of the vertices were skipped.");
    if (unknown_lines_ != 0)
      mesh_.notes.push_back(
          fmt::format("{} that OBJ does not have {} skipped: {}.",
                      unknown_lines_ == 1 ? "A statement" : fmt::format("{} statements", unknown_lines_),
                      unknown_lines_ == 1 ? "was" : "were", fmt::join(unknown_words_, ", ")));
  }

  std::string_view text_;
  WordScanner scan_;
  RawMesh mesh_;
  std::uint32_t base_;
  MeshFaces faces_;
  double weight_ = 1;
  std::uint64_t vertex_count_ = 0, faces_found_ = 0, weights_ = 0, colours_ = 0, lines_ = 0, points_ = 0;
  std::uint64_t known_ = 0, unknown_lines_ = 0;
  std::vector<std::string> unknown_words_; // some
};

} // namespace

bool is_obj_statement(std::string_view word) {
  return keyword(word) != nullptr;
}

RawMesh parse_obj(std::string_view bytes, const std::string& name) {
  const std::string_view text = without_byte_order_mark(bytes);
  std::optional<Error> names_zero;
  RawMesh mesh;
  try {
    mesh = ObjParser(text, name, 1).parse();
  } catch (const VertexZero& zero) {
    names_zero = zero.error;
  }
  if (names_zero) {
    try {
      mesh = ObjParser(text, name, 0).parse();
    } catch (const Error& error) {
      throw error.fault() == Fault::mesh_index_range ? *names_zero : error;
    }
  }
  mesh.sha256 = sha256_hex(bytes);
  return mesh;
}

} // namespace cowgpu

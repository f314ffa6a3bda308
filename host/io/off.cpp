#include "host/io/off.hpp"

#include "host/error.hpp"
#include "host/io/mesh_faces.hpp"
#include "host/io/sha256.hpp"
#include "host/io/shown.hpp"
#include "host/io/words.hpp"
#include "host/version.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

namespace cowgpu {
namespace {

constexpr std::uint64_t max_count = 0xffffffff;
constexpr std::size_t min_vertex_bytes = 6; // "0 0 0\n"
constexpr std::size_t min_face_bytes = 8;   // "3 0 0 0\n"

class OffParser {
public:
  /// `extras`: how many numbers follow the coordinates on every vertex line, where the header's kind is not believed.
  OffParser(std::string_view text, const std::string& name, std::optional<int> extras = {})
      : scan_(text), faces_(mesh_), extras_(extras) {
    mesh_.name = name;
  }

  RawMesh parse() {
    header();
    counts();
    vertices();
    faces();
    rest();
    return std::move(mesh_);
  }

  /// Under a header that announces coordinates alone: how many numbers the first vertex line holds beyond them. 0 under
  /// another, and before parse().
  int numbers_beyond() const { return beyond_; }
  bool data_follow() const { return data_follow_; }
  std::string header_word() const { return shown(header_word_); }

private:
  [[noreturn]] void fail(Fault fault, const std::string& sentence) const {
    throw Error(fault, fmt::format("{}:{}: {}", mesh_.name, scan_.line(), sentence));
  }

  [[noreturn]] void ended() const {
    fail(Fault::file_truncated,
         fmt::format("the file ends after {} of {} vertices and {} of {} faces. It was cut off, or "
                     "the counts at its top are wrong; fetch or export it again.{}",
                     vertices_found_, vertex_count_, faces_found_, face_count_, hint()));
  }

  std::string hint() const {
    if (beyond_ == 0 || extras_) return "";
    return fmt::format(
        " The first vertex line holds {} numbers under the header {}: one with colours must say COFF, with "
        "normals NOFF, with both CNOFF, with texture positions STOFF.",
        beyond_ + 3, header_word());
  }

  [[noreturn]] void not_a_number(const std::string& what, std::string_view word) const {
    fail(Fault::file_syntax, fmt::format("{} expected, found '{}'.{}", what, shown(word), hint()));
  }

  void header() {
    const std::string_view word = scan_.word();
    header_word_ = word;
    if (word.empty()) fail(Fault::file_truncated, "the file is empty. Fetch or export it again.");
    std::size_t i = 0;
    for (; i < word.size(); ++i) {
      if (word[i] == 'C' && !colours_)
        colours_ = true;
      else if (word[i] == 'N' && !normals_)
        normals_ = true;
      else if (word.substr(i, 2) == "ST" && !texture_)
        texture_ = true, ++i;
      else
        break;
    }
    const std::string_view kind = word.substr(i);
    if (kind.starts_with("4OFF") || kind.starts_with("nOFF") || kind.starts_with("4nOFF"))
      fail(Fault::file_format, fmt::format("'{}' holds points of other than three coordinates. Export the surface as "
                                           "plain OFF.",
                                           shown(word)));
    const bool off = kind.starts_with("OFF");
    // Some collections glue the first count to the header: "OFF490 518 0".
    const bool glued = off && kind.size() > 3 &&
                       std::all_of(kind.begin() + 3, kind.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!off || (kind.size() > 3 && !glued)) {
      const bool wide = word.starts_with("\xff\xfe") || word.starts_with("\xfe\xff");
      fail(Fault::file_format,
           wide ? "the file is UTF-16 text. Save it as UTF-8 or ASCII."
                : fmt::format(
                      "this is not an OFF file: it begins with '{}' where the word OFF belongs. Export the mesh as OFF "
                      "(MeshLab, Blender and meshio do), or add the header if it is missing.",
                      shown(word)));
    }
    if (glued) scan_.put_back(kind.size() - 3);
    header_word_ = word.substr(0, i + 3);
  }

  std::uint64_t count(const char* what, std::string_view word) const {
    const auto value = to_integer(word);
    if (!value) not_a_number(fmt::format("the number of {}", what), word);
    if (*value < 0 || static_cast<std::uint64_t>(*value) > max_count)
      fail(Fault::file_syntax,
           fmt::format("'{}' {} are announced; from 0 to {} are possible.", shown(word), what, max_count));
    return static_cast<std::uint64_t>(*value);
  }

  void counts() {
    std::string_view word = scan_.word();
    if (word == "BINARY") fail(Fault::file_format, "binary OFF is not read. Export the mesh as ASCII OFF.");
    if (word.empty()) fail(Fault::file_truncated, "the file ends before the numbers of vertices and faces.");
    vertex_count_ = count("vertices", word);
    word = scan_.word();
    if (word.empty()) fail(Fault::file_truncated, "the file ends before the number of faces.");
    face_count_ = count("faces", word);
    scan_.word_on_line(); // edges: often 0 or missing
  }

  void vertices() {
    // What the file cannot hold is not reserved: a header may promise anything.
    mesh_.vertices.reserve(std::min<std::size_t>(vertex_count_, scan_.left() / min_vertex_bytes + 1));
    const bool plain = !normals_ && !colours_ && !texture_;
    const int extra_min = extras_.value_or(3 * normals_ + 3 * colours_ + 2 * texture_);
    const int extra_max = extras_.value_or(extra_min + colours_);
    if (plain) look_beyond();
    for (; vertices_found_ < vertex_count_; ++vertices_found_) {
      Vec3 p;
      for (int i = 0; i < 3; ++i) {
        const std::string_view word = scan_.word();
        if (word.empty()) ended();
        const auto value = to_number(word);
        if (!value) not_a_number(fmt::format("a coordinate of vertex {}", vertices_found_), word);
        p[i] = *value;
      }
      if (extra_max != 0) skip_extras(extra_min, extra_max);
      mesh_.vertices.push_back(p);
    }
    if (extras_)
      mesh_.notes.push_back(
          fmt::format("The header says {}, but vertex lines hold {} numbers: the {} after the coordinates "
                      "were skipped, as colours or normals.",
                      header_word(), 3 + *extras_, *extras_));
    else if (extra_max != 0 && vertex_count_ != 0)
      mesh_.notes.push_back("Normals, colours and texture positions of the vertices were skipped.");
  }

  void look_beyond() {
    WordScanner ahead = scan_;
    if (!to_number(ahead.word())) return;
    int numbers = 1;
    while (numbers < 64 && to_number(ahead.word_on_line())) ++numbers;
    beyond_ = std::max(0, numbers - 3);
  }

  void skip_extras(int least, int most) {
    int found = 0;
    for (std::string_view word = scan_.word_on_line(); !word.empty(); word = scan_.word_on_line(), ++found)
      if (!to_number(word)) not_a_number("a number of a normal, colour or texture position", word);
    if (found >= least && found <= most) return;
    if (found < least && scan_.left() == 0) ended();
    fail(Fault::file_syntax,
         fmt::format("vertex {} has {} numbers after its coordinates; the header {} asks for {}{}.", vertices_found_,
                     found, header_word(), least, most > least ? fmt::format(" or {}", most) : "") +
             (found == 0 ? " Without colours, normals and texture positions it must say OFF." : ""));
  }

  std::uint32_t corner() {
    const std::string_view word = scan_.word();
    if (word.empty()) ended();
    const auto value = to_integer(word);
    if (!value) not_a_number(fmt::format("a vertex of face {}", faces_found_), word);
    if (*value < 0 || static_cast<std::uint64_t>(*value) >= vertex_count_)
      fail(Fault::mesh_index_range,
           fmt::format("face {} names vertex {}, but there are {} vertices, numbered from 0. Export the mesh again.{}",
                       faces_found_, shown(word), vertex_count_, hint()));
    return static_cast<std::uint32_t>(*value);
  }

  void faces() {
    const std::size_t room = std::min<std::size_t>(face_count_, scan_.left() / min_face_bytes + 1);
    mesh_.faces.reserve(room);
    mesh_.face_lines.reserve(room);
    for (; faces_found_ < face_count_; ++faces_found_) {
      const std::string_view word = scan_.word();
      if (word.empty()) ended();
      const auto corners = to_integer(word);
      if (!corners) not_a_number(fmt::format("the number of corners of face {}", faces_found_), word);
      if (*corners < 1)
        fail(Fault::file_syntax,
             fmt::format("face {} has {} corners; a face needs 3.{}", faces_found_, *corners, hint()));
      // Every corner takes a blank and a digit.
      if (static_cast<std::uint64_t>(*corners) > scan_.left() / 2) ended();
      faces_.begin(scan_.line());
      for (std::int64_t i = 0; i < *corners; ++i) faces_.corner(corner());
      faces_.end();
      scan_.skip_line(); // the face's colour
    }
    faces_.finish();
  }

  void rest() {
    data_follow_ = !scan_.word().empty();
    if (data_follow_)
      mesh_.notes.push_back(
          fmt::format("Data after the last announced face were ignored (from line {}).", scan_.line()));
  }

  WordScanner scan_;
  RawMesh mesh_;
  bool colours_ = false, normals_ = false, texture_ = false;
  MeshFaces faces_;
  std::optional<int> extras_;
  std::string_view header_word_;
  bool data_follow_ = false;
  int beyond_ = 0; // several vertices on one line, or colours without a header that says so
  std::uint64_t vertex_count_ = 0, face_count_ = 0, vertices_found_ = 0, faces_found_ = 0;
};

} // namespace

RawMesh parse_off(std::string_view bytes, const std::string& name) {
  const std::string_view text = without_byte_order_mark(bytes);
  RawMesh mesh;
  std::optional<Error> fault;
  OffParser parser(text, name);
  try {
    mesh = parser.parse();
  } catch (const Error& error) {
    if (parser.numbers_beyond() == 0) throw;
    fault = error;
  }
  // Numbers that do not fit the header: coordinates with more on each line, if that leads to the file's end.
  if (parser.numbers_beyond() != 0 && (fault || parser.data_follow())) {
    try {
      OffParser again(text, name, parser.numbers_beyond());
      RawMesh other = again.parse();
      if (fault || !again.data_follow()) {
        mesh = std::move(other);
        fault.reset();
      }
    } catch (const Error& error) {
      if (fault && fault->fault() != Fault::file_truncated && error.fault() == Fault::file_truncated) fault = error;
    }
  }
  if (fault) throw *fault;
  mesh.sha256 = sha256_hex(bytes);
  return mesh;
}

void write_off(const TriangleSurface& surface, std::span<const std::string> comments, AtomicFile& file) {
  check(surface);
  const auto comment = [&](const std::string& text) { file.write(fmt::format("# {}\n", one_line(text))); };
  file.write("OFF\n");
  comment(fmt::format("cowgpu {}, surface {}", version, surface.name));
  for (const std::string& text : comments) comment(text);
  file.write(fmt::format("{} {} 0\n", surface.vertices.size(), surface.faces.size()));
  for (const Vec3& p : surface.vertices) file.write(fmt::format("{:.17g} {:.17g} {:.17g}\n", p.x(), p.y(), p.z()));
  for (const Face& f : surface.faces) file.write(fmt::format("3 {} {} {}\n", f[0], f[1], f[2]));
}

} // namespace cowgpu

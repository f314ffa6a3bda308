#include "host/io/ply.hpp"

#include "host/error.hpp"
#include "host/io/shown.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <optional>

namespace cowgpu {
namespace {

static_assert(std::endian::native == std::endian::little, "the writer and the reader copy memory");

constexpr std::uint64_t most_written = 0x7fffffff; // indices are ints
constexpr std::uint64_t most_read = 0xffffffff;
constexpr std::size_t face_bytes = 1 + 3 * sizeof(std::uint32_t);

std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return text;
}

template <class T>
void append(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

template <class T>
T load(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return value;
}

std::string header_of(const TriangleSurface& surface, std::span<const std::string> comments) {
  std::string text = fmt::format("ply\nformat binary_little_endian 1.0\ncomment cowgpu {}\ncomment surface {}\n",
                                 version, one_line(surface.name));
  for (const std::string& comment : comments) text += fmt::format("comment {}\n", one_line(comment));
  for (const VertexScalar& scalar : surface.scalars)
    text += fmt::format("comment {}: {}\n", scalar.name, scalar.unit.empty() ? "a pure number" : one_line(scalar.unit));
  text += fmt::format("element vertex {}\nproperty double x\nproperty double y\nproperty double z\n",
                      surface.vertices.size());
  if (!surface.normals.empty()) text += "property float nx\nproperty float ny\nproperty float nz\n";
  for (const VertexScalar& scalar : surface.scalars) text += fmt::format("property double {}\n", scalar.name);
  return text +
         fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", surface.faces.size());
}

/// Bytes of a scalar type; 0 for what is none.
std::size_t type_bytes(std::string_view type) {
  struct Type {
    std::string_view name;
    std::size_t bytes;
  };
  static constexpr Type types[] = {{"char", 1},  {"uchar", 1},  {"int8", 1},    {"uint8", 1},
                                   {"short", 2}, {"ushort", 2}, {"int16", 2},   {"uint16", 2},
                                   {"int", 4},   {"uint", 4},   {"int32", 4},   {"uint32", 4},
                                   {"float", 4}, {"double", 8}, {"float32", 4}, {"float64", 8}};
  for (const Type& known : types)
    if (known.name == type) return known.bytes;
  return 0;
}

bool is_real(std::string_view type) {
  return type == "float" || type == "float32" || type == "double" || type == "float64";
}

class PlyParser {
public:
  PlyParser(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  PlyMesh parse() {
    header();
    sizes();
    PlyMesh mesh;
    vertices(mesh);
    faces(mesh);
    mesh.comments = std::move(comments_);
    return mesh;
  }

private:
  struct Coordinate {
    std::size_t offset = 0, bytes = 0; // bytes 0: not announced
  };

  [[noreturn]] void fail(Fault fault, const std::string& sentence) const {
    throw Error(fault, fmt::format("{}:{}: {}", name_, line_number_, sentence));
  }
  [[noreturn]] void fail_at(Fault fault, std::size_t offset, const std::string& sentence) const {
    throw Error(fault, fmt::format("{}: at byte {}: {}", name_, offset, sentence));
  }

  /// The next line of the header, cut into words.
  std::vector<std::string_view> line() {
    ++line_number_;
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos)
      fail(Fault::file_truncated, "the file ends within its header. It was cut off; write or fetch it again.");
    std::string_view rest = bytes_.substr(at_, end - at_);
    if (rest.ends_with('\r')) rest.remove_suffix(1);
    at_ = end + 1;
    std::vector<std::string_view> words;
    while (!rest.empty()) {
      const std::size_t begin = std::min(rest.find_first_not_of(" \t"), rest.size());
      const std::size_t length = std::min(rest.find_first_of(" \t", begin), rest.size()) - begin;
      if (length) words.push_back(rest.substr(begin, length));
      rest.remove_prefix(begin + length);
    }
    return words;
  }

  void header() {
    if (!bytes_.starts_with("ply\n") && !bytes_.starts_with("ply\r\n"))
      fail(bytes_.empty() ? Fault::file_truncated : Fault::file_format,
           "this is no PLY file: its first line is not 'ply'. A file that `cowgpu map -o FILE.ply` has written is "
           "wanted.");
    line();
    const auto format = line();
    if (format.size() != 3 || format[0] != "format")
      fail(Fault::file_syntax, "the second line of a PLY file begins with 'format'.");
    if (format[1] != "binary_little_endian" || format[2] != "1.0")
      fail(Fault::file_format,
           fmt::format("'{} {}' is not read, only binary_little_endian 1.0.", shown(format[1]), shown(format[2])));
    for (;;) {
      const auto words = line();
      if (words.empty()) fail(Fault::file_syntax, "an empty line in the header.");
      if (words[0] == "end_header") break;
      if (words[0] == "obj_info") continue;
      if (words[0] == "comment") {
        comments_.push_back(fmt::format("{}", fmt::join(words.begin() + 1, words.end(), " ")));
        continue;
      }
      if (words[0] == "element")
        element(words);
      else if (words[0] == "property")
        property(words);
      else
        fail(Fault::file_syntax, fmt::format("'{}' is no word of a PLY header.", shown(words[0])));
    }
    for (const Coordinate& c : coordinates_)
      if (c.bytes == 0) fail(Fault::file_format, "the vertices do not have x, y and z.");
    if (elements_ == 2 && !indices_) fail(Fault::file_format, "the faces do not have vertex_indices.");
  }

  void element(const std::vector<std::string_view>& words) {
    std::uint64_t count = 0;
    if (words.size() == 3) {
      const auto result = std::from_chars(words[2].data(), words[2].data() + words[2].size(), count);
      if (result.ec != std::errc() || result.ptr != words[2].data() + words[2].size() || count > most_read)
        fail(Fault::file_syntax, fmt::format("'{}' {} are announced; from 0 to {} are possible.", shown(words[2]),
                                             shown(words[1]), most_read));
    } else {
      fail(Fault::file_syntax, "an element has a name and a number.");
    }
    const std::string_view expected = elements_ == 0 ? "vertex" : elements_ == 1 ? "face" : "";
    if (words[1] != expected)
      fail(Fault::file_format,
           fmt::format("the element '{}' is not read here: a file of vertices, then faces, is.", shown(words[1])));
    (elements_++ == 0 ? vertex_count_ : face_count_) = count;
  }

  void property(const std::vector<std::string_view>& words) {
    if (elements_ == 0) fail(Fault::file_syntax, "a property before the first element.");
    if (elements_ == 2) {
      const bool triangles = words.size() == 5 && words[1] == "list" && (words[2] == "uchar" || words[2] == "uint8") &&
                             type_bytes(words[3]) == 4 && !is_real(words[3]) &&
                             (words[4] == "vertex_indices" || words[4] == "vertex_index");
      if (!triangles || indices_)
        fail(Fault::file_format, "faces must have one property: list uchar int vertex_indices.");
      indices_ = true;
      return;
    }
    const std::size_t bytes = words.size() == 3 ? type_bytes(words[1]) : 0;
    if (bytes == 0)
      fail(words.size() > 1 && words[1] == "list" ? Fault::file_format : Fault::file_syntax,
           "a property of a vertex is a scalar type and a name.");
    for (std::size_t c = 0; c < 3; ++c)
      if (words[2] == std::string_view("xyz").substr(c, 1)) {
        if (!is_real(words[1])) fail(Fault::file_format, "x, y and z must be of type double or float.");
        if (coordinates_[c].bytes) fail(Fault::file_syntax, fmt::format("{} is announced twice.", words[2]));
        coordinates_[c] = {stride_, bytes};
      }
    stride_ += bytes;
  }

  /// Before anything is allocated. Neither product exceeds 2^32 times the length of the header.
  void sizes() const {
    const std::uint64_t wanted = vertex_count_ * stride_ + face_count_ * face_bytes, found = bytes_.size() - at_;
    if (found < wanted)
      fail_at(
          Fault::file_truncated, bytes_.size(),
          fmt::format("the file ends, but {} vertices and {} faces take {} bytes more. It was cut off or its header "
                      "is wrong; write or fetch it again.",
                      vertex_count_, face_count_, wanted - found));
  }

  void vertices(PlyMesh& mesh) {
    mesh.vertices.reserve(vertex_count_);
    for (std::uint64_t v = 0; v < vertex_count_; ++v, at_ += stride_) {
      Vec3 p;
      for (int c = 0; c < 3; ++c) {
        const Coordinate& from = coordinates_[std::size_t(c)];
        const char* raw = bytes_.data() + at_ + from.offset;
        p[c] = from.bytes == sizeof(double) ? load<double>(raw) : double(load<float>(raw));
      }
      if (!p.allFinite()) fail_at(Fault::mesh_not_finite, at_, fmt::format("vertex {} is not finite.", v));
      mesh.vertices.push_back(p);
    }
  }

  void faces(PlyMesh& mesh) {
    mesh.faces.reserve(face_count_);
    for (std::uint64_t f = 0; f < face_count_; ++f, at_ += face_bytes) {
      const auto corners = static_cast<unsigned char>(bytes_[at_]);
      if (corners != 3)
        fail_at(Fault::file_syntax, at_, fmt::format("face {} has {} corners; only triangles are read.", f, corners));
      Face face;
      for (std::size_t k = 0; k < 3; ++k) {
        face[k] = load<std::uint32_t>(bytes_.data() + at_ + 1 + k * sizeof(std::uint32_t));
        if (face[k] >= vertex_count_)
          fail_at(Fault::mesh_index_range, at_,
                  fmt::format("face {} names vertex {}, but there are {} vertices.", f, face[k], vertex_count_));
      }
      mesh.faces.push_back(face);
    }
    if (at_ != bytes_.size())
      fail_at(Fault::file_syntax, at_, fmt::format("{} bytes follow the last face.", bytes_.size() - at_));
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_ = 0, line_number_ = 0, stride_ = 0;
  std::uint64_t vertex_count_ = 0, face_count_ = 0;
  int elements_ = 0;
  bool indices_ = false;
  Coordinate coordinates_[3];
  std::vector<std::string> comments_;
};

} // namespace

void write_ply(const TriangleSurface& surface, std::span<const std::string> comments, AtomicFile& file) {
  check(surface);
  if (surface.vertices.size() > most_written || surface.faces.size() > most_written)
    throw Error(Fault::too_large,
                fmt::format("{}: PLY files hold up to {} vertices and faces", surface.name, most_written));
  file.write(header_of(surface, comments));
  std::string bytes;
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    bytes.clear();
    for (int c = 0; c < 3; ++c) append(bytes, surface.vertices[v][c]);
    if (!surface.normals.empty())
      for (int c = 0; c < 3; ++c) append(bytes, float(surface.normals[v][c]));
    for (const VertexScalar& scalar : surface.scalars) append(bytes, scalar.values[v]);
    file.write(bytes);
  }
  for (const Face& face : surface.faces) {
    bytes.assign(1, char(3));
    for (const std::uint32_t v : face) append(bytes, v);
    file.write(bytes);
  }
}

PlyMesh read_ply_positions(std::string_view bytes, const std::string& name) {
  return PlyParser(bytes, name).parse();
}

} // namespace cowgpu

#include "host/io/ply_reader.hpp"

#include "host/counted.hpp"
#include "host/io/mesh_faces.hpp"
#include "host/io/ply_header.hpp"
#include "host/io/sha256.hpp"
#include "host/io/shown.hpp"
#include "host/io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <optional>

namespace cowgpu {
namespace {

static_assert(std::endian::native == std::endian::little, "the reader copies memory");

/// The data of an ASCII file: a word is a value.
class AsciiData {
public:
  AsciiData(std::string_view text, std::size_t first_line) : scan_(text, '\0', first_line) {}

  /// Nothing: the data end here, or (ended() is false) the word is no number.
  std::optional<double> number(PlyType) { return to_number(take()); }
  std::optional<std::int64_t> integer(PlyType) { return to_integer(take()); }
  bool ended() const { return word_.empty(); }
  std::string found() const { return shown(word_); }

  std::optional<std::size_t> line() const { return scan_.line(); }
  std::string where() const { return fmt::format(":{}:", scan_.line()); }
  std::size_t left() const { return scan_.left(); }
  bool skip(std::uint64_t) { return false; } // unknown: word by word
  /// The least that `properties` values take.
  static std::size_t least_bytes(const PlyElement& element) { return 2 * element.properties.size(); }
  static std::size_t triangle_bytes(PlyType) { return 6; }
  static std::size_t value_bytes(PlyType) { return 2; }
  std::string rest() {
    return take().empty() ? "" : fmt::format("Data after the last element were ignored (from line {}).", scan_.line());
  }

private:
  std::string_view take() { return word_ = scan_.word(); }

  WordScanner scan_;
  std::string_view word_;
};

/// The data of a binary file.
class BinaryData {
public:
  BinaryData(std::string_view bytes, std::size_t at, bool swap) : bytes_(bytes), at_(at), swap_(swap) {}

  std::optional<double> number(PlyType type) {
    switch (type) {
    case PlyType::float32: return converted<double, float>();
    case PlyType::float64: return converted<double, double>();
    case PlyType::uint64: return converted<double, std::uint64_t>();
    default: break;
    }
    const auto value = integer(type);
    return value ? std::optional(static_cast<double>(*value)) : std::nullopt;
  }

  std::optional<std::int64_t> integer(PlyType type) {
    switch (type) {
    case PlyType::int8: return converted<std::int64_t, std::int8_t>();
    case PlyType::uint8: return converted<std::int64_t, std::uint8_t>();
    case PlyType::int16: return converted<std::int64_t, std::int16_t>();
    case PlyType::uint16: return converted<std::int64_t, std::uint16_t>();
    case PlyType::int32: return converted<std::int64_t, std::int32_t>();
    case PlyType::int64: return converted<std::int64_t, std::int64_t>();
    case PlyType::uint64: {
      const auto value = converted<std::uint64_t, std::uint64_t>();
      constexpr std::uint64_t most = std::numeric_limits<std::int64_t>::max();
      return value ? std::optional(static_cast<std::int64_t>(std::min(*value, most))) : std::nullopt;
    }
    default: return converted<std::int64_t, std::uint32_t>();
    }
  }

  static bool ended() { return true; } // the only way in which a number can be missing
  static std::string found() { return ""; }
  static std::optional<std::size_t> line() { return {}; }
  std::string where() const { return fmt::format(": at byte {}:", at_); }
  std::size_t left() const { return bytes_.size() - at_; }
  bool skip(std::uint64_t count) {
    if (count > left()) return false;
    at_ += count;
    return true;
  }
  static std::size_t least_bytes(const PlyElement& element) { return element.least_bytes(); }
  static std::size_t triangle_bytes(PlyType index) { return 3 * bytes_of(index); }
  static std::size_t value_bytes(PlyType type) { return bytes_of(type); }
  std::string rest() const {
    if (left() == 0) return "";
    return fmt::format("{} after the last element {} ignored (from byte {}).", counted(left(), "byte", "bytes"),
                       left() == 1 ? "was" : "were", at_);
  }

private:
  template <class To, class From>
  std::optional<To> converted() {
    if (left() < sizeof(From)) return {};
    std::array<char, sizeof(From)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(From));
    if (swap_) std::reverse(raw.begin(), raw.end());
    at_ += sizeof(From);
    return static_cast<To>(std::bit_cast<From>(raw));
  }

  std::string_view bytes_;
  std::size_t at_;
  bool swap_;
};

bool is_index_list(const PlyProperty& property) {
  return !property.again && (property.name == "vertex_indices" || property.name == "vertex_index");
}

auto index_list(const PlyElement& element) {
  return std::find_if(element.properties.begin(), element.properties.end(), is_index_list);
}

template <class Data>
class BodyReader {
public:
  BodyReader(const PlyHeader& header, Data data, const std::string& name)
      : header_(header), data_(std::move(data)), faces_(mesh_) {
    mesh_.name = name;
    for (const PlyElement& e : header.elements) {
      if (e.name == "vertex") vertex_count_ = e.count;
      if (e.name == "face") face_count_ = e.count;
    }
  }

  RawMesh read() {
    std::vector<std::string> skipped;
    for (const PlyElement& element : header_.elements)
      if (element.name == "vertex") {
        vertices(element);
      } else if (element.name == "face") {
        faces(element);
      } else if (element.name == "tristrips") {
        strips(element);
      } else {
        skip(element);
        if (element.count != 0 && skipped.size() < 8) skipped.push_back(shown(element.name));
      }
    faces_.finish();
    if (strips_ != 0)
      mesh_.notes.push_back(fmt::format("{} triangle {} cut into {} triangles.", strips_,
                                        strips_ == 1 ? "strip was" : "strips were", strip_triangles_));
    for (const PlyElement& element : header_.elements)
      for (const PlyProperty& property : element.properties)
        if (property.again && twice_.size() < 8)
          twice_.push_back(fmt::format("{} of {}", shown(property.name), shown(element.name)));
    if (!twice_.empty())
      mesh_.notes.push_back(
          fmt::format("Announced more than once, and read where announced first: {}.", fmt::join(twice_, ", ")));
    if (!skipped.empty()) mesh_.notes.push_back(fmt::format("Elements were skipped: {}.", fmt::join(skipped, ", ")));
    if (const std::string rest = data_.rest(); !rest.empty()) mesh_.notes.push_back(rest);
    return std::move(mesh_);
  }

private:
  [[noreturn]] void fail(Fault fault, const std::string& sentence) const {
    throw Error(fault, fmt::format("{}{} {}", mesh_.name, data_.where(), sentence));
  }

  [[noreturn]] void ended() const {
    fail(Fault::file_truncated,
         fmt::format("the file ends after {} of {} vertices and {} of {} faces. It was cut off, or "
                     "the counts of its header are wrong; fetch or export it again.",
                     mesh_.vertices.size(), vertex_count_, faces_found_, face_count_));
  }

  template <class Value>
  Value given(std::optional<Value> value) const {
    if (value) return *value;
    if (data_.ended()) ended();
    fail(Fault::file_syntax, fmt::format("a number expected after {} vertices and {} faces, found '{}'.",
                                         mesh_.vertices.size(), faces_found_, data_.found()));
  }

  std::uint64_t length(const PlyProperty& list) {
    const std::int64_t length = given(data_.integer(list.count_type));
    if (length < 0) fail(Fault::file_syntax, fmt::format("a list of {} values.", length));
    return static_cast<std::uint64_t>(length);
  }

  void skip(const PlyProperty& property) {
    const std::uint64_t count = property.is_list ? length(property) : 1; // below 2^63 values of at most 8 bytes
    if (count <= data_.left() && data_.skip(count * bytes_of(property.type))) return;
    for (std::uint64_t i = 0; i < count; ++i) given(data_.number(property.type));
  }

  void skip(const PlyElement& element) {
    if (element.properties.empty()) return;
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const PlyProperty& property : element.properties) skip(property);
  }

  void vertices(const PlyElement& element) {
    std::string others;
    std::vector<int> coordinate; // coordinate that each property gives; -1: skipped
    for (const PlyProperty& p : element.properties) {
      const std::size_t c = p.name.size() == 1 ? std::string_view("xyz").find(p.name) : std::string_view::npos;
      coordinate.push_back(c == std::string_view::npos || p.is_list || p.again ? -1 : static_cast<int>(c));
      if (coordinate.back() < 0 && !p.again && others.size() < 100)
        others += (others.empty() ? "" : ", ") + shown(p.name);
    }
    // What the file cannot hold is not reserved: a header may promise anything.
    mesh_.vertices.reserve(std::min<std::uint64_t>(element.count, data_.left() / Data::least_bytes(element) + 1));
    for (std::uint64_t v = 0; v < element.count; ++v) {
      Vec3 point;
      for (std::size_t i = 0; i < coordinate.size(); ++i)
        if (coordinate[i] < 0)
          skip(element.properties[i]);
        else
          point[coordinate[i]] = given(data_.number(element.properties[i].type));
      mesh_.vertices.push_back(point);
    }
    if (!others.empty()) mesh_.notes.push_back(fmt::format("Properties of the vertices were skipped: {}.", others));
  }

  /// Nothing for -1, which ends a strip.
  std::optional<std::uint32_t> corner_or_end(PlyType type) {
    const std::int64_t vertex = given(data_.integer(type));
    return vertex == -1 ? std::nullopt : std::optional(valid(vertex));
  }

  std::uint32_t corner(PlyType type) { return valid(given(data_.integer(type))); }

  std::uint32_t valid(std::int64_t vertex) const {
    if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= vertex_count_)
      fail(Fault::mesh_index_range,
           fmt::format("{} names vertex {}, but there are {} vertices, numbered from 0. Export the mesh again.",
                       in_strips_ ? "a triangle strip" : fmt::format("face {}", faces_found_), vertex, vertex_count_));
    return static_cast<std::uint32_t>(vertex);
  }

  void faces(const PlyElement& element) {
    const auto list = index_list(element);
    if (list == element.properties.end()) return; // without a face, see require()
    const std::size_t least = Data::least_bytes(element) + Data::triangle_bytes(list->type);
    const std::size_t room = std::min<std::uint64_t>(element.count, data_.left() / least + 1);
    mesh_.faces.reserve(room);
    if (data_.line()) mesh_.face_lines.reserve(room);
    for (; faces_found_ < element.count; ++faces_found_)
      for (auto property = element.properties.begin(); property != element.properties.end(); ++property) {
        if (property != list) {
          skip(*property);
          continue;
        }
        const std::uint64_t corners = length(*property);
        if (corners < 1)
          fail(Fault::file_syntax, fmt::format("face {} has {} corners; a face needs 3.", faces_found_, corners));
        faces_.begin(data_.line());
        for (std::uint64_t i = 0; i < corners; ++i) faces_.corner(corner(property->type));
        faces_.end();
      }
  }

  /// Lists of strips with -1 between them: every three corners that follow each other are a triangle, every second one turned.
  /// Those that name a vertex twice join strips and are none.
  void strips(const PlyElement& element) {
    const auto list = index_list(element);
    if (list == element.properties.end()) return;
    in_strips_ = true;
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (auto property = element.properties.begin(); property != element.properties.end(); ++property) {
        if (property != list) {
          skip(*property);
          continue;
        }
        const std::uint64_t count = length(*property);
        faces_.begin(data_.line());
        faces_.reserve(std::min<std::uint64_t>(count, data_.left() / Data::value_bytes(property->type)));
        strip(count, property->type);
      }
    in_strips_ = false;
  }

  void strip(std::uint64_t count, PlyType type) {
    std::uint32_t a = 0, b = 0;
    std::uint64_t in_strip = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::optional<std::uint32_t> next = corner_or_end(type);
      if (!next) {
        in_strip = 0;
        continue;
      }
      const std::uint32_t c = *next;
      strips_ += ++in_strip == 3;
      if (in_strip > 2 && a != b && b != c && c != a) {
        faces_.begin(data_.line());
        for (const std::uint32_t v : in_strip % 2 == 1 ? Face{a, b, c} : Face{b, a, c}) faces_.corner(v);
        ++strip_triangles_;
      }
      a = b, b = c;
    }
  }

  const PlyHeader& header_;
  Data data_;
  RawMesh mesh_;
  MeshFaces faces_;
  bool in_strips_ = false;
  std::uint64_t strips_ = 0, strip_triangles_ = 0;
  std::vector<std::string> twice_;
  std::uint64_t vertex_count_ = 0, face_count_ = 0, faces_found_ = 0;
};

/// Throws where the header announces something that no mesh can be made of.
void require(const PlyHeader& header, const std::string& name) {
  const auto refuse = [&](std::size_t line, const std::string& sentence) {
    throw Error(Fault::file_format, fmt::format("{}:{}: {}", name, line, sentence));
  };
  bool vertices = false;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      vertices = true;
      for (const char* c : {"x", "y", "z"})
        if (const PlyProperty* p = element.find(c); !p || p->is_list)
          refuse(element.line, "the vertices do not have x, y and z.");
    } else if ((element.name == "face" || element.name == "tristrips") && element.count != 0) {
      const auto list = index_list(element);
      if (list == element.properties.end() || !list->is_list || is_real(list->type))
        refuse(element.line, fmt::format("the {} do not have a list of whole numbers vertex_indices (or vertex_index).",
                                         element.name == "face" ? "faces" : "triangle strips"));
    }
  }
  if (!vertices) refuse(header.lines, "there are no vertices.");
}

} // namespace

RawMesh parse_ply(std::string_view bytes, const std::string& name) {
  const PlyHeader header = read_ply_header(bytes, name);
  require(header, name);
  RawMesh mesh;
  if (header.encoding == PlyEncoding::ascii)
    mesh = BodyReader(header, AsciiData(bytes.substr(header.size), header.lines + 1), name).read();
  else
    mesh = BodyReader(header, BinaryData(bytes, header.size, header.encoding == PlyEncoding::big_endian), name).read();
  mesh.sha256 = sha256_hex(bytes);
  return mesh;
}

} // namespace cowgpu

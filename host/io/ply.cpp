#include "host/io/ply.hpp"

#include "host/counted.hpp"
#include "host/error.hpp"
#include "host/io/ply_header.hpp"
#include "host/io/shown.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>

namespace cowgpu {
namespace {

static_assert(std::endian::native == std::endian::little, "the writer and the reader copy memory");

constexpr std::uint64_t most_written = 0x7fffffff; // indices are ints
constexpr std::size_t face_bytes = 1 + 3 * sizeof(std::uint32_t);

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

class PlyParser {
public:
  PlyParser(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  PlyMesh parse() {
    header();
    sizes();
    PlyMesh mesh;
    vertices(mesh);
    faces(mesh);
    mesh.comments = std::move(header_.comments);
    return mesh;
  }

private:
  struct Coordinate {
    std::size_t offset = 0, bytes = 0; // bytes 0: not announced
  };

  [[noreturn]] void fail(Fault fault, std::size_t line, const std::string& sentence) const {
    throw Error(fault, fmt::format("{}:{}: {}", name_, line, sentence));
  }
  [[noreturn]] void fail_at(Fault fault, std::size_t offset, const std::string& sentence) const {
    throw Error(fault, fmt::format("{}: at byte {}: {}", name_, offset, sentence));
  }

  void header() {
    header_ = read_ply_header(bytes_, name_);
    at_ = header_.size;
    if (header_.encoding != PlyEncoding::little_endian)
      fail(Fault::file_format, 2,
           fmt::format("'{}' is not read here, only binary_little_endian, as `cowgpu map -o FILE.ply` writes it.",
                       header_.encoding == PlyEncoding::ascii ? "ascii" : "binary_big_endian"));
    for (std::size_t e = 0; e < header_.elements.size(); ++e)
      if (const PlyElement& element = header_.elements[e]; e > 1 || element.name != (e == 0 ? "vertex" : "face"))
        fail(
            Fault::file_format, element.line,
            fmt::format("the element '{}' is not read here: a file of vertices, then faces, is.", shown(element.name)));
    if (header_.elements.empty()) fail(Fault::file_format, header_.lines, "there are no vertices.");
    vertex_element(header_.elements[0]);
    if (header_.elements.size() == 2) face_element(header_.elements[1]);
  }

  void vertex_element(const PlyElement& element) {
    vertex_count_ = element.count;
    for (const PlyProperty& property : element.properties) {
      if (property.is_list)
        fail(Fault::file_format, property.line, "a property of a vertex is a scalar type and a name.");
      for (std::size_t c = 0; c < 3; ++c)
        if (!property.again && property.name == std::string_view("xyz").substr(c, 1)) {
          if (!is_real(property.type))
            fail(Fault::file_format, property.line, "x, y and z must be of type double or float.");
          coordinates_[c] = {stride_, bytes_of(property.type)};
        }
      stride_ += bytes_of(property.type);
    }
    for (const Coordinate& c : coordinates_)
      if (c.bytes == 0) fail(Fault::file_format, element.line, "the vertices do not have x, y and z.");
  }

  void face_element(const PlyElement& element) {
    face_count_ = element.count;
    const bool triangles =
        element.properties.size() == 1 && element.properties[0].is_list &&
        element.properties[0].count_type == PlyType::uint8 &&
        (element.properties[0].type == PlyType::int32 || element.properties[0].type == PlyType::uint32) &&
        (element.properties[0].name == "vertex_indices" || element.properties[0].name == "vertex_index");
    if (!triangles)
      fail(Fault::file_format, element.properties.empty() ? element.line : element.properties.back().line,
           "faces must have one property: list uchar int vertex_indices.");
  }

  /// Before anything is allocated. Neither product exceeds 2^32 times the length of the header.
  void sizes() const {
    const std::uint64_t wanted = vertex_count_ * stride_ + face_count_ * face_bytes, found = bytes_.size() - at_;
    if (found < wanted)
      fail_at(Fault::file_truncated, bytes_.size(),
              fmt::format("the file ends, but {} and {} take {} more. It was cut off or its header is wrong; write or "
                          "fetch it again.",
                          counted(vertex_count_, "vertex", "vertices"), counted(face_count_, "face", "faces"),
                          counted(wanted - found, "byte", "bytes")));
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
      fail_at(Fault::file_syntax, at_,
              fmt::format("{} the last face.", counted(bytes_.size() - at_, "byte follows", "bytes follow")));
  }

  std::string_view bytes_;
  const std::string& name_;
  PlyHeader header_;
  std::size_t at_ = 0, stride_ = 0;
  std::uint64_t vertex_count_ = 0, face_count_ = 0;
  Coordinate coordinates_[3];
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

#include "tests/support/mesh_files.hpp"

#include "host/io/file.hpp"
#include "host/io/glb.hpp"
#include "tests/support/run_program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>

namespace cowgpu::test {
namespace {

template <class T>
void append(std::string& bytes, T value, bool swapped = false) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof(T));
  if (swapped) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

template <class T>
std::string packed(const std::vector<T>& numbers) {
  std::string bytes;
  for (const T number : numbers) append(bytes, number);
  return bytes;
}

template <class Output>
void add_point(Output out, const Vec3& p) {
  fmt::format_to(out, "{:.17g} {:.17g} {:.17g}\n", p[0], p[1], p[2]);
}

std::string ply_header(const RawMesh& mesh, const char* format, const char* type) {
  return fmt::format("ply\nformat {0} 1.0\nelement vertex {1}\nproperty {2} x\nproperty {2} y\nproperty {2} z\n"
                     "element face {3}\nproperty list uchar int vertex_indices\nend_header\n",
                     format, mesh.vertices.size(), type, mesh.faces.size());
}

std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned held = 0;
    for (std::size_t k = 0; k < 3; ++k)
      held = held << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[held >> (18 - 6 * k) & 63];
  }
  return text;
}

} // namespace

std::string off_text(const RawMesh& mesh) {
  std::string text = fmt::format("OFF\n{} {} 0\n", mesh.vertices.size(), mesh.faces.size());
  for (const Vec3& p : mesh.vertices) add_point(std::back_inserter(text), p);
  for (const Face& f : mesh.faces) fmt::format_to(std::back_inserter(text), "3 {} {} {}\n", f[0], f[1], f[2]);
  return text;
}

std::string obj_text(const RawMesh& mesh) {
  std::string text;
  for (const Vec3& p : mesh.vertices) {
    text += "v ";
    add_point(std::back_inserter(text), p);
  }
  for (const Face& f : mesh.faces)
    fmt::format_to(std::back_inserter(text), "f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
  return text;
}

std::string ply_text(const RawMesh& mesh) {
  std::string text = ply_header(mesh, "ascii", "double");
  for (const Vec3& p : mesh.vertices) add_point(std::back_inserter(text), p);
  for (const Face& f : mesh.faces) fmt::format_to(std::back_inserter(text), "3 {} {} {}\n", f[0], f[1], f[2]);
  return text;
}

std::string stl_text(const RawMesh& mesh) {
  std::string text = "solid box\n";
  for (const Face& f : mesh.faces) {
    text += "facet normal 0 0 0\n  outer loop\n";
    for (const std::uint32_t v : f) {
      text += "    vertex ";
      add_point(std::back_inserter(text), mesh.vertices[v]);
    }
    text += "  endloop\nendfacet\n";
  }
  return text + "endsolid box\n";
}

std::string ply_bytes(const RawMesh& mesh, bool doubles, bool big_endian) {
  std::string bytes =
      ply_header(mesh, big_endian ? "binary_big_endian" : "binary_little_endian", doubles ? "double" : "float");
  for (const Vec3& p : mesh.vertices)
    for (int c = 0; c < 3; ++c)
      if (doubles)
        append(bytes, p[c], big_endian);
      else
        append(bytes, float(p[c]), big_endian);
  for (const Face& f : mesh.faces) {
    bytes += char(3);
    for (const std::uint32_t v : f) append(bytes, v, big_endian);
  }
  return bytes;
}

std::string stl_bytes(const RawMesh& mesh, const std::string& header) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  append(bytes, static_cast<std::uint32_t>(mesh.faces.size()));
  for (const Face& f : mesh.faces) {
    bytes.append(12, '\0');
    for (const std::uint32_t v : f)
      for (int c = 0; c < 3; ++c) append(bytes, float(mesh.vertices[v][c]));
    bytes.append(2, '\0');
  }
  return bytes;
}

std::string glb_bytes(const RawMesh& mesh) {
  const TemporaryFolder folder;
  TriangleSurface surface;
  surface.name = "body";
  surface.vertices = mesh.vertices;
  surface.faces = mesh.faces;
  AtomicFile file(folder / "x.glb");
  const std::array part = {GlbPart{&surface}};
  write_glb(part, {}, file);
  file.commit();
  return read_file(folder / "x.glb");
}

std::string glb_of(std::string json, std::string chunk) {
  json.append((4 - json.size() % 4) % 4, ' ');
  chunk.append((4 - chunk.size() % 4) % 4, '\0');
  std::string bytes = "glTF";
  append(bytes, std::uint32_t(2));
  append(bytes, static_cast<std::uint32_t>(28 + json.size() + chunk.size()));
  append(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  append(bytes, static_cast<std::uint32_t>(chunk.size()));
  return bytes + std::string("BIN\0", 4) + chunk;
}

std::string gltf_of(const std::string& members, const std::string& data) {
  return fmt::format(R"({{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{},)"
                     R"("uri":"data:application/octet-stream;base64,{}"}}],{}}})",
                     data.size(), base64(data), members);
}

std::string bytes_of(const std::vector<float>& numbers) {
  return packed(numbers);
}

std::string bytes_of(const std::vector<std::uint16_t>& numbers) {
  return packed(numbers);
}

RawMesh rounded_to_floats(RawMesh mesh) {
  for (Vec3& p : mesh.vertices)
    for (int c = 0; c < 3; ++c) {
      const volatile float narrow = float(p[c]); // GCC 12 drops the rounding of the last elements where it vectorises
      p[c] = double(narrow);
    }
  return mesh;
}

} // namespace cowgpu::test

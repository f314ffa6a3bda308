#include "host/io/ply.hpp"

#include "host/error.hpp"
#include "host/io/file.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <random>

using namespace cowgpu;
using Catch::Contains;

namespace {

std::string written(const TriangleSurface& surface, const std::vector<std::string>& comments = {}) {
  const test::TemporaryFolder folder;
  AtomicFile file(folder / "x.ply");
  write_ply(surface, comments, file);
  file.commit();
  return read_file(folder / "x.ply");
}

TriangleSurface surface_of(const RawMesh& mesh) {
  TriangleSurface surface;
  surface.name = "body";
  surface.vertices = mesh.vertices;
  surface.faces = mesh.faces;
  return surface;
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int c = 0; c < 3; ++c)
      if (std::bit_cast<std::uint64_t>(a[i][c]) != std::bit_cast<std::uint64_t>(b[i][c])) return false;
  return true;
}

/// "file-truncated: ...", or "none".
std::string fault_of(const std::string& bytes) {
  try {
    read_ply_positions(bytes, "x.ply");
  } catch (const Error& error) {
    return std::string(name(error.fault())) + ": " + error.what();
  }
  return "none";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

template <class T>
std::string with(std::string bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
  return bytes;
}

} // namespace

TEST_CASE("positions and faces read back from PLY bit for bit and in order", "[ply]") {
  TriangleSurface surface = surface_of(test::shuffled(test::icosphere(2), 5));
  std::mt19937_64 random(1);
  for (Vec3& v : surface.vertices)
    for (int c = 0; c < 3; ++c) {
      double x = 0;
      do x = std::bit_cast<double>(random());
      while (!std::isfinite(x));
      v[c] = x;
    }
  surface.vertices[0] = {-0.0, 5e-324, -1.7976931348623157e308};
  const PlyMesh plain = read_ply_positions(written(surface), "x.ply");
  CHECK(same_bits(plain.vertices, surface.vertices));
  CHECK(plain.faces == surface.faces);

  surface.normals.assign(surface.vertices.size(), Vec3(0, 1, 0));
  surface.scalars.push_back({"area_distortion", "", std::vector<double>(surface.vertices.size(), 0.25)});
  const std::string dressed = written(surface, {"method stretch\nelement vertex 7"});
  CHECK_THAT(dressed, Contains("comment method stretch element vertex 7\n") && Contains("property float nx\n") &&
                          Contains("property double area_distortion\n"));
  const PlyMesh read = read_ply_positions(dressed, "x.ply");
  CHECK(same_bits(read.vertices, surface.vertices));
  CHECK(read.faces == surface.faces);
}

TEST_CASE("a PLY file without faces, with floats, or with carriage returns is read", "[ply]") {
  TriangleSurface points = surface_of(test::box({1, 2, 3}));
  points.faces.clear();
  std::string bytes = written(points);
  CHECK(same_bits(read_ply_positions(bytes, "x").vertices, points.vertices));
  bytes = replaced(bytes, "element face 0\nproperty list uchar int vertex_indices\n", "");
  CHECK(same_bits(read_ply_positions(bytes, "x").vertices, points.vertices));
  std::string floats =
      "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 1\r\nproperty float z\r\nproperty uchar "
      "red\r\nproperty float x\r\nproperty double y\r\nend_header\r\n";
  const std::size_t header = floats.size();
  floats = with(with(with(floats + std::string(17, '\0'), header, 0.5F), header + 5, -2.0F), header + 9, 0.1);
  CHECK(same_bits(read_ply_positions(floats, "x").vertices, {{-2, 0.1, 0.5}}));
}

TEST_CASE("every prefix of a PLY file is refused by name, and nothing crashes on changed bytes", "[ply]") {
  const std::string whole = written(surface_of(test::box({1, 1, 1})));
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const std::string fault = fault_of(whole.substr(0, length));
    INFO(length << " of " << whole.size() << ": " << fault);
    const bool named =
        fault.starts_with("file-truncated: x.ply:") || (length < 4 && fault.starts_with("file-format: "));
    CHECK(named);
  }
  std::mt19937 random(7);
  std::size_t refused = 0;
  for (std::size_t at = 0; at < whole.size(); ++at)
    for (int i = 0; i < 8; ++i) {
      std::string changed = whole;
      changed[at] = char(random());
      if (fault_of(changed) != "none") ++refused;
    }
  CHECK(refused > whole.size()); // much of the header and of the indices matters
}

TEST_CASE("damaged PLY files are refused with the line or the byte", "[ply]") {
  const std::string whole = written(surface_of(test::box({1, 1, 1})));
  const std::size_t body = whole.find("end_header\n") + 11, faces = body + 8 * 24;
  struct Case {
    std::string bytes, fault, says;
  };
  const std::vector<Case> cases = {
      {"", "file-truncated", ":1:"},
      {"OFF\n", "file-format", "not a PLY file"},
      {replaced(whole, "binary_little_endian", "binary_big_endian"), "file-format", "x.ply:2: 'binary_big_endian"},
      {replaced(whole, "binary_little_endian", "ascii"), "file-format", "x.ply:2:"},
      {replaced(whole, "format binary", "farmat binary"), "file-syntax", "x.ply:2:"},
      {replaced(whole, "vertex 8", "vertex -8"), "file-syntax", "'-8' vertex"},
      {replaced(whole, "vertex 8", "vertex 8.5"), "file-syntax", "x.ply:5:"},
      {replaced(whole, "vertex 8", "vertex 4294967296"), "file-syntax", "4294967295 are possible"},
      {replaced(whole, "vertex 8", "vertex 4294967295"), "file-truncated", "bytes more"},
      {replaced(whole, "face 12", "face 4294967295"), "file-truncated", "bytes more"},
      {replaced(whole, "vertex 8", "vertex 9"), "file-truncated", "24 bytes more"},
      {replaced(whole, "vertex 8", "vertex 7"), "file-syntax", "corners"},
      {replaced(whole, "face 12", "face 11"), "file-syntax", "13 bytes follow"},
      {whole + "x", "file-syntax", "1 byte follows"},
      {replaced(whole, "property double z\n", ""), "file-format", "x, y and z"},
      {replaced(whole, "double z", "double y"), "file-format", "x, y and z"},
      {replaced(whole, "double z", "int z"), "file-format", "double or float"},
      {replaced(whole, "double z", "quad z"), "file-syntax", "x.ply:8:"},
      {replaced(whole, "double z", "list uchar double z"), "file-format", "x.ply:8:"},
      {replaced(whole, "list uchar int", "list uint int"), "file-format", "x.ply:10:"},
      {replaced(whole, "property list uchar int vertex_indices\n", ""), "file-format", "vertex_indices"},
      {replaced(whole, "element face 12", "element edge 12"), "file-format", "'edge'"},
      {replaced(whole, "element vertex", "property vertex"), "file-syntax", "x.ply:5:"},
      {replaced(whole, "end_header", "and_header"), "file-syntax", "'and_header'"},
      {with(whole, body + 24 + 8, std::nan("")), "mesh-not-finite", fmt::format("at byte {}: vertex 1", body + 24)},
      {with(whole, body, HUGE_VAL), "mesh-not-finite", "vertex 0"},
      {with(whole, faces + 13, char(4)), "file-syntax", fmt::format("at byte {}: face 1 has 4", faces + 13)},
      {with(whole, faces + 1, std::uint32_t(8)), "mesh-index-range", "face 0 names vertex 8"},
      {with(whole, faces + 9, std::int32_t(-1)), "mesh-index-range", "4294967295"},
  };
  for (const Case& c : cases) {
    const std::string fault = fault_of(c.bytes);
    INFO(c.fault << ", " << c.says << ": " << fault);
    CHECK((fault.starts_with(c.fault + ": ") && fault.find(c.says) != std::string::npos));
  }
}

TEST_CASE("what is no surface is not written", "[ply]") {
  const TriangleSurface good = surface_of(test::box({1, 1, 1}));
  const auto refused = [&](TriangleSurface surface) {
    try {
      written(surface);
    } catch (const Error& error) {
      return std::string(name(error.fault()));
    }
    return std::string("none");
  };
  CHECK(refused(good) == "none");
  TriangleSurface bad = good;
  bad.faces[3][1] = 8;
  CHECK(refused(bad) == "mesh-index-range");
  bad = good;
  bad.vertices[2].y() = std::nan("");
  CHECK(refused(bad) == "mesh-not-finite");
  bad = good;
  bad.normals.assign(7, Vec3(1, 0, 0));
  CHECK(refused(bad) == "bad-argument");
  bad.normals.assign(8, Vec3(1, 1, 0));
  CHECK(refused(bad) == "bad-argument");
  bad = good;
  bad.scalars = {{"x", "", std::vector<double>(8)}};
  CHECK(refused(bad) == "bad-argument");
  bad.scalars = {{"two words", "", std::vector<double>(8)}};
  CHECK(refused(bad) == "bad-argument");
  bad.scalars = {{"q", "", std::vector<double>(8)}, {"q", "", std::vector<double>(8)}};
  CHECK(refused(bad) == "bad-argument");
  bad.scalars = {{"q", "", std::vector<double>(9)}};
  CHECK(refused(bad) == "bad-argument");
  bad.scalars = {{"q", "", std::vector<double>(8, HUGE_VAL)}};
  CHECK(refused(bad) == "mesh-not-finite");
}

TEST_CASE("vertex normals do not depend on how flat parts are cut, and are radial on a sphere", "[normals]") {
  const RawMesh box = test::box({1, 2, 3}, {-0.5, -1, -1.5});
  const auto normals = vertex_normals(box.vertices, box.faces);
  for (std::size_t v = 0; v < 8; ++v) // three right angles, cut or not
    CHECK((normals[v] - box.vertices[v].cwiseSign() / std::sqrt(3.0)).norm() < 1e-15);
  const RawMesh sphere = test::icosphere(3);
  const auto radial = vertex_normals(sphere.vertices, sphere.faces);
  double worst = 0;
  for (std::size_t v = 0; v < radial.size(); ++v) worst = std::max(worst, (radial[v] - sphere.vertices[v]).norm());
  INFO(worst);
  CHECK(worst < 2e-2);
  const std::vector<Vec3> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 5, 5}};
  const std::vector<Face> flat = {{0, 1, 2}};
  for (const Vec3& n : vertex_normals(line, flat)) CHECK(n == Vec3(0, 0, 1));
}

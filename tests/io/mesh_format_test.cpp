#include "host/io/mesh_format.hpp"

#include "host/io/obj.hpp"
#include "host/io/off.hpp"
#include "host/io/stl.hpp"
#include "host/mesh/audit.hpp"
#include "host/mesh/closed_surface.hpp"
#include "host/mesh/geometry.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/mesh_files.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reader_checks.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <fstream>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

std::string format_of(const std::string& bytes, const std::string& name = "x") {
  return std::string(mesh_format_of(bytes, name).name);
}

} // namespace

TEST_CASE("formats are told by what files hold, whatever they are called", "[formats][readers]") {
  const RawMesh body = box({1, 2, 3});
  for (const char* called : {"x", "x.off", "x.obj", "x.ply", "x.stl", "x.glb", "x.gltf", "x.json", "-"}) {
    INFO(called);
    CHECK(format_of(off_text(body), called) == "OFF");
    CHECK(format_of("# a comment\n\n" + off_text(body), called) == "OFF");
    CHECK(format_of("COFF 0 0 0\n", called) == "OFF");
    CHECK(format_of(obj_text(body), called) == "OBJ");
    CHECK(format_of("# OFF\nmtllib x.mtl\n", called) == "OBJ");
    CHECK(format_of("\xef\xbb\xbf"
                    "o solid\n",
                    called) == "OBJ");
    CHECK(format_of(ply_text(body), called) == "PLY");
    CHECK(format_of(ply_bytes(body, true, true), called) == "PLY");
    CHECK(format_of(stl_text(body), called) == "STL");
    CHECK(format_of(stl_bytes(body), called) == "STL");
    CHECK(format_of(stl_bytes(body, "solid"), called) == "STL");
    CHECK(format_of(stl_bytes(body, "OFF"), called) == "STL");
    CHECK(format_of(glb_bytes(body), called) == "glTF");
    CHECK(format_of(" \n{\"asset\": 1}", called) == "glTF");
  }
  CHECK(format_of("8 12\n0 0 0\n", "x.off") == "PDS plates");
  CHECK(format_of(" 8 12 \r\n 1 0. 0. 0.\r\n", "x.tab") == "PDS plates");
  CHECK(format_of("8\n1 0 0 0\n", "x") == "PDS plates");
  for (const char* other :
       {"8\n0.5 0 0\n", "8 12\n0 0\n", "8 12\nx y z\n", "0.5 1\n0 0 0\n", "-1 2\n0 0 0\n", "8 12\n"})
    CHECK(outcome_of([&] { mesh_format_of(other, "x.tab"); }).fault == "file-format");
  CHECK(format_of("4 4 0\n", "x.off") == "OFF"); // by the name, where the content is silent
  CHECK(format_of("4 4 0\n", "X.OBJ") == "OBJ");
  CHECK(outcome_of([] { mesh_format_of("4 4 0\n", "x.txt"); }).fault == "file-format");
  CHECK(outcome_of([] { mesh_format_of("", "x"); }).fault == "file-truncated");
  CHECK(outcome_of([] { mesh_format_of("\x1f\x8b\x08", "x.obj"); }).says("Unpack it"));
  CHECK(outcome_of([] { mesh_format_of("ISO-10303-21;\nHEADER;", "x.obj"); }).says("STEP"));
  CHECK(outcome_of([] { mesh_format_of("# vtk DataFile Version 3.0\nv\nASCII\n", "x"); }).says("VTK"));
}

TEST_CASE("a name that says another format is noted", "[formats][readers]") {
  const RawMesh mesh = parse_mesh(ply_text(box({1, 2, 3})), "x.obj");
  CHECK(mesh.notes == std::vector<std::string>{"The file's name says OBJ, but it holds PLY."});
  CHECK(parse_mesh(ply_text(box({1, 2, 3})), "x.PLY").notes.empty());
  CHECK(parse_mesh(ply_text(box({1, 2, 3})), "x").notes.empty());
}

TEST_CASE("moments of one body through every format agree", "[formats][readers][moments]") {
  const RawMesh body =
      rotated(shuffled(icosphere(2, 0.7), 6), Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()).matrix());
  Paths paths;
  paths.each([&](Backend& backend) {
    const auto moments_of = [&](const RawMesh& mesh) { return moments(backend, moment_problem(mesh, 12)); };
    const Multipoles exact = moments_of(body);
    for (const std::string& bytes :
         {off_text(body), obj_text(body), ply_text(body), ply_bytes(body, true, false), ply_bytes(body, true, true)})
      CHECK(same_bits(moments_of(parse_mesh(bytes, "x")), exact));
    check_close(moments_of(parse_mesh(stl_text(body), "x")), exact, moment_problem(body, 12), 3e-14); // other vertices
    const RawMesh rounded = rounded_to_floats(body);
    const Multipoles single = moments_of(rounded);
    CHECK(!same_bits(single, exact));
    for (const std::string& bytes : {ply_bytes(body, false, false), ply_bytes(body, false, true), glb_bytes(body)})
      CHECK(same_bits(moments_of(parse_mesh(bytes, "x")), single));
    check_close(moments_of(parse_mesh(stl_bytes(body), "x")), single, moment_problem(rounded, 12), 3e-14);
  });
}

TEST_CASE("the welded STL of the benchmark cow has one edge of four faces: moments accept it, maps refuse it",
          "[formats][readers][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const RawMesh rounded = rounded_to_floats(cow->mesh());
  const std::string text = stl_text(cow->mesh());
  const ClosedSurface welded = ClosedSurface::from(parse_mesh(text, "cow.stl"));
  CHECK(welded.vertices().size() + 1 == cow->vertices().size());
  CHECK(volume(welded) == Approx(volume(*cow)).epsilon(1e-15));
  const Outcome map = outcome_of([&] { ManifoldSurface::from(welded); });
  CHECK(map.fault == "mesh-edge-manifold");
  CHECK(map.says("1 edge"));
  CHECK(outcome_of([&] { ManifoldSurface::from(*cow); }).fault == "none");
  // Through floats, as STL files mostly are: the same, and the moments of the rounded body.
  const ClosedSurface single = ClosedSurface::from(parse_mesh(stl_bytes(cow->mesh()), "cow.stl"));
  CHECK(outcome_of([&] { ManifoldSurface::from(single); }).fault == "mesh-edge-manifold");
  Paths paths;
  paths.each([&](Backend& backend) {
    check_close(moments(backend, moment_problem(single.mesh(), 16)), moments(backend, moment_problem(rounded, 16)),
                moment_problem(rounded, 16), 3e-15);
  });
}

TEST_CASE("readers take at most four times the file beside it", "[formats][readers]") {
  if (!memory_is_measurable()) return;
  const RawMesh body = icosphere(7); // 327,680 faces
  RawMesh soup = body;               // every corner a vertex of its own
  soup.vertices.clear();
  for (std::size_t f = 0; f < body.faces.size(); ++f) {
    for (const std::uint32_t v : body.faces[f]) soup.vertices.push_back(body.vertices[v]);
    const auto first = static_cast<std::uint32_t>(3 * f);
    soup.faces[f] = {first, first + 1, first + 2};
  }
  const std::pair<const char*, std::string> files[] = {
      {"OFF", off_text(body)},
      {"OBJ", obj_text(body)},
      {"PLY text", ply_text(body)},
      {"PLY of floats", ply_bytes(body, false, true)},
      {"PLY of doubles", ply_bytes(body, true, false)},
      {"STL text", stl_text(body)},
      {"STL", stl_bytes(body)},
      {"GLB", glb_bytes(body)},
      {"GLB to be welded", glb_bytes(soup)},
  };
  for (const auto& [what, bytes] : files) {
    const std::string& file = bytes;
    const std::size_t growth = peak_growth([&] { parse_mesh(file, "x"); });
    INFO(what << ": " << double(growth) / double(file.size()) << " of " << file.size());
    CHECK(growth < 4 * file.size());
  }
}

TEST_CASE("a mesh comes through standard input in every format", "[formats][readers][cli]") {
  const TemporaryFolder folder;
  const RawMesh body = box({1, 2, 3});
  for (const std::string& bytes : {off_text(body), obj_text(body), ply_text(body), ply_bytes(body, false, true),
                                   stl_text(body), stl_bytes(body, "solid"), glb_bytes(body)}) {
    const std::string path = folder / "in";
    std::ofstream(path, std::ios::binary) << bytes;
    const std::string command =
        "cat '" + path + "' | '" COWGPU_PROGRAM "' inspect - --json > '" + (folder / "out") + "'";
    CHECK(std::system(command.c_str()) == 0);
    std::ifstream out(folder / "out");
    const std::string text((std::istreambuf_iterator<char>(out)), {});
    INFO(text);
    CHECK(text.find("standard input") != std::string::npos);
    CHECK(text.find("\"volume\": 6") != std::string::npos);
  }
}

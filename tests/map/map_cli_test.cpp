#include "host/error.hpp"
#include "host/io/document_json.hpp"
#include "host/io/map_file.hpp"
#include "host/io/mesh_source.hpp"
#include "host/io/ply.hpp"
#include "host/map/harmonic.hpp"
#include "host/map/quality.hpp"
#include "host/map/stretch.hpp"
#include "host/paper/recipe.hpp"
#include "host/report/map_report.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

ManifoldSurface manifold(RawMesh mesh) {
  return ManifoldSurface::from(ClosedSurface::from(std::move(mesh)));
}

void write_off(const std::string& path, const RawMesh& mesh) {
  std::ofstream file(path);
  file << "OFF\n" << mesh.vertices.size() << " " << mesh.faces.size() << " 0\n";
  for (const Vec3& v : mesh.vertices) file << fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
  for (const Face& f : mesh.faces) file << fmt::format("3 {} {} {}\n", f[0], f[1], f[2]);
}

void write_ply_file(const std::string& path, const std::vector<Vec3>& vertices, const std::vector<Face>& faces) {
  TriangleSurface surface;
  surface.name = "map";
  surface.vertices = vertices;
  surface.faces = faces;
  AtomicFile file(path);
  write_ply(surface, {}, file);
  file.commit();
}

/// "file-format: ...", or "none".
std::string fault_of_reading(const std::string& path, const ManifoldSurface& surface) {
  try {
    read_map(path, surface);
  } catch (const Error& error) {
    return fmt::format("{}: {}", name(error.fault()), error.what());
  }
  return "none";
}

} // namespace

TEST_CASE("every method maps a sphere one-to-one and says so", "[map-cli]") {
  for (const char* method : {"harmonic", "stretch", "smooth"}) {
    INFO(method);
    const ProgramRun run = run_program({"map", "builtin:sphere@2", "--method", method, "--lmax", "4"});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    CHECK_THAT(run.out, StartsWith("mesh builtin:sphere:1@2, sha256 "));
    CHECK_THAT(run.out, Contains(fmt::format("map: {}, made in", method)));
    CHECK_THAT(run.out, Contains("flipped triangles        0\n") && Contains("the map is one-to-one"));
    CHECK_THAT(run.out, Contains("grid for lmax 4, whose cells are 22.5 degrees"));
  }
}

TEST_CASE("a map is made by stretch unless told otherwise, and by harmonic for the paper's recipe", "[map-cli]") {
  CHECK_THAT(run_program({"map", "builtin:sphere@1"}).out, Contains("map: stretch,"));
  const ProgramRun paper = run_program({"map", "builtin:sphere@1", "--recipe", "paper"});
  CHECK_THAT(paper.out, Contains("map: harmonic,") && Contains("the disk was multiplied by 10"));
}

TEST_CASE("the harmonic map is polished unless told otherwise", "[map-cli]") {
  const auto shear = [](std::vector<std::string> options) {
    options.insert(options.begin(), {"map", "builtin:ellipsoid:1,1,1.5@4", "--lmax", "8", "--json"});
    const ProgramRun run = run_program(options);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return nlohmann::json::parse(run.out)["quality"]["shear"]["values"].back().get<double>();
  };
  CHECK(shear({"--method", "harmonic"}) < 1.03);
  CHECK(shear({"--method", "harmonic", "--polish"}) < 1.03);
  CHECK(shear({"--method", "harmonic", "--no-polish"}) > 1.1);
  CHECK(shear({"--recipe", "paper"}) > 1.1);
}

TEST_CASE("a map's PLY reads back bit for bit as what the method gives", "[map-cli]") {
  const TemporaryFolder folder;
  const auto surface = manifold(load_mesh("builtin:cow@1"));
  const std::string harmonic = folder / "harmonic.ply", stretch = folder / "stretch.ply";
  REQUIRE(run_program({"map", "builtin:cow@1", "--method", "harmonic", "--weights", "tutte", "--pole", "7", "--centre",
                       "-o", harmonic})
              .exit_code == 0);
  REQUIRE(run_program({"map", "builtin:cow@1", "--sweeps", "3", "--lambda", "0.1", "-o", stretch}).exit_code == 0);

  HarmonicOptions options;
  options.weights = EdgeWeights::tutte;
  options.pole.rule = Pole::Rule::vertex;
  options.pole.vertex = 7;
  options.centre = true;
  const SphereMap read = read_map(harmonic, surface);
  CHECK(read.method == MapMethod::file);
  CHECK(read.positions == harmonic_map(surface, options).positions);
  Monitor silent;
  StretchOptions few;
  few.sweeps = 3;
  few.lambda = 0.1;
  CHECK(read_map(stretch, surface).positions == stretch_map(surface, few, silent).positions);
}

TEST_CASE("a map's GLB is written whole, and other suffixes are refused before any work", "[map-cli]") {
  const TemporaryFolder folder;
  const std::string path = folder / "map.glb";
  const ProgramRun run = run_program({"map", "builtin:sphere@1", "-o", path});
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.err, Contains("wrote " + path));
  std::ifstream file(path, std::ios::binary);
  std::string magic(4, ' ');
  file.read(magic.data(), 4);
  CHECK(magic == "glTF");
  const ProgramRun refused = run_program({"map", "builtin:sphere@1", "-o", folder / "map.obj"});
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("must end in .ply or .glb"));
  CHECK(refused.out.empty());
  CHECK_FALSE(std::filesystem::exists(folder / "map.obj"));
}

TEST_CASE("options that do not belong to the method are usage errors", "[map-cli]") {
  const std::vector<std::vector<std::string>> refused = {
      {"--weights", "tutte"},
      {"--pole", "back"},
      {"--disk-scale", "2"},
      {"--centre"},
      {"--polish"},
      {"--no-polish"},
      {"--method", "harmonic", "--polish", "--no-polish"},
      {"--recipe", "paper", "--no-polish"},
      {"--method", "smooth", "--centre"},
      {"--method", "smooth", "--sweeps", "3"},
      {"--method", "harmonic", "--lambda", "0.1"},
      {"--method", "harmonic", "--converge"},
      {"--method", "stretch", "--recipe", "paper"},
      {"--recipe", "paper", "--sweeps", "3"},
      {"--recipe", "paper", "--weights", "cotangent"},
      {"--recipe", "paper", "--polish"},
      {"--method", "harmonic", "--disk-scale", "2", "--centre"},
  };
  for (std::vector<std::string> arguments : refused) {
    INFO(fmt::format("{}", fmt::join(arguments, " ")));
    arguments.insert(arguments.begin(), {"map", "builtin:sphere@1"});
    const ProgramRun run = run_program(arguments);
    CHECK(run.exit_code == 2);
    CHECK(run.out.empty());
    CHECK_THAT(run.err, Contains("[bad-argument]") && Contains("--"));
  }
}

TEST_CASE("absurd values for a map are usage errors", "[map-cli]") {
  const std::vector<std::vector<std::string>> refused = {
      {"--method", "flat"},
      {"--recipe", "cake"},
      {"--method", "harmonic", "--weights", "heavy"},
      {"--method", "harmonic", "--pole", "north"},
      {"--method", "harmonic", "--pole", "1,2"},
      {"--method", "harmonic", "--pole", "1,2,nan"},
      {"--method", "harmonic", "--pole", "-1"},
      {"--method", "harmonic", "--pole", "99999999999"},
      {"--method", "harmonic", "--pole", "1000000"},
      {"--method", "harmonic", "--disk-scale", "0"},
      {"--method", "harmonic", "--weights", "mean-value", "--polish"},
      {"--lambda", "-1"},
      {"--lambda", "nan"},
      {"--sweeps", "-3"},
      {"--lmax", "0"},
      {"--lmax", "8193"},
  };
  for (std::vector<std::string> arguments : refused) {
    INFO(fmt::format("{}", fmt::join(arguments, " ")));
    arguments.insert(arguments.begin(), {"map", "builtin:sphere@1"});
    const ProgramRun run = run_program(arguments);
    CHECK(run.exit_code == 2);
    CHECK_THAT(run.err, Contains("[bad-argument]"));
  }
}

TEST_CASE("a surface that is not one sphere has no map, and no file is left", "[map-cli]") {
  const TemporaryFolder folder;
  write_off(folder / "torus.off", torus(12, 8));
  write_off(folder / "two.off", two_shells());
  for (const char* mesh : {"torus.off", "two.off"})
    for (const char* method : {"harmonic", "stretch", "smooth"}) {
      INFO(mesh << " " << method);
      const ProgramRun run = run_program({"map", folder / mesh, "--method", method, "-o", folder / "map.ply"});
      CHECK(run.exit_code == 3);
      CHECK_THAT(run.err, Contains("[map-topology]"));
      CHECK(run.out.empty());
    }
  const auto left = std::filesystem::directory_iterator(folder.path());
  CHECK(std::distance(begin(left), end(left)) == 2);
}

TEST_CASE("the JSON of a map holds the findings of judge()", "[map-cli]") {
  const ProgramRun run = run_program({"map", "builtin:cow@1", "--recipe", "paper", "--lmax", "32", "--json"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const auto json = nlohmann::json::parse(run.out);
  const auto surface = manifold(load_mesh("builtin:cow@1"));
  const MapQuality want = judge(surface, harmonic_map(surface, paper::harmonic_map()), 32);
  CHECK(json["schema"] == "cowgpu.map.v1");
  CHECK(json["method"] == "harmonic");
  CHECK(json["output"].is_null());
  CHECK(json["mesh"]["sha256"] == surface.closed().mesh().sha256);
  const auto& quality = json["quality"];
  CHECK(quality["lmax"] == 32);
  CHECK(quality["triangles"] == want.triangles);
  CHECK(quality["degree"] == want.degree);
  CHECK(quality["flipped"]["faces"] == nlohmann::json(want.flipped));
  CHECK(quality["log_area_ratio"]["values"] == nlohmann::json(want.log_area_ratio));
  CHECK(quality["smallest_height"]["radians"] == want.smallest_height);
  CHECK(quality["smallest_height"]["face"] == want.smallest_height_face);
  CHECK(want.unseen > 0); // the legs are gone
  CHECK(quality["seen"] == want.triangles - want.unseen);
  CHECK(quality["unseen"]["area"] == want.unseen_area);
  CHECK(quality["unseen"]["parts"].size() == want.parts.size());
  CHECK(quality["sentences"] == nlohmann::json(want.sentences));
}

TEST_CASE("a stretch map says how many relabelled copies come to it", "[map-cli]") {
  const std::vector<std::string> arguments = {"map", "builtin:sphere@2", "--converge", "--relabellings",
                                              "4",   "--lmax",           "8"};
  const ProgramRun run = run_program(arguments);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("relabelled and turned    4 of 4 copies reach this mean square to 1e-06"));
  std::vector<std::string> with_json = arguments;
  with_json.emplace_back("--json");
  const auto stretch = nlohmann::json::parse(run_program(with_json).out)["stretch"];
  CHECK(stretch["energy"] > 1);
  CHECK(stretch["gradient"] < 1e-6);
  CHECK(stretch["relabellings"]["reached"] == 4);
  REQUIRE(stretch["relabellings"]["copies"].size() == 4);
  CHECK(stretch["relabellings"]["copies"][3]["seed"] == 4);
  CHECK(run_program({"map", "builtin:sphere@2", "--method", "smooth", "--relabellings", "2"}).exit_code == 2);
}

TEST_CASE("a long map is interrupted", "[map-cli]") {
  const TemporaryFolder folder;
  for (const char* method : {"harmonic", "smooth"}) {
    ProgramOptions options;
    options.interrupt_after = 0.5;
    const std::string path = folder / "map.ply";
    const ProgramRun run = run_program({"map", "builtin:cow@5", "--method", method, "-o", path}, options);
    INFO(run.err);
    CHECK(run.exit_code == 130);
    CHECK_FALSE(std::filesystem::exists(path));
  }
}

TEST_CASE("infinite shear is null in the JSON of a map, and flat triangles are listed", "[map-cli]") {
  const auto surface = manifold(test::icosphere(1));
  SphereMap map{MapMethod::file, surface.vertices(), {}};
  for (Vec3& p : map.positions) p.normalize();
  const Face& face = surface.faces()[9];
  map.positions[face[0]] = map.positions[face[1]];
  MapResult report{surface, map};
  report.quality = judge(surface, map, 4);
  std::string screen;
  write_screen(report, [&](std::string_view part) { screen += part; });
  const auto quality = nlohmann::json::parse(json_text(document(report, {})))["quality"];
  CHECK(quality["shear"]["values"].back().is_null());
  CHECK(quality["shear"]["values"].front().is_number());
  CHECK(quality["flat"]["count"] == 2); // both triangles at that edge
  CHECK(quality["flat"]["faces"] == nlohmann::json(report.quality.flat));
  CHECK_THAT(screen, Contains(fmt::format("triangles of no area     2: face {}; face {}\n", report.quality.flat[0],
                                          report.quality.flat[1])));
}

TEST_CASE("a file is read as a map only of the mesh it belongs to", "[map-cli]") {
  const TemporaryFolder folder;
  const std::string path = folder / "map.ply";
  const auto surface = manifold(test::icosphere(1));
  std::vector<Vec3> positions = surface.vertices();
  for (Vec3& p : positions) p.normalize();
  write_ply_file(path, positions, surface.faces());
  CHECK(read_map(path, surface).positions == positions);

  CHECK_THAT(fault_of_reading(path, manifold(test::icosphere(2))), StartsWith("file-format: ") && Contains("vertices"));
  CHECK_THAT(fault_of_reading(folder / "none.ply", surface), StartsWith("cannot-read: "));
  std::vector<Face> faces = surface.faces();
  std::swap(faces[3], faces[4]);
  write_ply_file(path, positions, faces);
  CHECK_THAT(fault_of_reading(path, surface), StartsWith("file-format: face 3 of "));
  faces.pop_back();
  write_ply_file(path, positions, faces);
  CHECK_THAT(fault_of_reading(path, surface), StartsWith("file-format: ") && Contains("79 faces"));

  positions[5] *= 1 + 5e-10;
  write_ply_file(path, positions, surface.faces());
  CHECK(fault_of_reading(path, surface) == "none");
  for (const double length : {0.0, 1 - 2e-9, 1 + 2e-9, 1e300}) {
    positions[5] = length * surface.vertices()[5].normalized();
    write_ply_file(path, positions, surface.faces());
    INFO(length);
    CHECK_THAT(fault_of_reading(path, surface), StartsWith("file-format: vertex 5 of "));
  }
}

TEST_CASE("vertices of no face are zero in a map's file and when it is read", "[map-cli]") {
  const TemporaryFolder folder;
  RawMesh mesh = test::icosphere(1);
  mesh.vertices.push_back({0.25, 0.5, 4});
  write_off(folder / "more.off", mesh);
  const std::string path = folder / "map.ply";
  const ProgramRun run = run_program({"map", folder / "more.off", "-o", path});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const SphereMap map = read_map(path, manifold(load_mesh(folder / "more.off")));
  CHECK(map.positions.back() == Vec3::Zero());
  CHECK(map.positions.size() == mesh.vertices.size());
}

TEST_CASE("a map is taken neither for another method's nor for another mesh's of the same faces", "[map-cli]") {
  const TemporaryFolder folder;
  const std::string path = folder / "map.ply", body = folder / "body.off", other = folder / "other.off";
  RawMesh mesh = test::icosphere(1);
  write_off(body, mesh);
  mesh.vertices[3] *= 1.5;
  write_off(other, mesh);
  REQUIRE(run_program({"map", body, "--method", "harmonic", "-o", path}).exit_code == 0);
  const auto expand = [&](const std::string& of, const std::string& which, const std::string& map) {
    return run_program({"expand", which, "--of", of, "--map", map, "--lmax", "2", "--device", "cpu"});
  };
  CHECK(expand("harmonic", body, path).exit_code == 0);
  const ProgramRun method = expand("stretch", body, path), hash = expand("harmonic", other, path);
  CHECK(method.exit_code == 3);
  CHECK_THAT(method.err, Contains("holds a map by the method harmonic, not stretch"));
  CHECK(hash.exit_code == 3);
  CHECK_THAT(hash.err, Contains("was made for a mesh of SHA-256"));
  CHECK(expand("harmonic", body, "").exit_code == 2);
}

TEST_CASE("a map that rounding has spoilt is not written", "[map-cli]") {
  const TemporaryFolder folder;
  const std::string path = folder / "map.ply";
  const ProgramRun run =
      run_program({"map", "builtin:cow@1", "--method", "harmonic", "--disk-scale", "1e300", "-o", path});
  CHECK(run.exit_code == 3);
  CHECK_THAT(run.err, Contains("covers the sphere 0 times"));
  CHECK_FALSE(std::filesystem::exists(path));
}

TEST_CASE("a link to the mesh is not taken for an output", "[map-cli]") {
  const TemporaryFolder folder;
  const std::string body = folder / "body.off", link = folder / "link.ply";
  write_off(body, test::icosphere(1));
  std::filesystem::create_symlink(body, link);
  const ProgramRun run = run_program({"map", body, "-o", link});
  CHECK(run.exit_code == 2);
  CHECK_THAT(run.err, Contains("input and output at once"));
  CHECK(std::filesystem::is_symlink(link));
}

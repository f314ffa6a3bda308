#include "host/io/surface_file.hpp"

#include "host/io/coefficient_file.hpp"
#include "host/io/mesh_source.hpp"
#include "host/map/stretch.hpp"
#include "host/mesh/body.hpp"
#include "host/spectrum/convert.hpp"
#include "host/spectrum/expand_surface.hpp"
#include "tests/support/fields.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

std::string surface_json(const char* name) {
  return fmt::format(
      R"("{}": {{"lmax": 1, "origin": [0.5, -1, 2], "recipe": "default", "map": {{"method": "stretch"}},)"
      R"( "fields": ["f_r", "f_dtheta", "f_dphi", "x", "y", "z"], "dphi": "signed",)"
      R"( "removed_means": {{"f_dtheta": 0.25, "f_dphi": -0.125}},)"
      R"( "normalisation": "orthonormal", "condon_shortley": true, "coefficients": [)"
      "\n[0, 0, 1, 0, 0, 0, 0, 0, 4, 0, 5, 0, 6, 0], [1, 0, 7, 0, 8, 0, 9, 0, 10, 0, 11, 0, 12, 0],\n"
      "[1, 1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12.5]]}}",
      name);
}

std::string file_json(const std::string& expansions) {
  return R"({"schema": "cowgpu.result.v1", "mesh": {"name": "cow", "sha256": "ab"}, "expansions": {)" + expansions +
         "}}";
}

std::string fault_of_reading(const std::string& path, const std::string& text, const std::string& of = "") {
  write_text(path, text);
  return fault_of([&] { read_surface(path, of); });
}

} // namespace

TEST_CASE("a surface expansion that expand wrote reads back to the very doubles", "[surface_file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "cow.json";
  REQUIRE(run_program({"expand", "builtin:cow@1", "--of", "stretch,harmonic", "--recipe", "paper", "--lmax", "7",
                       "--device", "cpu", "-q", "-o", path})
              .exit_code == 0);
  Monitor silent;
  const auto backend = make_cpu_backend(1);
  const Body body = make_body(ClosedSurface::from(load_mesh("builtin:cow@1")), {}, 1);
  ExpandSurfaceOptions options;
  options.lmax = 7;
  options.origin = body.origin;
  const SphereMap map = stretch_map(ManifoldSurface::from(body.surface), {}, silent);
  const SurfaceExpansion want =
      expand_surface(body.surface.vertices(), body.surface.faces(), map, options, *backend, silent);

  const SurfaceFile file = read_surface(path);
  CHECK(file.name == "stretch");
  CHECK(file.map_method == "stretch");
  CHECK(file.recipe == "default");
  CHECK(file.mesh_hash == body.surface.mesh().sha256);
  CHECK(file.expansion.coefficients.lmax == 7);
  CHECK(file.expansion.coefficients.values == want.coefficients.values);
  CHECK(file.expansion.origin == want.origin);
  CHECK(file.expansion.mean_dtheta == want.mean_dtheta);
  CHECK(file.expansion.mean_dphi == want.mean_dphi);
  CHECK(file.expansion.signed_dphi);

  const SurfaceFile paper = read_surface(path, "harmonic");
  CHECK(paper.recipe == "paper");
  CHECK_FALSE(paper.expansion.signed_dphi);
  CHECK(paper.expansion.origin == Vec3::Zero());
}

TEST_CASE("which expansion of a file is read: the one named, stretch, or the only one", "[surface_file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "e.json";
  write_text(path, file_json(surface_json("smooth")));
  const SurfaceFile only = read_surface(path);
  CHECK(only.name == "smooth");
  CHECK(only.expansion.origin == Vec3(0.5, -1, 2));
  CHECK(only.expansion.mean_dphi == -0.125);
  CHECK(only.expansion.coefficients.at(5, 1, 1) == std::complex<double>(11, 12.5));
  CHECK(only.expansion.coefficients.at(4, 1, 0) == std::complex<double>(11, 0));

  write_text(path, file_json(surface_json("harmonic") + ", " + surface_json("stretch")));
  CHECK(read_surface(path).name == "stretch");
  CHECK(read_surface(path, "harmonic").name == "harmonic");
  const std::string two = file_json(surface_json("harmonic") + ", " + surface_json("smooth"));
  CHECK_THAT(fault_of_reading(path, two), StartsWith("bad-argument: ") && Contains("harmonic, smooth; choose one"));
  CHECK_THAT(fault_of_reading(path, two, "flow"),
             StartsWith("bad-argument: --of flow: ") && Contains("harmonic, smooth"));
}

TEST_CASE("a file of no surface expansion, or a damaged one, is a named error", "[surface_file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "e.json";
  const std::string good = file_json(surface_json("stretch"));
  REQUIRE(fault_of_reading(path, good) == "none");
  CHECK_THAT(fault_of([&] { read_fields(path); }), StartsWith("file-format: ") && Contains("no mass moments"));
  CHECK_THAT(fault_of_reading(path, file_json(R"("mass": {"lmax": 0})")),
             StartsWith("file-format: " + path) && Contains("--of stretch -o FILE.json"));
  CHECK_THAT(fault_of_reading(path, file_json("")), StartsWith("file-format: ") && Contains("no expansion"));
  CHECK_THAT(fault_of_reading(path, replaced(good, "cowgpu.result.v1", "cowgpu.map.v1")),
             StartsWith("file-format: ") && Contains("not cowgpu.result.v1"));
  CHECK_THAT(fault_of([&] { read_surface(folder / "none.json"); }), StartsWith("cannot-read: "));
  const std::vector<std::string> all = {
      "",
      "[]",
      "null",
      replaced(good, "\"expansions\": {", "\"expansions\": [], \"other\": {"),
      replaced(good, "\"lmax\": 1", "\"lmax\": 2"),
      replaced(good, "\"lmax\": 1", "\"lmax\": 0"),
      replaced(good, "\"lmax\": 1", "\"lmax\": -1"),
      replaced(good, "\"lmax\": 1", "\"lmax\": 1.5"),
      replaced(good, "\"lmax\": 1", "\"lmax\": 4097"),
      replaced(good, "\"lmax\": 1", "\"lmax\": 99999999999999999999"),
      replaced(good, "\"lmax\"", "\"lmin\""),
      replaced(good, "\"origin\"", "\"start\""),
      replaced(good, "[0.5, -1, 2]", "[0.5, -1]"),
      replaced(good, "[0.5, -1, 2]", "[0.5, -1, null]"),
      replaced(good, "\"removed_means\"", "\"means\""),
      replaced(good, "\"f_dphi\": -0.125", "\"f_dphi\": \"-0.125\""),
      replaced(good, "\"f_r\", ", ""),
      replaced(good, "\"signed\"", "\"wavy\""),
      replaced(good, "\"dphi\": \"signed\"", "\"dphi\": 1"),
      replaced(good, "orthonormal", "4pi"),
      replaced(good, "true", "false"),
      replaced(good, "\"method\"", "\"way\""),
      replaced(good, "\"mesh\"", "\"milk\""),
      replaced(good, "12.5", "NaN"),
      replaced(good, "12.5", "1e999"),
      replaced(good, "12.5", "null"),
      replaced(good, ", 12.5", ""),
      replaced(good, "[1, 1, 1, 2", "[1, 0, 1, 2"),
      replaced(good, "[0, 0, 1, 0", "[0, 0, 1, 0.5"),
  };
  for (const std::string& text : all) {
    const std::string found = fault_of_reading(path, text);
    INFO(text << "\n" << found);
    CHECK_THAT(found, StartsWith("file-") && Contains(path));
  }
  for (std::size_t length = 0; length < good.size(); ++length)
    CHECK_THAT(fault_of_reading(path, good.substr(0, length)), StartsWith("file-syntax: "));
}

TEST_CASE("the CSV of a surface expansion reads back as its fields", "[surface_file]") {
  const TemporaryFolder folder;
  const std::string json = folder / "cow.json", csv = folder / "cow.csv";
  REQUIRE(run_program({"expand", "builtin:cow@1", "--of", "smooth,mass", "--lmax", "5", "--device", "cpu", "-q", "-o",
                       json, "-o", csv})
              .exit_code == 0);
  const CoefficientSet table = read_fields(csv);
  CHECK(table.names == std::vector<std::string>{"mass", "smooth_f_r", "smooth_f_dtheta", "smooth_f_dphi", "smooth_x",
                                                "smooth_y", "smooth_z"});
  const CoefficientSet mass = read_fields(json);
  CHECK(table.notes == mass.notes);
  std::vector<std::complex<double>> want = orthonormal(mass).values;
  const SurfaceFile surface = read_surface(json);
  want.insert(want.end(), surface.expansion.coefficients.values.begin(), surface.expansion.coefficients.values.end());
  CHECK(orthonormal(table).values == want);

  REQUIRE(run_program({"expand", "builtin:cow@1", "--of", "smooth", "--lmax", "5", "--device", "cpu", "-q", "-o", csv})
              .exit_code == 0);
  CHECK(orthonormal(read_fields(csv)).values == surface.expansion.coefficients.values);
  CHECK_THAT(read_text(csv),
             Contains("# smooth_origin (centre of mass) ") && Contains("# smooth_removed_mean_f_dphi "));
  write_text(csv, replaced(read_text(csv), "smooth_x_im", "smooth_y_im"));
  CHECK_THAT(fault_of([&] { read_fields(csv); }), StartsWith("file-format: "));
}

#include "host/io/gfc.hpp"
#include "host/physics/polyhedron.hpp"

#include "host/io/coefficient_file.hpp"
#include "host/io/mesh_source.hpp"
#include "host/spectrum/convert.hpp"
#include "host/spectrum/roundtrip.hpp"
#include "tests/support/fields.hpp"
#include "tests/support/gravity_model.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <cmath>
#include <random>
#include <sstream>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using Catch::StartsWith;
using physics::LongVec3;

namespace {

const std::string good = "a model of nothing\n"
                         "product_type gravity_field\nmax_degree 99\n"
                         "begin_of_head ===\n"
                         "product_type gravity_field\nmodelname  PLANET-1\n"
                         "earth_gravity_constant  0.3986004415D+15\nradius 0.63781363e7\nmax_degree 2\n"
                         "errors formal\nnorm fully_normalized\ntide_system tide_free\n"
                         "end_of_head ===\n"
                         "gfc 0 0 1.0d0 0 1e-9 0\n"
                         "gfc 2 0 -0.484165371736E-03 0.0 1e-12 0\n"
                         "gfc 1 0 0 0 0 0\n"
                         "gfc 1 1 0 0 0 0\n"
                         "gfc 2 1 -0.1D-9 +0.2D-9 1e-12 1e-12\n"
                         "gfc 2 2 2.5e-6 -1.4e-6 1e-12 1e-12\n";

CoefficientSet read_text_as_gfc(const std::string& path, const std::string& text) {
  return parse_gfc(text, path);
}

// Against the polyhedron in random directions at 1.5 and 3 Brillouin radii; the largest error over its bound.
void check_potential(const std::string& mesh_name, int lmax) {
  const TemporaryFolder folder;
  const std::string path = folder / "body.gfc";
  const ProgramRun run = run_program({"expand", mesh_name, "--lmax", std::to_string(lmax), "--density", "2.5",
                                      "--device", "cpu", "--origin", "0.01,0.02,0.03", "-q", "-o", path});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const GravityModel model = read_gravity_model(path);
  REQUIRE(model.lmax == lmax);
  std::istringstream text(model.comments.at("origin"));
  std::string kind;
  double x = 0, y = 0, z = 0;
  REQUIRE((text >> kind >> x >> y >> z));
  CHECK(kind == "(given)");
  const RawMesh mesh = load_mesh(mesh_name);
  const physics::Polyhedron polyhedron(mesh.vertices, mesh.faces);
  physics::Polyhedron::Scratch scratch;
  const long double radius = std::stold(model.head.at("radius"));
  const long double g = std::stold(model.comments.at("gravitational_constant"));
  CHECK(model.comments.at("mesh_sha256") == mesh.sha256);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const long double far : {1.5L, 3.0L})
    for (int i = 0; i < 8; ++i) {
      const LongVec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized().cast<long double>();
      const LongVec3 at = direction * (far * radius);
      const long double exact = 2.5L * g * polyhedron.at(at + Vec3(x, y, z).cast<long double>(), scratch).value;
      const long double error = std::fabs(model.potential(at.x(), at.y(), at.z()) / exact - 1);
      INFO(mesh_name << " to degree " << lmax << " at " << double(far) << " R: " << double(error));
      CHECK(error <= std::max(1e-12L, std::pow(1 / far, (long double)(lmax + 1))));
    }
}

} // namespace

TEST_CASE("a .gfc file gives an independent reader the potential of the polyhedron", "[gfc]") {
  for (const int lmax : {4, 20, 80}) check_potential("builtin:cow@1", lmax);
  check_potential("builtin:box:1,2,3", 40);
}

TEST_CASE("the benchmark's .gfc file gives an independent reader the potential of the polyhedron", "[gfc]") {
  if (!benchmark_cow()) return skip_without_cow();
  for (const int lmax : {20, 80}) check_potential("benchmark", lmax);
}

TEST_CASE("a model as others write it is read: D exponents, any order, errors, text above the head", "[gfc]") {
  const TemporaryFolder folder;
  const CoefficientSet set = read_text_as_gfc(folder / "m.gfc", good);
  CHECK(set.kind == CoefficientKind::potential);
  CHECK(set.convention == Convention{Normalisation::four_pi, Phase::none});
  CHECK(set.lmax == 2);
  CHECK(set.gm == 0.3986004415e15);
  CHECK(set.reference_radius == 0.63781363e7);
  CHECK(set.gravitational_constant == gravitational_constant_si);
  CHECK(set.length_unit == "m");
  CHECK(set.first[set.index(0, 2, 0)] == -0.484165371736e-03);
  CHECK(set.second[set.index(0, 2, 1)] == 0.2e-9);
  CHECK_THAT(set.notes.at(0), Contains("errors"));
  const CoefficientSet moon =
      read_text_as_gfc(folder / "m.gfc", replaced(good, "earth_gravity_constant", "gravity_constant"));
  CHECK(moon.gm == set.gm);
  // Degrees 0 and 1 may be left out.
  const std::string later = good.substr(0, good.find("gfc 0")) + good.substr(good.find("gfc 2 0"));
  const CoefficientSet short_set =
      read_text_as_gfc(folder / "m.gfc", replaced(replaced(later, "gfc 1 0 0 0 0 0\n", ""), "gfc 1 1 0 0 0 0\n", ""));
  CHECK(short_set.first == set.first);
  CHECK(short_set.notes.size() == 2);
  CHECK_THAT(short_set.notes.at(1), Contains("degrees 0 and 1") && Contains("C_00 = 1"));
  // Comments among the rows, no product_type and no norm.
  const CoefficientSet bare = read_text_as_gfc(
      folder / "m.gfc",
      replaced(replaced(replaced(good, "===\nproduct_type gravity_field\n", "===\n"), "norm fully_normalized\n", ""),
               "gfc 1 1", "# degree 1\ncmmt is the centre of mass\n\ngfc 1 1"));
  CHECK(bare.first == set.first);
  CHECK(bare.second == set.second);
  std::string notes;
  for (const std::string& note : bare.notes) notes += note + "\n";
  CHECK_THAT(notes, Contains("no product_type") && Contains("no norm") && Contains("2 comments among the rows") &&
                        Contains("line 15"));
}

TEST_CASE("a .gfc file reads back to the last bit, with everything it says", "[gfc]") {
  const TemporaryFolder folder;
  for (const Normalisation n : {Normalisation::four_pi, Normalisation::unnormalised}) {
    CoefficientSet set = set_of(random_coefficients(40, 1, 7), {n, Phase::none});
    set.kind = CoefficientKind::potential;
    set.reference_radius = 1.0 / 3;
    set.gm = 0.1 + 0.2;
    set.mass = 2.0 / 7;
    set.density = -1e-300;
    set.gravitational_constant = gravitational_constant_si;
    set.origin = Vec3(1e-17, -2.0 / 3, 5e20);
    set.origin_kind = "given";
    set.length_unit = "m";
    set.mass_unit = "kg";
    set.names = {"mass"};
    set.provenance = {"cowgpu 1", "2026-01-01T00:00:00Z", "cowgpu expand 'begin_of_head end_of_head radius norm'",
                      "a b.off",  std::string(64, 'a'),   "one; two"};
    set.remarks = {{"rotation", "by 30 degrees"}};
    AtomicFile file(folder / "m.gfc");
    write_coefficient_set(set, CoefficientFormat::gfc, file);
    file.commit();
    const CoefficientSet back = read_coefficient_set(folder / "m.gfc");
    CHECK(back.first == set.first);
    CHECK(back.second == set.second);
    CHECK(back.convention == set.convention);
    CHECK(back.reference_radius == set.reference_radius);
    CHECK(back.gm == set.gm);
    CHECK(back.mass == set.mass);
    CHECK(back.density == set.density);
    CHECK(back.gravitational_constant == set.gravitational_constant);
    CHECK(back.origin == set.origin);
    CHECK(back.origin_kind == "given");
    CHECK(back.length_unit == "m");
    CHECK(back.mass_unit == "kg");
    CHECK(back.provenance.mesh == "a b.off");
    CHECK(back.provenance.mesh_sha256 == set.provenance.mesh_sha256);
    CHECK(back.provenance.history == "one; two");
    CHECK(back.provenance.created == set.provenance.created);
    CHECK_THAT(back.provenance.command, Contains("radius norm"));
    CHECK(back.remarks == set.remarks);
  }
}

TEST_CASE("rows that a gravity model leaves out are 0, and a note counts them; one that was cut off is refused",
          "[gfc]") {
  const std::string bytes = read_text(std::string(COWGPU_CORPUS) + "/coefficients/gfc--rows-left-out.gfc");
  const CoefficientSet set = parse_gfc(bytes, "m.gfc");
  CHECK(set.lmax == 3);
  CHECK(set.first[0] == 1);
  CHECK(set.first[set.index(0, 2, 0)] == -4.84e-4);
  CHECK(set.first[set.index(0, 3, 0)] == 9.57e-7);
  for (int l = 1; l <= 3; ++l)
    for (int m = 1; m <= l; ++m) CHECK((set.first[set.index(0, l, m)] == 0 && set.second[set.index(0, l, m)] == 0));
  std::string notes;
  for (const std::string& note : set.notes) notes += note + "\n";
  CHECK_THAT(notes,
             Contains("5 rows that the file leaves out, the first of degree 2, order 1") && Contains("degree 1 that"));
  // Without its last row there is none of degree 3.
  CHECK_THAT(fault_of([&] { parse_gfc(bytes.substr(0, bytes.find("gfc    3")), "m.gfc"); }),
             StartsWith("file-truncated: m.gfc:") && Contains("its largest degree is 3"));
  // Nor where it says more degrees than it has.
  CHECK_THAT(fault_of([&] { parse_gfc(replaced(bytes, "3\n", "6\n"), "m.gfc"); }),
             StartsWith("file-truncated: m.gfc:"));
  // The rows of a file of ours are all there.
  CHECK_THAT(fault_of([&] { parse_gfc("# cowgpu 1\n" + bytes, "m.gfc"); }), StartsWith("file-truncated: "));
}

TEST_CASE("a gravity model in kilometres is told by its body, or by the user", "[gfc][length-unit]") {
  std::string moon = replaced(replaced(good, "0.3986004415D+15", "4902.8"), "0.63781363e7", "1738.0");
  const CoefficientSet guessed = parse_gfc(moon, "m.gfc"), stated = parse_gfc(moon, "m.gfc", 1.0);
  CHECK(guessed.reference_radius == 1738e3);
  CHECK(guessed.gm == Approx(4902.8e9).epsilon(1e-15));
  CHECK_THAT(guessed.notes.back(), Contains("kilometres were taken") && Contains("the Moon"));
  CHECK(stated.reference_radius == 1738.0);
  CHECK(stated.gm == 4902.8);
  moon = replaced(moon, "4902.8", "4802.8"); // nobody's
  CHECK(parse_gfc(moon, "m.gfc").reference_radius == 1738.0);
  CHECK(parse_gfc(moon, "m.gfc", 1000.0).reference_radius == 1738e3);
}

TEST_CASE("gravity models that are wrong are named errors with file and line", "[gfc]") {
  const TemporaryFolder folder;
  const std::string path = folder / "m.gfc";
  struct Bad {
    const char* fault;
    int line;
    std::string text;
    const char* words;
  };
  const std::vector<Bad> all = {
      {"file-format", 0, "", "end_of_head"},
      {"file-format", 15, replaced(good, "gfc 2 0", "gfct 2 0"), "varies with time"},
      {"file-format", 15, replaced(good, "gfc 2 0", "trnd 2 0"), "'trnd'"},
      {"file-format", 15, replaced(good, "gfc 2 0", "asin 2 0"), "'asin'"},
      {"file-format", 15, replaced(good, "gfc 2 0", "acos 2 0"), "'acos'"},
      {"file-syntax", 15, replaced(good, "gfc 2 0", "dog 2 0"), "'gfc ...' expected"},
      {"file-syntax", 17, replaced(good, "gfc 1 1", "gfc 1 0"), "a second time"},
      {"file-syntax", 17, replaced(good, "gfc 1 1", "gfc 1 2"), "the order"},
      {"file-syntax", 17, replaced(good, "gfc 1 1", "gfc 3 1"), "the degree"},
      {"file-syntax", 17, replaced(good, "gfc 1 1", "gfc -1 1"), "the degree"},
      {"file-syntax", 15, replaced(good, "-0.484165371736E-03 0.0", "-0.484165371736E-03 0.5"), "order 0"},
      {"file-syntax", 19, replaced(good, "2.5e-6", "nan"), "finite"},
      {"file-syntax", 19, replaced(good, "2.5e-6", "1e999"), "beyond the range of doubles"},
      {"file-syntax", 19, replaced(good, "2.5e-6", "2.5e-6x"), "a number expected"},
      {"file-truncated", 19, replaced(good, "2.5e-6 -1.4e-6 1e-12 1e-12", "2.5e-6"), "found 4 words"},
      {"file-truncated", 18, replaced(good, "gfc 2 2 2.5e-6 -1.4e-6 1e-12 1e-12\n", ""), "degree 2, order 2"},
      {"file-truncated", 19, replaced(good, "max_degree 2\n", "max_degree 8192\n"), "degree 3, order 0"},
      {"too-large", 20, replaced(good, "max_degree 2\n", "max_degree 8192\n") + "gfc 8192 0 1 0\n", "1000 a row"},
      {"file-syntax", 9, replaced(good, "max_degree 2\n", "max_degree 8193\n"), "max_degree"},
      {"file-syntax", 13, replaced(good, "radius 0.63781363e7\n", "radius_of_it\n"), "radius"},
      {"file-syntax", 8, replaced(good, "radius 0.63781363e7\n", "radius -1\n"), "above 0"},
      {"file-syntax", 8, replaced(good, "radius 0.63781363e7\n", "radius inf\n"), "finite"},
      {"file-syntax", 11, replaced(good, "fully_normalized", "halfway"), "halfway"},
      {"file-format", 5, replaced(good, "===\nproduct_type gravity_field", "===\nproduct_type topography"),
       "topography"},
  };
  for (const Bad& bad : all) {
    const std::string found = fault_of([&] { read_text_as_gfc(path, bad.text); });
    INFO(bad.text << "\n" << found);
    const std::string where = bad.line ? fmt::format("{}:{}", path, bad.line) : path;
    CHECK_THAT(found, StartsWith(fmt::format("{}: {}: ", bad.fault, where)) && Contains(bad.words));
  }
}

TEST_CASE("every prefix and many damaged copies of a gravity model are read or named errors", "[gfc]") {
  const TemporaryFolder folder;
  const std::string path = folder / "m.gfc";
  int read = 0;
  for (std::size_t length = 0; length < good.size(); ++length) {
    const std::string found = fault_of([&] { read_text_as_gfc(path, good.substr(0, length)); });
    INFO(length << ": " << found);
    CHECK((found == "none" || found.rfind("file-", 0) == 0));
    read += found == "none";
  }
  // Only what the last row's end can miss: the line's end, and its errors.
  CHECK(read <= int(std::string("-1.4e-6 1e-12 1e-12\n").size()));
  for (std::uint32_t seed = 0; seed < 600; ++seed) {
    const std::string found = fault_of([&] { read_text_as_gfc(path, damaged(good, seed)); });
    INFO(seed << ": " << found);
    CHECK((found == "none" || found.rfind("file-", 0) == 0));
  }
}

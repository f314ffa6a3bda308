// What is wrong in "Higher multipoles of the cow": each numeric erratum by a second way than the program's own list.
#include "host/io/mesh_source.hpp"
#include "host/paper/errata.hpp"
#include "host/paper/surface_tables.hpp"
#include "host/physics/radiate.hpp"
#include "host/requests/errata.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <map>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::paper;
using namespace cowgpu::physics;
using namespace cowgpu::test;
using nlohmann::json;

namespace {

constexpr double pi = std::numbers::pi;

Comparison number(const std::vector<Comparison>& all, const std::string& quantity) {
  for (const Comparison& n : all)
    if (n.quantity == quantity) return n;
  FAIL("no number is called " << quantity);
  return {};
}

std::map<std::string, std::pair<double, double>> numbers_of(const json& report) {
  std::map<std::string, std::pair<double, double>> all;
  for (const json& erratum : report["errata"])
    for (const json& n : erratum["numbers"]) all[n["quantity"]] = {n["right"], n["paper"]};
  return all;
}

} // namespace

TEST_CASE("eighteen errata have words, a reason and a number of their own", "[errata]") {
  int expected = 1;
  for (const Erratum& e : errata()) {
    CHECK(e.number == expected++);
    CHECK(!std::string(e.printed).empty());
    CHECK(!std::string(e.right).empty());
    CHECK(!std::string(e.why).empty());
  }
  CHECK(errata().size() == 18);
}

TEST_CASE("errata are found by a call, without the paper's mesh those of its own numbers", "[errata][requests]") {
  const ErrataResult found = find_errata({}, silent_monitor());
  CHECK(found.numbers.size() == errata_numbers().size() + 1);
  for (std::size_t i = 1; i < found.numbers.size(); ++i)
    CHECK(found.numbers[i - 1].erratum <= found.numbers[i].erratum);
}

TEST_CASE("errata 1 and 2: the square is 9.04e6 kg^2 m^4, and 3/(8 pi) is 2.807 times too little", "[errata]") {
  const auto all = errata_numbers();
  const Comparison square = number(all, "square of the paper's tensor in kg^2 m^4");
  CHECK(square.ours == Approx(9.04e6).epsilon(1e-3));
  CHECK(square.ours == Approx(1.4866e-3 * 13652.0 * 13652.0 * std::pow(2.39, 4)).epsilon(1e-4));
  CHECK(square.printed / square.ours > 9e5);
  // The printed power goes with the right square, and not with the printed one.
  const Comparison power = number(all, "power of it in erg/s");
  CHECK(power.ours == Approx(power.printed).epsilon(0.01));
  CHECK(double(quadrupole_power(square.printed, 1)) * 1e7 > 1e5 * power.printed);
  const Comparison factor = number(all, "factor of G/c^5 sum |Q'''_2m|^2");
  CHECK(factor.ours == Approx(8 * pi / 75).epsilon(1e-14));
  CHECK(factor.ours / factor.printed == Approx(2.807).epsilon(1e-3));
}

TEST_CASE("errata 3 and 4: a monopole pulls as its mass, and Y_lm has norm 1 with 2l+1", "[errata]") {
  const auto all = errata_numbers();
  CHECK(number(all, "r V/M of a point mass").ours == Approx(1).epsilon(1e-14));
  CHECK(number(all, "r V/M of a point mass").printed == Approx(0.2820948).epsilon(1e-6));
  CHECK(number(all, "integral of |Y_22|^2").ours == Approx(1).epsilon(1e-13));
  CHECK(number(all, "integral of |Y_22|^2").printed == Approx(24).epsilon(1e-13));
}

TEST_CASE("errata 5, 7 and 14: phases, deficit and size of the benchmark", "[errata][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const auto all = errata_numbers(make_body(*cow, {}, 1));
  CHECK(number(all, "Im Q_22").ours == Approx(2.191867934902e-4).epsilon(1e-11));
  CHECK(number(all, "Im Q_22").printed < 0);
  CHECK(number(all, "volume").ours == Approx(0.0534799266715660841).epsilon(1e-14));
  CHECK(number(all, "mass in kg").ours == Approx(730).epsilon(2e-3));
  CHECK(number(all, "Q_00").ours == Approx(1.508640877850e-2).epsilon(1e-11));
  CHECK(number(all, "deficit with exact tensors").ours == Approx(1.1098e-32).epsilon(5e-5));
  const auto plain = errata_numbers();
  CHECK(number(plain, "deficit with the paper's tensors").ours == Approx(1.1206e-32).epsilon(5e-5));
  CHECK(number(plain, "deficit with the paper's rounding").ours == Approx(1.1432e-32).epsilon(5e-5));
  CHECK(number(plain, "deficit with the paper's rounding").printed == Approx(1.1432e-32).epsilon(1e-12));
}

TEST_CASE("erratum 9: a rotation leaves the mean of theta alone", "[errata]") {
  // Over points that a rotation by 90 degrees about y permutes only in the mean: midpoints of a fine product grid.
  double before = 0, after = 0;
  const int n = 400;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      const double z = -1 + (2 * i + 1.0) / n, phi = (j + 0.5) * pi / n, s = std::sqrt(1 - z * z);
      before += std::acos(z) / (2 * n * n);
      after += std::acos(0.8 * z + 0.6 * s * std::cos(phi)) / (2 * n * n);
    }
  CHECK(before == Approx(pi / 2).epsilon(1e-12));
  CHECK(after == Approx(pi / 2).epsilon(1e-6));
}

TEST_CASE("erratum 11: the opposite of (theta, phi) is (pi - theta, phi + pi), and the hooves stand 0.28 behind",
          "[errata][benchmark]") {
  const auto point = [](double theta, double phi) {
    return Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
  };
  CHECK((point(0.7, 1.1) + point(pi - 0.7, 1.1 + pi)).norm() < 1e-15);
  CHECK(0.7 + pi > pi); // no colatitude
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const auto lever = number(errata_numbers(make_body(*cow, {}, 1)), "lever of the lowest hoof about x");
  CHECK(std::sqrt(lever.printed * lever.printed - lever.ours * lever.ours) == Approx(0.28).margin(0.01));
  CHECK(lever.ours < 0.15);
}

TEST_CASE("erratum 13: the centrifugal potential has degrees 0 and 2 alone", "[errata]") {
  // sin^2(theta)/2 = (1 - P_2)/3, by values at five places.
  for (const double z : {-1.0, -0.3, 0.0, 0.6, 1.0})
    CHECK((1 - z * z) / 2 == Approx((1 - std::legendre(2u, z)) / 3).margin(1e-15));
}

TEST_CASE("erratum 10: the harmonic table ends at l = 3", "[errata]") {
  CHECK(number(errata_numbers(), "highest degree of the harmonic table").ours == 3);
}

TEST_CASE("erratum 18: with the mesh's own length the unit is 2.39374 m, and the power 1.57 % more",
          "[errata][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const auto all = errata_numbers(make_body(*cow, {}, 1));
  CHECK(number(all, "length of the mesh").ours == Approx(1.044392).epsilon(5e-7));
  CHECK(number(all, "length of the mesh").printed == 1.044);
  CHECK(number(all, "unit of length in m").ours == Approx(2.39374).epsilon(2e-6));
  CHECK(number(all, "power at fixed density, over that of 2.39 m").ours == Approx(1.0157).margin(1e-4));
  double mass = 0;
  for (const Comparison& n : all)
    if (n.erratum == 18 && n.quantity == "mass in kg") mass = n.ours;
  CHECK(mass == Approx(0.0534799266715660841 * 1000 * std::pow(2.5 / 1.044392, 3)).epsilon(2e-6));
}

TEST_CASE("errata 6, 8, 15, 16 and 17: the command computes them beside the paper's", "[errata][cli][benchmark]") {
  if (!benchmark_cow()) return skip_without_cow();
  const ProgramRun run = run_program({"errata", "--json"});
  REQUIRE(run.exit_code == 0);
  const json report = json::parse(run.out);
  CHECK(report["errata"].size() == 18);
  const auto all = numbers_of(report);
  CHECK(all.at("l of the hexapentacontadictapole") == std::pair(8.0, 256.0));
  CHECK(all.at("misfit of the harmonic table's f_dphi: |dphi|, signed").first < 0.0015);
  CHECK(all.at("misfit of the harmonic table's f_dphi: |dphi|, signed").second > 1);
  CHECK(all.at("misfit of the flow table's f_dphi: |dphi|, signed").first < 0.12);
  CHECK(all.at("misfit of the flow table's f_dphi: |dphi|, signed").second > 1);
  CHECK(all.at("monopole of f_r at large times").first == Approx(1.7151368).margin(5e-8));
  CHECK(all.at("monopole of f_r at t = 0.2, of the vertices in coarse steps").first == Approx(1.075).margin(0.01));
  const auto [refined, table] = all.at("monopole of f_r at t = 0.2, mesh refined");
  CHECK(table == 1.075);
  CHECK(refined == Approx(1.0919).margin(0.0018)); // twice what the extrapolation is uncertain by
  double uncertain = 0;
  for (const json& n : report["errata"][14]["numbers"])
    if (n["quantity"] == "monopole of f_r at t = 0.2, mesh refined") uncertain = n["uncertainty"];
  CHECK(uncertain > std::abs(refined - 1.0919));
  CHECK(uncertain < 0.01);
  CHECK(all.at("negative cotangent weights").first == 1351);
  CHECK(all.at("inverted triangles").first == 68);
  CHECK(all.at("least time for a star-shaped cow").first == Approx(0.241954).margin(3e-6));
}

TEST_CASE("without the mesh errata are told all the same", "[errata][cli]") {
  ProgramOptions nowhere;
  const TemporaryFolder empty;
  nowhere.environment = {{"COWGPU_MESHES", empty.path()}, {"HOME", empty.path()}, {"XDG_DATA_HOME", empty.path()}};
  const ProgramRun run = run_program({"errata"}, nowhere);
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.out, Catch::Contains("18. paper: the unit of length is 2.39 m"));
}

#include "host/physics/body_field.hpp"
#include "host/physics/far_field.hpp"
#include "tests/support/compare_potential.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;

namespace {

namespace mp = boost::multiprecision;
// The closed form loses the third power of the distance, 1e180 here, and its derivatives as much.
using Wide = mp::number<mp::cpp_bin_float<260>, mp::et_off>;

struct WideField {
  Wide value = 0;
  std::array<Wide, 3> gradient{};
  std::array<std::array<Wide, 3>, 3> hessian{};
};

Wide arsinh(const Wide& x) {
  return x < 0 ? Wide(-log(sqrt(x * x + 1) - x)) : Wide(log(x + sqrt(x * x + 1)));
}

// W. D. MacMillan, The Theory of the Potential, 1930, sect. 40, at a place in no plane of a face and on no line of an edge.
WideField box_field(const Vec3& low, const Vec3& high, const Vec3& at) {
  WideField sum;
  for (int corner = 0; corner < 8; ++corner) {
    std::array<Wide, 3> x, log, angle;
    for (int c = 0; c < 3; ++c) x[c] = Wide((corner >> c & 1 ? high : low)[c]) - Wide(at[c]);
    const int sign = ((corner & 1) + (corner >> 1 & 1) + (corner >> 2 & 1)) % 2 ? 1 : -1;
    const Wide d = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    for (int c = 0; c < 3; ++c) {
      const Wide &y = x[(c + 1) % 3], &z = x[(c + 2) % 3];
      angle[c] = atan(y * z / (x[c] * d));
      log[c] = arsinh(x[c] / sqrt(y * y + z * z));
    }
    for (int c = 0; c < 3; ++c) {
      const int u = (c + 1) % 3, v = (c + 2) % 3;
      sum.value += sign * (x[u] * x[v] * log[c] - x[c] * x[c] * angle[c] / 2);
      sum.gradient[c] -= sign * (x[u] * log[v] + x[v] * log[u] - x[c] * angle[c]);
      sum.hessian[c][c] -= sign * angle[c];
      sum.hessian[u][v] += sign * log[c];
      sum.hessian[v][u] += sign * log[c];
    }
  }
  return sum;
}

struct Measured {
  double value = 0, gradient = 0, hessian = 0; // relative errors
  double stated = 0;
  bool by_series = false;
};

Measured measured(const Body& body, const Vec3& low, const Vec3& high, const Vec3& at) {
  Monitor silent;
  const physics::BodyFieldValues found = physics::exact_field(body, std::span(&at, 1), Derivatives::second, 1, silent);
  const WideField truth = box_field(low, high, at);
  Measured m;
  m.stated = found.error;
  m.by_series = found.by_series[0] != 0;
  m.value = double(abs(Wide(found.field.value[0]) / truth.value - 1));
  Wide difference = 0, norm = 0;
  for (int c = 0; c < 3; ++c) {
    const Wide rest = Wide(found.field.gradient[0][c]) - truth.gradient[c];
    difference += rest * rest;
    norm += truth.gradient[c] * truth.gradient[c];
  }
  m.gradient = double(sqrt(difference / norm));
  const SymmetricTensor& h = found.field.hessian[0];
  const std::array<std::array<double, 3>, 3> full = {{{h[0], h[1], h[2]}, {h[1], h[3], h[4]}, {h[2], h[4], h[5]}}};
  difference = norm = 0;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const Wide rest = Wide(full[a][b]) - truth.hessian[a][b];
      difference += rest * rest;
      norm += truth.hessian[a][b] * truth.hessian[a][b];
    }
  m.hessian = double(sqrt(difference / norm));
  CHECK(found.density[0] == Approx(0).margin(1e-12));
  return m;
}

Body box_body(const Vec3& sides, const Vec3& corner) {
  return make_body(ClosedSurface::from(box(sides, corner)), {}, 1);
}

} // namespace

TEST_CASE("the exact field of a box is right to the accuracy that it states, from its corners to 1e60 sizes away",
          "[polyhedron][far]") {
  const Vec3 sides(1, 2, 3), corner(-0.5, -1, -1.5);
  const Body body = box_body(sides, corner);
  int closed = 0, series = 0;
  double worst = 0, worst_of_second = 0;
  std::vector<double> distances;
  distances.push_back((corner + sides).norm()); // as far as the corners
  for (double d = 2; d < 300; d *= 1.7) distances.push_back(d);
  for (double d = 1e3; d < 1e61; d *= 1e6) distances.push_back(d);
  for (const double d : distances)
    for (const Vec3& to : {Vec3(0.6, 0.3, 0.7), Vec3(1, 1e-3, 2e-3)}) {
      const Measured m = measured(body, corner, corner + sides, to.normalized() * d);
      INFO("at " << d << (m.by_series ? " by the series" : " by the closed form") << ", stated " << m.stated);
      CHECK(m.value <= m.stated);
      CHECK(m.gradient <= m.stated);
      CHECK(m.hessian <= 16 * m.stated);
      (m.by_series ? series : closed) += 1;
      worst = std::max(worst, m.stated);
      worst_of_second = std::max(worst_of_second, m.hessian);
    }
  CHECK((closed > 5 && series > 15));
  check_at_most(worst, 8e-15, "stated");
  check_at_most(worst_of_second, 8e-15, "second derivatives");
}

TEST_CASE("of slabs a millionth of a millionth thick, whose closed form is noise, the series is taken beside them",
          "[polyhedron][far]") {
  for (const double thick : {1e-6, 1e-12}) {
    const Vec3 sides(2, 1, thick), corner(-1, -0.5, -thick / 2);
    const Body body = box_body(sides, corner);
    for (const double d : {1.3, 2.0, 3.0, 10.0, 1e4}) {
      const Measured m = measured(body, corner, corner + sides, Vec3(0.6, 0.3, 0.7).normalized() * d);
      INFO(thick << " thick, at " << d << ", stated " << m.stated);
      CHECK(m.value <= m.stated);
      CHECK(m.gradient <= m.stated);
      check_at_most(m.stated, d > 5 ? 4e-15 : 2e-5, "stated");
    }
  }
}

TEST_CASE("far away a hollow body of two densities, with its origin elsewhere, attracts like its mass",
          "[polyhedron][far]") {
  const RawMesh outer = box(Vec3(2, 2, 2)), inner = box(Vec3(1.999, 1.999, 1.999), Vec3(0.0005, 0.0005, 0.0005));
  const Body body =
      make_body(ClosedSurface::from(outer), {"given", Vec3(1e5, 0, 0)}, 3, {Part(ClosedSurface::from(inner), -3)});
  Monitor silent;
  const std::vector<Vec3> points = {Vec3(1, 1, 1) + Vec3(0, 3e5, 4e5), Vec3(1, 1, 1) + Vec3(0, 3e40, 4e40)};
  const auto found = physics::exact_field(body, points, Derivatives::first, 0, silent);
  const double mass = 3 * (8 - std::pow(1.999, 3));
  CHECK(found.field.value[0] == Approx(mass / 5e5).epsilon(1e-11)); // a cube has no quadrupole; 8 - 1.999^3 cancels
  CHECK(found.field.value[1] == Approx(mass / 5e40).epsilon(1e-11));
  CHECK(found.field.gradient[1].z() == Approx(-0.8 * mass / 25e80).epsilon(1e-11));
  CHECK(found.by_series == std::vector<std::uint8_t>{1, 1});
  CHECK(found.density == std::vector<double>{0, 0});
}

TEST_CASE("potential --exact far away names the series, its accuracy and what computes", "[polyhedron][far][cli]") {
  const auto answer = [](const char* at, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"potential", "builtin:box:1,2,3", "--exact", "--json", "--at", at};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramRun run = run_program(arguments);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return nlohmann::json::parse(run.out);
  };
  const auto far = answer("1e10,1,2");
  CHECK(far["potential"].get<double>() == Approx(-6e-10).epsilon(1e-15));
  CHECK(far["acceleration"][0].get<double>() == Approx(-6e-20).epsilon(1e-15));
  CHECK(far["acceleration"][1].get<double>() == Approx(-6e-30).epsilon(1e-12));
  CHECK(far["acceleration"][2].get<double>() == Approx(-12e-30).epsilon(1e-12));
  CHECK(far["far_count"] == 1);
  CHECK(far["exact_count"] == 0);
  CHECK(far["exact_error"].get<double>() <= 4e-15);
  CHECK_THAT(far["notes"].dump(), Contains("series to degree 32"));
  CHECK(far["density"] == 0);
  const auto farther = answer("1e50,0,0");
  CHECK(farther["potential"].get<double>() == Approx(-6e-50).epsilon(1e-15));
  CHECK(std::abs(farther["acceleration"][1].get<double>()) <= 1e-115); // 6e-100 along x
  const auto edge = answer("1e200,0,0");
  CHECK(edge["potential"].get<double>() == Approx(-6e-200).epsilon(1e-15));
  CHECK(edge["acceleration"][0] == 0);
  CHECK_THAT(edge["notes"].dump(), Contains("smaller than doubles hold"));
  CHECK(answer("3,2,1")["exact_count"] == 1);
}

TEST_CASE("the closed form is computed on the CPU, whatever device is named, and the output says so",
          "[polyhedron][cli]") {
  for (const char* device : {"0", "cpu", "auto"}) {
    const ProgramRun run =
        run_program({"potential", "builtin:box:1,2,3", "--exact", "--at", "3,2,1", "--json", "--device", device});
    REQUIRE(run.exit_code == 0);
    const auto found = nlohmann::json::parse(run.out);
    CHECK_THAT(found["device"].get<std::string>(), Contains("80-bit"));
    CHECK_THAT(found["device"].get<std::string>(), !Contains("Vulkan"));
    if (device == std::string("0")) CHECK_THAT(found["notes"].dump(), Contains("--device 0 is not used"));
  }
  const ProgramRun mixed = run_program(
      {"potential", "builtin:box:1,2,3", "--plane", "z,0.1,4,5", "--inside", "exact", "--json", "--device", "cpu"});
  REQUIRE(mixed.exit_code == 0);
  const std::string device = nlohmann::json::parse(mixed.out)["device"];
  CHECK_THAT(device, Contains("series: CPU path") && Contains("polyhedron: CPU, 80-bit"));
}

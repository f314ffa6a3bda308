// Equilibria of the public plate models of Eros (the environment variable COWGPU_FIELD names their folder).
#include "host/coefficient_set.hpp"
#include "host/physics/body_field.hpp"
#include "host/requests/equilibria.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <numbers>

using namespace cowgpu;
using physics::Equilibrium;

namespace {

// All equilibria of a model at 5.27 h about z, 2.67 g/cm^3, and that gravity vanishes there by 80-bit sums too.
void check_eros(const char* name) {
  const char* folder = std::getenv("COWGPU_FIELD");
  if (!folder || !std::filesystem::exists(std::filesystem::path(folder) / name)) {
    std::cout << "SKIPPED: COWGPU_FIELD names no folder with " << name << "\n";
    return;
  }
  EquilibriaRequest request;
  request.body.mesh = std::filesystem::path(folder) / name;
  request.body.length_unit = 1000;
  request.body.density = 2670;
  request.spin_rate = {2 * std::numbers::pi / (5.27 * 3600), true, "rad/s"};
  request.spin_axis = Vec3::UnitZ();
  const auto cpu = make_cpu_backend(0);
  Monitor monitor;
  const EquilibriaResult found = equilibria(request, *cpu, monitor);
  const auto& points = found.equilibria.points;
  CHECK(found.equilibria.complete());
  REQUIRE(points.size() == 5);
  CHECK(points[0].inside);
  CHECK(points[0].motions.kind == physics::EquilibriumKind::stable);
  // The four outside are unstable, saddles ahead of both ends and growing oscillations beside the waist, all near the synchronous
  // radius and the plane of the equator.
  for (std::size_t i = 1; i < 5; ++i) {
    const Equilibrium& e = points[i];
    CHECK_FALSE(e.inside);
    const bool end = std::abs(e.at[0]) > std::abs(e.at[1]);
    CHECK(e.motions.kind == (end ? physics::EquilibriumKind::saddle : physics::EquilibriumKind::spiral));
    CHECK(e.motions.index == (end ? 1 : -1));
    CHECK((e.at - found.centre_of_mass).norm() == Approx(found.synchronous).epsilon(0.3));
    CHECK(std::abs(e.at[2]) < 500);
  }
  CHECK(std::count_if(points.begin(), points.end(), [](const Equilibrium& e) { return e.motions.index == 1; }) == 2);
  // The same field by other sums.
  std::vector<std::string> notes;
  const Body body = load_body(request.body, notes, monitor);
  std::vector<Vec3> places;
  for (const Equilibrium& e : points) places.push_back(e.at);
  const auto exact = physics::exact_field(body, places, Derivatives::first, 0, monitor);
  const double scale = found.constant * found.mass / (found.synchronous * found.synchronous);
  for (std::size_t i = 0; i < places.size(); ++i) {
    Vec3 arm = places[i] - found.centre_of_mass;
    arm[2] = 0;
    const double w2 = found.spin.rate * found.spin.rate;
    CHECK((found.constant * exact.field.gradient[i] + w2 * arm).norm() < 1e-13 * scale);
    CHECK(points[i].jacobi ==
          Approx(-found.constant * exact.field.value[i] - w2 * arm.squaredNorm() / 2).epsilon(1e-13));
  }
}

} // namespace

TEST_CASE("Eros of 856 vertices has a centre and four unstable equilibria, and they are all", "[equilibria][long]") {
  check_eros("EROS856Vert1708Fac.txt");
}

TEST_CASE("Eros of 3,897 vertices has a centre and four unstable equilibria, and they are all", "[equilibria][long]") {
  check_eros("eros007790.tab");
}

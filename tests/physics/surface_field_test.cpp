// Gravity of the public plate models of Eros (the environment variable COWGPU_FIELD names their folder).
#include "host/physics/body_field.hpp"
#include "host/requests/surface_gravity.hpp"
#include "tests/support/compare_moments.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <numbers>
#include <sstream>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

std::optional<std::filesystem::path> field_file(const char* name) {
  const char* folder = std::getenv("COWGPU_FIELD");
  if (folder && std::filesystem::exists(std::filesystem::path(folder) / name))
    return std::filesystem::path(folder) / name;
  std::cout << "SKIPPED: COWGPU_FIELD names no folder with " << name << "\n";
  return std::nullopt;
}

BodyRequest eros(const std::filesystem::path& file) {
  BodyRequest body;
  body.mesh = file;
  body.length_unit = 1000;
  return body;
}

struct State {
  Vec3 at, velocity;
};

std::vector<State> read_states(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<State> states;
  for (std::string line; std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    double t;
    State s;
    words >> t >> s.at[0] >> s.at[1] >> s.at[2] >> s.velocity[0] >> s.velocity[1] >> s.velocity[2];
    if (words) states.push_back(s);
  }
  return states;
}

const std::vector<double>& column(const SurfaceGravityResult& result, const std::string& name) {
  for (const ValueColumn& c : result.values.columns)
    if (c.name == name && c.components == 1) return c.values;
  throw std::runtime_error("there is no column " + name);
}

SurfaceGravityResult answer(const SurfaceGravityRequest& request) {
  Monitor silent;
  const auto backend = make_cpu_backend();
  return surface_gravity(plan_surface_gravity(request, silent), *backend, silent);
}

} // namespace

TEST_CASE("along a stored orbit about Eros the Jacobi constant is constant to 1e-12", "[surface-gravity][field]") {
  const auto plates = field_file("EROS856Vert1708Fac.txt"), orbit = field_file("polyTestData.csv");
  if (!plates || !orbit) return;
  const std::vector<State> states = read_states(*orbit);
  REQUIRE(states.size() > 280);
  constexpr double mu = 4.46275472004e5, omega = 2 * std::numbers::pi / (5.27 * 3600); // m^3/s^2, rad/s
  Monitor silent;
  const LoadedMass loaded = load_mass(eros(*plates), Motion::held, silent);
  const Body& body = *loaded.mesh;
  CHECK(body.volume == Approx(2491.6158371488315e9).epsilon(1e-13));
  std::vector<Vec3> points;
  for (const State& s : states) points.push_back(s.at);
  const auto backend = make_cpu_backend();
  for (const double tolerance : {0.0, 1e-12}) {
    const physics::BodyFieldProblem problem{Derivatives::none, physics::FieldSum::device, 0, tolerance};
    const auto field = physics::BodyField(body, problem, *backend).at(points, silent).field;
    double least = 1e300, greatest = -1e300, sum = 0;
    std::size_t twelfths = 0;
    for (std::size_t i = 0; i < states.size(); ++i) {
      const Vec3& x = states[i].at;
      const double jacobi = states[i].velocity.squaredNorm() / 2 - omega * omega * (x.x() * x.x() + x.y() * x.y()) / 2 -
                            mu / body.mass() * field.value[i];
      least = std::min(least, jacobi);
      greatest = std::max(greatest, jacobi);
      if (i % 12 == 0) {
        sum += jacobi;
        ++twelfths;
      }
    }
    INFO("to " << tolerance);
    CHECK(sum / double(twelfths) == Approx(-35.2572211979).epsilon(1e-11));
    check_at_most((greatest - least) / std::abs(least), 1e-12, "spread of the Jacobi constant");
  }
}

TEST_CASE("both plate models of Eros have the gravity that is known of it", "[surface-gravity][field][long]") {
  const auto coarse = field_file("EROS856Vert1708Fac.txt"), fine = field_file("eros007790.tab");
  if (!coarse || !fine) return;
  const struct {
    std::filesystem::path file;
    std::size_t faces, vertices;
    double volume;
  } models[] = {{*coarse, 1708, 856, 2491.6158371488315e9}, {*fine, 7790, 3897, 2525.99460318316e9}};
  for (const auto& model : models) {
    INFO(model.file);
    SurfaceGravityRequest request;
    request.body = eros(model.file);
    request.body.density = 2670;
    request.spin_rate = Measure{2 * std::numbers::pi / (5.27 * 3600), true, "rad/s"};
    const SurfaceGravityResult result = answer(request);
    CHECK(result.values.places.size() == model.faces);
    CHECK(result.volume == Approx(model.volume).epsilon(1e-13));
    // It turns about the shortest axis, which is near z; J. K. Miller et al., Icarus 155 (2002) 3: a surface gravity from 2.1 to
    // 5.5 mm/s^2; M. T. Zuber et al., Science 289 (2000) 2097: slopes of 36 degrees at most but for 2 % of the area.
    CHECK(std::abs(result.spin->axis.z()) > 0.999);
    const auto &g = column(result, "g"), &slope = column(result, "slope"), &escape = column(result, "escape_speed");
    CHECK(*std::min_element(g.begin(), g.end()) > 1.9e-3);
    CHECK(*std::max_element(g.begin(), g.end()) < 6e-3);
    double steep = 0, area = 0;
    for (std::size_t i = 0; i < slope.size(); ++i) {
      steep += slope[i] > 36 ? result.areas[i] : 0;
      area += result.areas[i];
    }
    CHECK(steep / area < 0.04);
    CHECK(*std::max_element(escape.begin(), escape.end()) < 20);
    CHECK(result.gravity_error <= 2e-9 * result.gravity_scale);
    // The mean of the elevation's numerator is 0 by area, so that heights have both signs.
    const auto& elevation = column(result, "elevation");
    CHECK(*std::min_element(elevation.begin(), elevation.end()) < -500);
    CHECK(*std::max_element(elevation.begin(), elevation.end()) > 500);
    request.place = ValuePlace::vertices;
    CHECK(answer(request).values.places.size() == model.vertices);
  }
}

TEST_CASE("at sampled faces of Eros the fast sum is right to its tolerance, against 80-bit sums",
          "[surface-gravity][field]") {
  const auto plates = field_file("eros007790.tab");
  if (!plates) return;
  Monitor silent;
  const LoadedMass loaded = load_mass(eros(*plates), Motion::held, silent);
  const Body& body = *loaded.mesh;
  const auto all = physics::face_places(body.surface, 0);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < all.at.size(); i += 61) points.push_back(all.at[i]);
  const auto backend = make_cpu_backend();
  const auto truth = physics::exact_field(body, points, Derivatives::first, 0, silent);
  for (const double tolerance : {0.0, 1e-9, 1e-6}) {
    const physics::BodyFieldProblem problem{Derivatives::first, physics::FieldSum::device, 0, tolerance};
    const auto found = physics::BodyField(body, problem, *backend).at(points, silent);
    double worst = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      worst = std::max(worst, (found.field.gradient[i] - truth.field.gradient[i]).norm());
    INFO("to " << tolerance);
    CHECK(worst <= found.gradient_error);
    check_at_most(worst / physics::gravity_scale(body), tolerance == 0 ? 4e-14 : tolerance, "g");
  }
}

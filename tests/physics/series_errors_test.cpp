#include "host/backend.hpp"
#include "host/io/mesh_source.hpp"
#include "host/mass/mass_moments.hpp"
#include "host/physics/body_field.hpp"
#include "host/physics/potential.hpp"
#include "host/physics/potential_terms.hpp"
#include "tests/support/compare_potential.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

Body body_of(RawMesh mesh) {
  return make_body(ClosedSurface::from(std::move(mesh)), {}, 1);
}

// Over vertices, middles of edges and faces, the axes, next to all of these, and a spiral over the sphere.
std::vector<Vec3> dense_directions(const Body& body, std::size_t spiral, std::size_t most_faces) {
  std::vector<Vec3> all = {Vec3::UnitX(), -Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitY(), Vec3::UnitZ(), -Vec3::UnitZ()};
  const auto& faces = body.surface.faces();
  const std::size_t step = faces.size() / most_faces + 1;
  for (std::size_t f = 0; f < faces.size(); f += step) {
    std::array<Vec3, 3> x;
    for (std::size_t k = 0; k < 3; ++k) x[k] = body.surface.vertices()[faces[f][k]] - body.origin;
    for (const Vec3& p : {x[0], Vec3((x[0] + x[1]) / 2), Vec3((x[0] + x[1] + x[2]) / 3)})
      if (p.norm() > 0) all.push_back(p.normalized());
  }
  const std::size_t marked = all.size();
  for (std::size_t i = 0; i < marked; ++i)
    for (const double off : {1e-3, 1e-2}) all.push_back((all[i] + off * all[i].unitOrthogonal()).normalized());
  for (std::size_t i = 0; i < spiral; ++i) {
    const double z = 1 - (2 * double(i) + 1) / double(spiral),
                 phi = double(i) * std::numbers::pi * (3 - std::sqrt(5.0));
    all.emplace_back(std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi), z);
  }
  return all;
}

// The largest errors that the polyhedron and the series on the CPU path show over directions: of V, of its gradient.
std::array<double, 2> scan(const Body& body, const std::vector<Vec3>& to, double d, int order) {
  const auto backend = make_cpu_backend();
  Monitor silent;
  const Multipoles q = mass_moments(mass_problems(body, order, default_cut_off), *backend, silent);
  std::vector<Vec3> points, places;
  for (const Vec3& n : to) {
    points.push_back(n * (d * (1 + 1e-15) * body.brillouin_radius));
    places.push_back(points.back() + body.origin);
  }
  const PotentialField found = backend->exterior_potential({q, order, Derivatives::first})->at(points, silent);
  const PotentialField truth = physics::exact_field(body, places, Derivatives::first, 0, silent).field;
  std::array<double, 2> worst{};
  for (std::size_t i = 0; i < to.size(); ++i) {
    worst[0] = std::max(worst[0], std::abs(found.value[i] - truth.value[i]) / std::abs(truth.value[i]));
    worst[1] = std::max(worst[1], (found.gradient[i] - truth.gradient[i]).norm() / truth.gradient[i].norm());
  }
  return worst;
}

// Errors that are printed hold over a dense scan, but for so much.
constexpr double more = 1e-3, rounding = 1e-13;

void check_holds(const std::string& name, const Body& body, const std::vector<int>& orders,
                 const std::vector<double>& distances, std::size_t spiral = 1500, std::size_t most_faces = 200) {
  const auto backend = make_cpu_backend();
  Monitor silent;
  const physics::SeriesErrors errors = physics::series_errors(body, orders, distances, *backend, 0, silent);
  const std::vector<Vec3> to = dense_directions(body, spiral, most_faces);
  for (const physics::SeriesError& e : errors.rows) {
    const auto [value, gradient] = scan(body, to, e.distance, e.order);
    INFO(name << ", order " << e.order << " at " << e.distance << ": printed " << e.potential_max << " and "
              << e.acceleration_max << ", scanned " << value << " and " << gradient);
    CHECK(value <= e.potential_max * (1 + more) + rounding);
    CHECK(gradient <= e.acceleration_max * (1 + more) + rounding);
    // Searched, not bounded: no larger than twice what a scan of so many directions sees.
    CHECK(e.potential_max <= 2 * value + rounding);
    CHECK(e.acceleration_max <= 2 * gradient + rounding);
  }
  for (const physics::GoodFrom& good : errors.good_from)
    for (std::size_t t = 0; t < good.distance.size(); ++t) {
      if (!good.distance[t]) continue;
      for (const double d : {*good.distance[t], std::min(1e6, *good.distance[t] * 1.03)}) {
        const auto [value, gradient] = scan(body, to, d, good.order);
        INFO(name << ", order " << good.order << " at " << d << ": " << value << ", " << gradient);
        CHECK(std::max(value, gradient) <= physics::good_tolerances[t] * (1 + more) + rounding);
      }
    }
}

} // namespace

TEST_CASE("no direction of a box, a tetrahedron, a thin plate or a needle has a larger error than is printed",
          "[potential][errors]") {
  check_holds("box", body_of(box(Vec3(1, 2, 3))), {0, 2, 8}, {1, 1.1, 1.5, 3});
  check_holds("tetrahedron", body_of(tetrahedron(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.2, 0.1, 2))),
              {0, 5}, {1, 1.2, 2});
  check_holds("plate", body_of(box(Vec3(1, 1, 0.01))), {3, 10}, {1, 1.05});
  check_holds("needle", body_of(box(Vec3(0.01, 0.02, 1))), {0, 3}, {1, 2});
}

TEST_CASE("no direction of the built-in cow has a larger error than is printed", "[potential][errors]") {
  check_holds("cow", body_of(load_mesh("builtin:cow@0")), {0, 8}, {1, 1.5}, 400, 60);
}

TEST_CASE("no direction of the benchmark cow has a larger error than is printed", "[potential][errors][long]") {
  if (!benchmark_cow()) return skip_without_cow();
  check_holds("benchmark", make_body(*benchmark_cow(), {}, 1), {0, 2, 8}, {1, 1.5}, 300, 60);
}

TEST_CASE("the terms of the degrees add up to the series, at places and over spheres", "[potential][errors]") {
  constexpr int lmax = 20;
  const Multipoles q = random_moments(lmax, 1.5, 3);
  const physics::PotentialTerms terms(q);
  std::vector<Vec3> points = points_outside(7, 1.5, 2, 1);
  const auto backend = make_cpu_backend();
  const PotentialField truth = potential(*backend, {q, lmax, Derivatives::first}, points);
  for (Vec3& p : points) p /= 1.5;
  std::vector<physics::DegreeTerm> found;
  terms.at(points, lmax, found);
  for (std::size_t p = 0; p < points.size(); ++p) {
    physics::DegreeTerm sum;
    for (int l = 0; l <= lmax; ++l) {
      const auto& term = found[std::size_t(l) * physics::PotentialTerms::group + p];
      sum.value += term.value;
      sum.gradient += term.gradient;
    }
    const auto scale = potential_scale({q, lmax}, points[p] * 1.5);
    check_at_most(std::abs(sum.value / 1.5 - truth.value[p]) / scale[0], 2e-14, "value");
    check_at_most((sum.gradient / (1.5 * 1.5) - truth.gradient[p]).norm() / scale[1], 2e-13, "gradient");
  }
}

#include "host/flow.hpp"

#include "host/backend.hpp"
#include "host/error.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/plan/flow_steps.hpp"
#include "host/reference/flow.hpp"
#include "host/spectrum/surface_distance.hpp"
#include "tests/support/compare_flows.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

FlowPoints run(const RawMesh& mesh, std::span<const Vec3> starts, std::span<const Vec3> normals, double time,
               double tolerance = 1e-9, FlowReport* report = nullptr) {
  FlowOptions options;
  options.time = time;
  options.tolerance = tolerance;
  Monitor monitor;
  return make_cpu_backend()->distance_flow(mesh.vertices, mesh.faces)->flow(starts, normals, options, monitor, report);
}

FlowPoints back(const RawMesh& mesh, std::span<const Vec3> starts, double time) {
  FlowOptions options;
  options.time = time;
  options.backward = true;
  Monitor monitor;
  return make_cpu_backend()->distance_flow(mesh.vertices, mesh.faces)->flow(starts, {}, options, monitor);
}

double brute_distance(const RawMesh& mesh, const Vec3& x) {
  return (reference::closest_on_mesh<double>(mesh.vertices, mesh.faces, x) - x).norm();
}

double diagonal(const RawMesh& mesh) {
  Vec3 low = mesh.vertices[0], high = low;
  for (const Vec3& v : mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
  return (high - low).norm();
}

} // namespace

TEST_CASE("off a convex body every flow is a ray for ever, and d is the time", "[flow]") {
  std::mt19937 random(5);
  std::vector<RawMesh> bodies = {box({1, 2, 3}, {-0.5, -1, 2})};
  for (int i = 0; i < 5; ++i) bodies.push_back(convex_polyhedron(random, 20 + 10 * i, 50));
  for (const RawMesh& mesh : bodies) {
    const std::vector<Vec3> all = vertex_normals(mesh.vertices, mesh.faces);
    std::vector<Vec3> starts, normals;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) { // the hull's, not the points inside it
      const bool used = std::any_of(mesh.faces.begin(), mesh.faces.end(), [&](const Face& f) {
        return std::find(f.begin(), f.end(), std::uint32_t(v)) != f.end();
      });
      if (used) starts.push_back(mesh.vertices[v]), normals.push_back(all[v]);
    }
    const std::size_t corners = starts.size();
    for (const Vec3& p : area_samples(mesh.vertices, mesh.faces, 200)) {
      starts.push_back(p);
      normals.push_back(Vec3::Zero());
    }
    const double scale = diagonal(mesh);
    for (const double time : {1e-3 * scale, 0.3 * scale, 100 * scale}) {
      FlowReport report;
      const FlowPoints ends = run(mesh, starts, normals, time, 1e-6, &report);
      CHECK(report.slid == 0);
      CHECK(report.stationary + report.inside + report.unfinished == 0);
      for (std::size_t i = 0; i < starts.size(); ++i) {
        CHECK(std::abs(ends.distances[i] - time) < 1e-13 * (scale + time));
        CHECK(std::abs((ends.positions[i] - starts[i]).norm() - time) < 1e-13 * (scale + time));
        if (i < corners) CHECK((ends.positions[i] - starts[i] - time * normals[i]).norm() < 1e-13 * (scale + time));
      }
      const FlowPoints again = back(mesh, ends.positions, 2 * time);
      for (std::size_t i = 0; i < starts.size(); ++i) {
        CHECK((again.positions[i] - starts[i]).norm() < 1e-13 * (scale + time));
        CHECK(again.flags[i] == flow_surface);
      }
    }
  }
}

TEST_CASE(
    "off balls and ellipsoids of triangles, rays from the vertices along the smooth normals are exact, and distances "
    "and heights are off by the sagitta, of order 2",
    "[flow]") {
  const double time = 0.5;
  const auto rms = [](double sum, std::size_t count) { return std::sqrt(sum / double(count)); };
  for (const Vec3& axes : {Vec3(1, 1, 1), Vec3(1, 1.3, 0.8)}) {
    const bool ball = axes == Vec3(1, 1, 1);
    double before[2] = {};
    for (int level = 2; level <= 5; ++level) {
      const RawMesh mesh = scaled(icosphere(level), axes);
      const auto normal_at = [&](const Vec3& p) { return Vec3(p.cwiseQuotient(axes.cwiseProduct(axes)).normalized()); };
      // The tangent plane of the smooth body holds up the mesh too: its normal is one of the vertex.
      std::vector<Vec3> normals, offset;
      for (const Vec3& v : mesh.vertices) normals.push_back(normal_at(v));
      const FlowPoints rays = run(mesh, mesh.vertices, normals, time);
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        CHECK((rays.positions[v] - mesh.vertices[v] - time * normals[v]).norm() < 1e-14);
      // At a distance of `time` from the smooth body: how far from the mesh?
      const std::vector<Vec3> samples = area_samples(mesh.vertices, mesh.faces, 4000);
      for (const Vec3& x : samples) {
        const Vec3 p = axes.cwiseProduct(x.cwiseQuotient(axes).normalized());
        offset.push_back(p + time * normal_at(p));
      }
      const FlowPoints there = run(mesh, offset, {}, 0);
      // Along facets' normals, off by the first order, the ball is left as far as time says.
      const FlowPoints ends = run(mesh, samples, {}, time);
      double sums[2] = {};
      for (std::size_t i = 0; i < samples.size(); ++i) {
        sums[0] += std::pow(there.distances[i] - time, 2);
        sums[1] += std::pow(ends.positions[i].norm() - 1 - time, 2);
      }
      for (const std::size_t k : {std::size_t(0), std::size_t(1)}) {
        const double error = rms(sums[k], samples.size());
        CAPTURE(axes.transpose(), level, k, error);
        if (level > 2 && (ball || k == 0)) CHECK(std::log2(before[k] / error) == Approx(2).margin(0.2));
        before[k] = error;
      }
    }
    CHECK(before[0] < 2e-3);
  }
}

TEST_CASE(
    "between two balls the flow slides along the mirror plane as far as the closed form says, up to the order of the "
    "sagitta, 2",
    "[flow]") {
  const double a = 1.5, time = 1.2;
  const auto elapsed = [&](double rho) {
    const double s = std::hypot(a, rho);
    return s + a * std::log((s - a) / rho);
  };
  double before = 0, distance_before = 0;
  for (int level = 2; level <= 5; ++level) {
    const RawMesh mesh = two_balls(level, a);
    double error = 0, distance_error = 0, across = 0;
    int count = 0;
    // From the right ball's vertices that face the plane: the ray meets it at rho = a tan(angle).
    std::vector<Vec3> starts, normals;
    for (const Vec3& v : mesh.vertices) {
      const Vec3 n = v - Vec3(a, 0, 0);
      if (v.x() > 0 && n.x() < -0.75 && n.x() > -0.99) starts.push_back(v), normals.push_back(n.normalized());
    }
    const FlowPoints ends = run(mesh, starts, normals, time);
    for (std::size_t i = 0; i < starts.size(); ++i) {
      REQUIRE(ends.flags[i] == flow_slid);
      const double angle = std::acos(-normals[i].x()), rho0 = a * std::tan(angle),
                   left = time - (a / std::cos(angle) - 1);
      double low = rho0, high = rho0 + time;
      for (int k = 0; k < 100; ++k) (elapsed((low + high) / 2) - elapsed(rho0) < left ? low : high) = (low + high) / 2;
      CHECK(std::abs(ends.positions[i].x()) < 1e-12);
      const Vec3 radial = Vec3(0, normals[i].y(), normals[i].z()).normalized();
      // Along the way the facets' turns add up to the sagitta; across it they are a walk at random.
      error += std::pow(ends.positions[i].dot(radial) - low, 2);
      distance_error += std::pow(ends.distances[i] - (std::hypot(a, low) - 1), 2);
      across += (ends.positions[i] - ends.positions[i].dot(radial) * radial).squaredNorm();
      ++count;
    }
    error = std::sqrt(error / count);
    distance_error = std::sqrt(distance_error / count);
    across = std::sqrt(across / count);
    CAPTURE(level, error, distance_error, across);
    if (level > 2) CHECK(std::log2(distance_before / distance_error) == Approx(2).margin(0.2));
    if (level > 3) CHECK(std::log2(before / error) == Approx(2).margin(0.2));
    before = error;
    distance_before = distance_error;
  }
  CHECK(before < 2e-3);
}

TEST_CASE("fixed steps on a sheet between a point and a plane are of order 5", "[flow]") {
  using Long = long double;
  using Vector = reference::Vector<Long>;
  const Vector focus(0, 0, 1);
  // |x - focus| = z: the paraboloid z = (rho^2 + 1) / 2.
  const auto direction = [&](const Vector& x) -> Vector {
    const Vector n[2] = {Vector::UnitZ(), (x - focus).normalized()};
    Long weights[2];
    Vector v;
    plan::least_norm_in_hull<Long>(n, v, weights);
    return v;
  };
  const Vector start(0.5L, 0, 0.625L);
  const auto integrate = [&](int steps) {
    Vector x = start;
    for (int i = 0; i < steps; ++i) x = plan::dormand_prince<Long>(x, 1.0L / steps, direction(x), direction);
    return x;
  };
  const Vector exact = reference::runge_kutta<Long>(start, 1, 8192, Vector::Zero(), [&](const Vector& x) -> Vector {
    return reference::least_in_hull<Long>(std::array{Vector(Vector::UnitZ()), Vector((x - focus).normalized())});
  });
  CHECK(std::abs(double((exact - focus).norm() - exact.z())) < 1e-15);
  double before = 0;
  for (const int steps : {8, 16, 32, 64}) {
    const double error = double((integrate(steps) - exact).norm());
    CAPTURE(steps, error);
    if (steps > 8) CHECK(std::log2(before / error) == Approx(5).margin(0.2));
    before = error;
  }
}

TEST_CASE("the least vector of a hull meets the optimality condition", "[flow]") {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  int inside = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const std::size_t m = 1 + std::size_t(trial) % 8;
    std::vector<Vec3> n;
    std::vector<reference::Vector<long double>> exact;
    const double tilt = trial % 3;
    for (std::size_t i = 0; i < m; ++i) {
      n.push_back((Vec3(normal(random), normal(random), normal(random)) + tilt * Vec3::UnitX()).normalized());
      exact.push_back(n.back().cast<long double>());
    }
    std::vector<double> weights(m);
    Vec3 v;
    const bool off = plan::least_norm_in_hull<double>(n, v, weights);
    const reference::Vector<long double> w = reference::least_in_hull<long double>(exact, 1e-15L);
    CHECK(off == !w.isZero(0));
    if (!off) {
      ++inside;
      CHECK(v.norm() == 0);
      continue;
    }
    CHECK((v - w.cast<double>()).norm() < 1e-9);
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < m; ++i) {
      CHECK(weights[i] >= -1e-9);
      CHECK(n[i].dot(v) >= v.squaredNorm() - 1e-10);
      sum += weights[i] * n[i];
    }
    CHECK((sum - v).norm() < 1e-14);
    CHECK(std::abs(std::accumulate(weights.begin(), weights.end(), 0.0) - 1) < 1e-14);
  }
  CHECK(inside > 100);
}

TEST_CASE("events and small steps with brute force agree to first order of the steps", "[flow]") {
  const RawMesh mesh = two_balls(1, 1.1);
  const std::vector<Vec3> starts = area_samples(mesh.vertices, mesh.faces, 60);
  const double time = 0.8;
  FlowReport report;
  const FlowPoints ends = run(mesh, starts, {}, time, 1e-10, &report);
  CHECK(report.slid > 10);
  const auto normals = [&](std::size_t i) { return Vec3((ends.slide_places[i] - starts[i]).normalized()); };
  std::vector<double> errors;
  for (const int steps : {400, 800, 1600}) {
    double error = 0;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      if (!(ends.flags[i] & flow_slid)) continue;
      const Vec3 end = reference::runge_kutta<double>(starts[i], time, steps, normals(i), [&](const Vec3& x) -> Vec3 {
        return (x - reference::closest_on_mesh<double>(mesh.vertices, mesh.faces, x)).normalized();
      });
      error += (end - ends.positions[i]).norm() / double(report.slid);
    }
    errors.push_back(error);
  }
  CAPTURE(errors[0], errors[1], errors[2]);
  CHECK(errors[2] < errors[0] / 2.5);
  CHECK(errors[2] < 1e-2);
}

TEST_CASE("inside, the flow leads out by the nearest face, and overlapping sheets hold nobody", "[flow]") {
  const RawMesh mesh = together(box({2, 2, 2}), box({2, 2, 2}, {1.5, 0.25, 0.25})); // overlap for x in 1.5 ... 2
  struct Case {
    Vec3 start, end;
    double distance;
  };
  for (const Case& c : {Case{{0.3, 1, 1}, {-0.7, 1, 1}, 0.7}, Case{{1, 1, 0.4}, {1, 1, -0.6}, 0.6},
                        Case{{1.9, 1.2, 2}, {1.9, 1.2, 3}, 0.75}}) {
    const FlowPoints ends = run(mesh, std::span(&c.start, 1), {}, 1);
    CHECK(ends.flags[0] == flow_inside);
    CHECK((ends.positions[0] - c.end).norm() < 1e-12);
    CHECK(ends.distances[0] == Approx(c.distance).margin(1e-12));
    const FlowPoints before = run(mesh, std::span(&c.start, 1), {}, 0.1);
    CHECK(before.flags[0] == flow_inside);
    CHECK(before.distances[0] < 0);
    CHECK((before.positions[0] - c.start - 0.1 * (c.end - c.start)).norm() < 1e-12);
  }
}

TEST_CASE("in a cavity the flow ends at its middle and stays", "[flow]") {
  const RawMesh mesh = together(box({6, 6, 6}), flipped(box({2, 3, 3.5}, {2, 1, 1})));
  for (const Vec3& start : {Vec3(2.3, 1.4, 1.5), Vec3(3.9, 3.5, 4.1), Vec3(2.5, 2.5, 3)}) {
    const FlowPoints ends = run(mesh, std::span(&start, 1), {}, 50);
    CHECK((ends.flags[0] & flow_stationary) != 0);
    CHECK(ends.distances[0] == Approx(1).margin(1e-9));
    CHECK(ends.positions[0].x() == Approx(3).margin(1e-9));
    CHECK(brute_distance(mesh, ends.positions[0]) == Approx(ends.distances[0]).margin(1e-13));
  }
}

TEST_CASE("flows of 0, 1, 7, 13 and 1025 points have the same bits on both paths and any number of threads",
          "[flow][vulkan]") {
  const RawMesh mesh = two_balls(2, 1.3);
  Monitor monitor;
  Paths paths;
  for (const std::size_t n : {0, 1, 7, 13, 1025}) {
    const std::vector<Vec3> starts = area_samples(mesh.vertices, mesh.faces, n);
    FlowOptions options;
    options.time = 1;
    options.streamlines = true;
    const auto one_thread = make_cpu_backend(1)->distance_flow(mesh.vertices, mesh.faces);
    const FlowPoints one = one_thread->flow(starts, {}, options, monitor);
    options.backward = true;
    const FlowPoints one_back = one_thread->flow(one.positions, {}, options, monitor);
    paths.each([&](Backend& backend) {
      const auto flow = backend.distance_flow(mesh.vertices, mesh.faces);
      FlowReport report;
      options.backward = false;
      check_same(flow->flow(starts, {}, options, monitor, &report), one);
      CHECK(report.points == n);
      CHECK(report.unfinished == 0);
      options.backward = true;
      check_same(flow->flow(one.positions, {}, options, monitor), one_back);
    });
    REQUIRE(one.positions.size() == n);
    REQUIRE(one.first.size() == n + 1);
    for (std::size_t i = 0; i < n; ++i) {
      CHECK(one.path[one.first[i]] == starts[i]);
      CHECK(one.path[one.first[i + 1] - 1] == one.positions[i]);
      CHECK(one.path_times[one.first[i]] == 0);
      CHECK(one.path_times[one.first[i + 1] - 1] == Approx(1));
      if (!(one.flags[i] & flow_slid)) CHECK((one_back.positions[i] - starts[i]).norm() < 1e-12);
    }
  }
}

TEST_CASE("starts, times and tolerances out of range are refused, and a wish to stop is heard", "[flow]") {
  const RawMesh mesh = box({1, 1, 1});
  const auto flow = make_cpu_backend()->distance_flow(mesh.vertices, mesh.faces);
  Monitor monitor;
  const std::vector<Vec3> start = {Vec3(2, 2, 2)};
  FlowOptions options;
  for (const double bad : {-1.0, double(NAN), double(INFINITY)}) {
    options.time = bad;
    CHECK_THROWS_AS(flow->flow(start, {}, options, monitor), Error);
  }
  options.time = 1;
  for (const double bad : {0.0, 1.0, double(NAN)}) {
    options.tolerance = bad;
    CHECK_THROWS_AS(flow->flow(start, {}, options, monitor), Error);
  }
  options.tolerance = 1e-6;
  CHECK_THROWS_AS(flow->flow(start, std::vector<Vec3>(2), options, monitor), Error);
  CHECK_THROWS_AS(flow->flow(std::vector<Vec3>{Vec3(NAN, 0, 0)}, {}, options, monitor), Error);
  struct Stop : Monitor {
    bool stopped() const override { return true; }
  } stop;
  try {
    flow->flow(start, {}, options, stop);
    FAIL("it went on");
  } catch (const Error& error) {
    CHECK(error.fault() == Fault::interrupted);
  }
  RawMesh open = mesh;
  open.faces.pop_back();
  CHECK_THROWS_AS(make_cpu_backend()->distance_flow(open.vertices, open.faces)->prepare(), Error);
}

TEST_CASE("over the benchmark tolerances bring what they promise, distances never fall, rays come back",
          "[flow][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const RawMesh& mesh = cow->mesh();
  const auto normals = vertex_normals(mesh.vertices, mesh.faces);
  FlowOptions options;
  options.time = 0.2;
  options.tolerance = 1e-9;
  options.streamlines = true;
  Monitor monitor;
  const auto flow = make_cpu_backend()->distance_flow(mesh.vertices, mesh.faces);
  FlowReport report;
  const FlowPoints ends = flow->flow(mesh.vertices, normals, options, monitor, &report);
  options.streamlines = false;
  options.tolerance = 1e-11;
  const FlowPoints exact = flow->flow(mesh.vertices, normals, options, monitor);
  CHECK(report.unfinished == 0);
  CHECK(report.inside == 19);
  CHECK(report.slid > 2300);
  CHECK(report.stationary >= 5);
  double worst = 0;
  for (std::size_t v = 0; v < ends.positions.size(); ++v)
    worst = std::max(worst, (ends.positions[v] - exact.positions[v]).norm());
  CAPTURE(worst);
  CHECK(worst < 1e-6);

  const auto field = make_cpu_backend()->distance_field(mesh.vertices, mesh.faces);
  const ClosestPoints along = field->closest(ends.path, {.with_sign = false}, monitor);
  for (std::size_t v = 0; v < ends.positions.size(); ++v) {
    if (ends.flags[v] & flow_inside) continue;
    for (std::size_t k = ends.first[v] + 1; k < ends.first[v + 1]; ++k) {
      CHECK(along.distance[k] >= along.distance[k - 1] - 1e-12);
      if (ends.path_times[k] <= ends.slide_times[v] && k > ends.first[v] + 1 && !(ends.flags[v] & flow_slid))
        CHECK(along.distance[k] == Approx(ends.path_times[k]).margin(1e-12));
    }
  }

  options = {};
  options.time = 1;
  options.backward = true;
  const FlowPoints returned = flow->flow(ends.positions, {}, options, monitor);
  std::size_t rays = 0;
  for (std::size_t v = 0; v < ends.positions.size(); ++v) {
    if (ends.flags[v] != 0) continue;
    ++rays;
    CHECK(std::abs(ends.distances[v] - 0.2) < 1e-12);
    CHECK((returned.positions[v] - mesh.vertices[v]).norm() < 1e-6 * diagonal(mesh));
  }
  CHECK(rays > 300);
}

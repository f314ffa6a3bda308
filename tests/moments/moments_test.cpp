// The paths of the stage `moments` against the 80-bit reference: every size, high degrees, the edges of the number range,
// the cut-off, and what is refused.
#include "host/error.hpp"
#include "host/mesh/geometry.hpp"
#include "host/plan/moments.hpp"
#include "host/reference/moments.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <limits>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

Fault fault_of(Backend& backend, const MomentProblem& problem) {
  try {
    moments(backend, problem);
  } catch (const Error& error) {
    return error.fault();
  }
  FAIL("nothing was thrown");
  return {};
}

/// Says stop from the n-th progress on, and counts how many come after that.
class StopAt : public Monitor {
public:
  explicit StopAt(int n) : left_(n) {}
  void progress(const char*, double fraction) override {
    fraction_ = fraction;
    if (left_-- <= 0) ++late_;
  }
  bool stopped() const override { return left_ <= 0; }
  int late() const { return late_; }
  double fraction() const { return fraction_; }

private:
  std::atomic<int> left_;
  int late_ = 0;
  double fraction_ = 0;
};

/// Says stop from the start.
class Stopped : public Monitor {
public:
  bool stopped() const override { return true; }
};

/// Notes what it is told.
class Listener : public Monitor {
public:
  void progress(const char* what, double fraction) override {
    CHECK(std::string(what) == "moments");
    rising = rising && fraction >= last && fraction <= 1;
    last = fraction;
  }
  double last = 0;
  bool rising = true;
};

} // namespace

TEST_CASE("both paths agree with the reference at every size", "[moments][paths]") {
  Paths paths;
  const RawMesh body = torus(27, 19);
  for (const std::size_t stride : {1U, 7U})
    for (const std::size_t count : {0U, 1U, 2U, 7U, 8U, 13U, 15U, 17U, 127U, 1025U})
      for (const int lmax : {0, 1, 2, 3, 4, 5, 7, 8, 31, 100, 257}) {
        if (stride > 1 && (count > 127 || lmax == 257)) continue;
        const RawMesh mesh = some_faces(body, count, stride);
        paths.compare(moment_problem(mesh, lmax), 4e-14);
      }
}

TEST_CASE("both paths agree with the reference on odd bodies", "[moments][paths]") {
  Paths paths;
  std::mt19937 random(3);
  for (const RawMesh& mesh : {two_shells(), shell_with_cavity(), convex_polyhedron(random, 40, 500), icosphere(2)})
    for (const Vec3& origin : {Vec3(0, 0, 0), Vec3(0.3, -0.2, 0.9), Vec3(0, 0, 40)})
      paths.compare(moment_problem(mesh, 90, origin), 2e-13);
}

TEST_CASE("both paths agree with the reference beyond the degree where the columns are scaled", "[moments][paths]") {
  Paths paths;
  const RawMesh body = torus(27, 19);
  for (const int lmax : {1024, 1025, 1300}) {
    const RawMesh sphere = some_faces(icosphere(1), 9, 2), ring = some_faces(body, 9, 31);
    paths.compare(moment_problem(sphere, lmax), 1e-14);
    paths.compare(moment_problem(ring, lmax), 1e-14);
  }
}

TEST_CASE("the largest degree is within the range of doubles", "[moments][paths][long]") {
  Paths paths;
  const RawMesh mesh = some_faces(icosphere(2), 13, 29);
  paths.compare(moment_problem(mesh, largest_degree), 1.6e-14);
}

TEST_CASE("moments of bodies near the z axis die out without harm", "[moments][paths]") {
  Paths paths;
  for (const double width : {1e-2, 1e-10, 1e-50, 1e-140})
    for (const double cut_off : {default_cut_off, 0.0}) {
      const RawMesh needle = scaled(torus(5, 4, 2, 1), {width, width, 1});
      MomentProblem problem = moment_problem(needle, 200);
      problem.cut_off = cut_off;
      paths.compare(problem, 6e-15);
    }
  // On the axis itself the longitude is anything.
  const RawMesh roof = tetrahedron({0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, 1, 0});
  paths.compare(moment_problem(roof, 120), 6e-15);
}

TEST_CASE("faces without area change nothing", "[moments][paths]") {
  Paths paths;
  RawMesh mesh = two_shells();
  const RawMesh before = mesh;
  mesh.faces.push_back({0, 0, 1});
  mesh.faces.push_back({2, 2, 2});
  mesh.faces.insert(mesh.faces.begin(), {{3, 1, 3}, {4, 5, 4}});
  const MomentProblem problem = moment_problem(before, 40), odd = moment_problem(mesh, 40);
  paths.each(
      [&](Backend& backend) { check_close(moments(backend, odd), moments(backend, problem), problem, 1.5e-15); });
}

TEST_CASE("without a cut-off nothing but underflow is left out", "[moments][cut-off]") {
  Paths paths;
  const RawMesh mesh = rotated(torus(20, 9), Eigen::AngleAxisd(0.4, Vec3::UnitX()).toRotationMatrix());
  MomentProblem problem = moment_problem(mesh, 300);
  problem.cut_off = 0;
  paths.compare(problem, 1e-14);
}

// 1e-17 of a bound that compare_by_bound() lets be up to a thousand times the norm.
TEST_CASE("the default cut-off is below rounding", "[moments][cut-off]") {
  Paths paths;
  for (const RawMesh& mesh : {two_shells(), icosphere(3)}) {
    MomentProblem problem = moment_problem(mesh, 300);
    paths.each([&](Backend& backend) {
      problem.cut_off = default_cut_off;
      RunReport with, without;
      const Multipoles cut = moments(backend, problem, &with);
      problem.cut_off = 0;
      check_close(cut, moments(backend, problem, &without), problem, 1e-14);
      CHECK(with.elements <= without.elements);
    });
  }
}

TEST_CASE("a cut-off bounds the error of every moment", "[moments][cut-off]") {
  Paths paths;
  for (const RawMesh& mesh : {two_shells(), icosphere(3), translated(torus(20, 12), {1, 1, 1})}) {
    MomentProblem problem = moment_problem(mesh, 200);
    const auto bound = plan::degree_bound(problem);
    paths.each([&](Backend& backend) {
      problem.cut_off = 0;
      RunReport all;
      const Multipoles full = moments(backend, problem, &all);
      for (const double cut_off : {1e-3, 1e-6, 1e-10}) {
        problem.cut_off = cut_off;
        RunReport some;
        const Multipoles q = moments(backend, problem, &some);
        double worst = 0;
        for (int l = 0; l <= q.lmax; ++l)
          for (int m = 0; m <= l; ++m) worst = std::max(worst, std::abs(q(l, m) - full(l, m)) / bound[std::size_t(l)]);
        check_at_most(worst, cut_off, backend.facts().name);
        CHECK(some.elements <= all.elements);
        CHECK(some.full_elements == all.full_elements);
        // All faces of a ball reach equally far.
        if (mesh.vertices.size() < 300) CHECK(some.elements < 0.7 * all.elements);
      }
    });
  }
}

TEST_CASE("the time and the work of a run are reported", "[moments]") {
  Paths paths;
  const RawMesh mesh = torus(12, 7);
  const MomentProblem problem = moment_problem(mesh, 30);
  paths.each([&](Backend& backend) {
    RunReport report;
    moments(backend, problem, &report);
    CHECK(report.seconds > 0);
    CHECK(report.setup_seconds > 0);
    CHECK(report.setup_seconds < report.seconds);
    CHECK(report.pairs >= mesh.faces.size() / 2);
    CHECK(report.pairs <= mesh.faces.size() / 2 + mesh.faces.size() / 20);
    CHECK(report.full_elements == double(report.pairs) * 31 * 32 / 2);
    CHECK(report.elements > 0);
    const bool native = backend.facts().type == "cpu";
    CHECK(report.kernels.empty() == native);
    for (const KernelTime& kernel : report.kernels) CHECK((kernel.dispatches > 0 && kernel.seconds >= 0));
    const MemoryNeed need = backend.moments_memory(problem);
    CHECK(need.host > 0);
    CHECK((need.device == 0) == native);
  });
}

TEST_CASE("problems out of range are refused", "[moments][errors]") {
  Paths paths;
  const RawMesh mesh = torus(7, 5);
  const MomentProblem good = moment_problem(mesh, 8);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  paths.each([&](Backend& backend) {
    const auto with = [&](auto&& change) {
      MomentProblem problem = good;
      change(problem);
      return fault_of(backend, problem);
    };
    for (const int lmax : {-1, largest_degree + 1, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()})
      CHECK(with([&](MomentProblem& p) { p.lmax = lmax; }) == Fault::bad_argument);
    for (const double radius : {0.0, -1.0, nan, inf, good.reference_radius * (1 - 1e-6), 1e-300})
      CHECK(with([&](MomentProblem& p) { p.reference_radius = radius; }) == Fault::bad_argument);
    for (const double cut_off : {-1e-30, nan, inf, 0.5})
      CHECK(with([&](MomentProblem& p) { p.cut_off = cut_off; }) == Fault::bad_argument);
    CHECK(moments(backend, good).values.size() == 45);
  });
}

TEST_CASE("progress rises to 1", "[moments][monitor]") {
  Paths paths;
  const RawMesh mesh = torus(40, 30);
  const MomentProblem problem = moment_problem(mesh, 120);
  paths.each([&](Backend& backend) {
    Listener listener;
    backend.moments(problem, listener);
    CHECK(listener.rising);
    CHECK(listener.last == Approx(1).margin(0.1));
  });
}

TEST_CASE("work that is told to stop stops, and the device works on", "[moments][monitor]") {
  const RawMesh mesh = torus(80, 60);
  const MomentProblem problem = moment_problem(mesh, 200);
  GpuOptions many_batches;
  many_batches.iteration_budget = 3000;
  const auto cpu = make_cpu_backend();
  const auto gpu = gpu_backend(many_batches);
  for (Backend* backend : {cpu.get(), gpu.get()}) {
    if (!backend) continue;
    INFO(backend->facts().name);
    const Multipoles before = moments(*backend, problem);
    const auto stops = [&](Monitor& monitor) {
      try {
        backend->moments(problem, monitor);
      } catch (const Error& error) {
        return error.fault() == Fault::interrupted;
      }
      return false;
    };
    StopAt third(3);
    CHECK(stops(third));
    CHECK(third.late() <= int(backend->facts().threads));
    CHECK(third.fraction() < 0.5);
    Stopped at_once;
    CHECK(stops(at_once));
    CHECK(same_bits(moments(*backend, problem), before));
  }
  if (gpu) CHECK(gpu->validation_messages() == std::vector<std::string>{});
}

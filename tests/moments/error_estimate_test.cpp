// The estimated error of each degree against the true one, taken in 113 bits from the input's own doubles: thin and hollow
// bodies, far origins, parts far away; and that a wrong path is still caught.
#include "host/geometry/determinant.hpp"
#include "host/io/mesh_source.hpp"
#include "host/mass/verify.hpp"
#include "host/mesh/builtin.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/subdivide.hpp"
#include "host/mesh/tensors.hpp"
#include "host/plan/moments.hpp"
#include "host/reference/moments.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/cpu_with_a_fault.hpp"
#include "tests/support/fields.hpp"
#include "tests/support/mesh_files.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <Eigen/LU>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/float128.hpp>
#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
namespace mp = boost::multiprecision;

namespace {

using Wide = mp::float128;

const Eigen::Matrix3d tilt = Eigen::AngleAxisd(1.1, Vec3(2, -1, 3).normalized()).toRotationMatrix();

RawMesh slab(double thickness) {
  return box({1, 1, thickness}, {-0.5, -0.5, -thickness / 2});
}

RawMesh shell(double thickness) {
  const double inner = 1 - thickness;
  return together(box({2, 2, 2}, {-1, -1, -1}),
                  flipped(box({2 * inner, 2 * inner, 2 * inner}, {-inner, -inner, -inner})));
}

RawMesh hollow_sphere(double thickness) {
  return together(icosphere(1), flipped(icosphere(1, 1 - thickness)));
}

RawMesh random_tetrahedra(int count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in(-1, 1);
  const auto point = [&] { return Vec3(in(random), in(random), in(random)); };
  RawMesh all = tetrahedron(point(), point(), point(), point());
  for (int i = 1; i < count; ++i) all = together(all, tetrahedron(point(), point(), point(), point()));
  return all;
}

struct Case {
  std::string name;
  RawMesh mesh;
  Vec3 origin = Vec3::Zero();
  int lmax = 24;
};

RawMesh octahedron() {
  RawMesh mesh;
  mesh.vertices = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  mesh.faces = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2}, {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
  return mesh;
}

std::vector<Case> cases() {
  const RawMesh thin = slab(1e-12), ball = translated(icosphere(1, 0.5), {1e8, 0, 0});
  std::vector<Case> all = {
      {"slab 1e-3", slab(1e-3), {0, 0, 0}, 48},
      {"slab 1e-6", slab(1e-6)},
      {"slab 1e-12", thin},
      {"slab 1e-9 turned", rotated(slab(1e-9), tilt)},
      {"slab 1e-12 turned", rotated(thin, tilt)},
      {"slab 1e-9, origin 1", slab(1e-9), {0.3, 0.2, 1}},
      {"slab 1e-12, origin 1e3", thin, {0, 0, 1e3}},
      {"slab 1e-12, origin 1e5", thin, {0, 0, 1e5}, 8},
      {"slab 1e-6 turned, origin 10", rotated(slab(1e-6), tilt), {3, -7, 6}},
      {"lens turned", rotated(scaled(icosphere(1), {1, 1, 1e-9}), tilt)},
      {"box", box({1, 2, 3}, {-0.4, -0.9, -1.7}), {0, 0, 0}, 64},
      {"box turned", rotated(box({1, 2, 3}, {-0.4, -0.9, -1.7}), tilt), {0, 0, 0}, 64},
      {"box, origin 10", box({1, 2, 3}), {10, 0, 0}},
      {"box, origin 1e5", box({1, 2, 3}), {1e5, 0, 0}},
      {"box turned, origin 1e5", rotated(box({1, 2, 3}), tilt), {-3e4, 7e4, 5e4}},
      {"shell 2^-10", shell(0x1p-10)},
      {"shell 2^-20", shell(0x1p-20)},
      {"shell 2^-30", shell(0x1p-30)},
      {"shell 2^-40", shell(0x1p-40)},
      {"shell 2^-30 turned", rotated(shell(0x1p-30), tilt)},
      {"hollow sphere 2^-10", hollow_sphere(0x1p-10)},
      {"hollow sphere 2^-40", hollow_sphere(0x1p-40)},
      {"needle 1e-6", box({1, 1e-6, 1e-6}, {-0.5, -5e-7, -5e-7})},
      {"needle 1e-6 turned", rotated(box({1, 1e-6, 1e-6}, {-0.5, -5e-7, -5e-7}), tilt)},
      {"needle along z", box({1e-6, 1e-6, 1}, {-5e-7, -5e-7, -0.5})},
      {"two bodies 1e8 apart", together(box({1, 2, 3}), ball)},
      {"two bodies 1e5 apart", together(box({1, 2, 3}), translated(icosphere(1, 0.5), {0, 1e5, 0}))},
      {"random tetrahedra", random_tetrahedra(40)},
      // Shares of single triangles vanish by their own symmetry: of degree 2 in a regular tetrahedron.
      {"regular tetrahedron", builtin_mesh("tetrahedron"), {0, 0, 0}, 32},
      {"regular tetrahedron of 3", builtin_mesh("tetrahedron:3"), {0, 0, 0}, 8},
      {"regular tetrahedron turned", rotated(builtin_mesh("tetrahedron"), tilt), {0, 0, 0}, 32},
      {"regular tetrahedron cut finer", split_midpoint(split_midpoint(builtin_mesh("tetrahedron"))), {0, 0, 0}, 32},
      {"cube", box({1, 1, 1}, {-0.5, -0.5, -0.5}), {0, 0, 0}, 32},
      {"octahedron", octahedron(), {0, 0, 0}, 16}, // symmetric coordinates of 0 and 1 are luckily exact further up
      {"octahedron turned", rotated(octahedron(), tilt), {0, 0, 0}, 32},
      {"icosahedron", icosphere(0), {0, 0, 0}, 32},
      {"icosahedron turned", rotated(icosphere(0), tilt), {0, 0, 0}, 32},
      {"sphere", icosphere(2)},
      {"sphere, origin 0.9", icosphere(1), {0.9, 0, 0}},
      {"torus", torus(12, 7), {0, 0, 0}, 32},
      {"shell with a cavity", shell_with_cavity()},
  };
  return all;
}

/// s_l of host/moment_terms.hpp for a problem of one triangle, monomial by monomial.
double share_without_cancelling(const MomentProblem& problem, int l) {
  if (l == 0) return 0;
  Eigen::Matrix3d corners;
  for (int k = 0; k < 3; ++k)
    corners.col(k) = (problem.vertices[problem.faces[0][std::size_t(k)]] - problem.origin) / problem.reference_radius;
  double monomials = 0;
  for (int i = 0; i <= l; ++i)
    for (int j = 0; i + j <= l; ++j)
      monomials += std::pow(corners.col(0).norm(), i) * std::pow(corners.col(1).norm(), j) *
                   std::pow(corners.col(2).norm(), l - i - j);
  const double volume = std::abs(corners.determinant()) * std::pow(problem.reference_radius, 3) * problem.density;
  return std::sqrt((2 * l + 1) / (4 * std::numbers::pi)) * volume * monomials / ((l + 1.) * (l + 2.) * (l + 3.));
}

/// Norms over m of each degree's error against the truth.
std::vector<double> true_errors(const Multipoles& q, const std::vector<Wide>& truth) {
  std::vector<double> errors;
  for (int l = 0; l <= q.lmax; ++l) {
    Wide sum = 0;
    for (int m = 0; m <= l; ++m) {
      const std::size_t i = Multipoles::index(q.lmax, l, m);
      const Wide re = Wide(q.values[i].real()) - truth[2 * i], im = Wide(q.values[i].imag()) - truth[2 * i + 1];
      sum += (m == 0 ? 1 : 2) * (re * re + im * im);
    }
    errors.push_back(double(sqrt(sum)));
  }
  return errors;
}

Body body_of(RawMesh mesh, const Vec3& origin, std::vector<Part> parts = {}) {
  return make_body(ClosedSurface::from(std::move(mesh)), {"given", origin}, 1, std::move(parts));
}

struct Checked {
  Multipoles q;
  Accuracy accuracy;
};

/// What `expand` does: moments, both checks, the estimate.
Checked expand(const Body& body, int lmax, Backend& backend, Verify how = Verify::sample, std::uint64_t seed = 1) {
  Monitor monitor;
  const auto problems = mass_problems(body, lmax, default_cut_off);
  std::vector<std::vector<double>> norms;
  Checked result;
  result.q = mass_moments(problems, backend, monitor, nullptr, &norms);
  result.accuracy = verify_all(problems, result.q, norms, backend, how, seed, monitor);
  result.accuracy.agreements.push_back(compare_with_tensors(body, result.q, result.accuracy.estimate.error));
  return result;
}

std::vector<Wide> truth_of(const Body& body, int lmax) {
  std::vector<Wide> sum(2 * Multipoles::count(lmax), Wide(0));
  for (const MomentProblem& problem : mass_problems(body, lmax, 0)) {
    const auto one = reference::moments<Wide>(problem);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += one[i];
  }
  return sum;
}

/// The estimate of no degree lies below the true error, and of none that is known to half of its norm above a thousand times
/// it; an error that is zero by luck counts as an eighth of a unit in the last place.
void check_estimate(const std::string& name, const Checked& found, const std::vector<Wide>& truth) {
  const std::vector<double> errors = true_errors(found.q, truth);
  const ErrorEstimate& estimate = found.accuracy.estimate;
  REQUIRE(estimate.error.size() == errors.size());
  for (std::size_t l = 0; l < errors.size(); ++l) {
    INFO(fmt::format("{}, degree {}: estimated {:.3e}, true {:.3e}, norm {:.3e}", name, l, estimate.error[l], errors[l],
                     estimate.norm[l]));
    CHECK(errors[l] <= estimate.error[l]);
    if (estimate.error[l] < estimate.norm[l] / 2)
      CHECK(estimate.error[l] <= 1000 * std::max(errors[l], 0x1p-56 * estimate.norm[l]));
  }
  INFO(name << ": " << found.accuracy.worst()->path << " against " << found.accuracy.worst()->against << " "
            << found.accuracy.worst()->errors.ratio);
  CHECK(found.accuracy.passed());
}

class Faulty : public CpuWithAFault {
public:
  using Fault = std::function<void(Multipoles&)>;
  explicit Faulty(Fault fault, bool loses_a_triangle = false)
      : fault_(std::move(fault)), loses_a_triangle_(loses_a_triangle) {}

  Multipoles moments(const MomentProblem& problem, Monitor& monitor, RunReport* report) override {
    MomentProblem other = problem;
    if (loses_a_triangle_) other.faces = other.faces.first(other.faces.size() - 1);
    Multipoles q = CpuWithAFault::moments(other, monitor, report);
    fault_(q);
    return q;
  }

private:
  Fault fault_;
  bool loses_a_triangle_;
};

} // namespace

TEST_CASE("the estimated error is at least the true one and at most a thousand times it", "[estimate]") {
  Paths paths;
  for (const Case& c : cases()) {
    const Body body = body_of(c.mesh, c.origin);
    const auto truth = truth_of(body, c.lmax);
    paths.each([&](Backend& backend) {
      check_estimate(c.name + ", " + backend.facts().type, expand(body, c.lmax, backend), truth);
    });
  }
}

TEST_CASE("the estimate holds for parts that are far away or cancel", "[estimate]") {
  Paths paths;
  const auto with_part = [&](const RawMesh& part, double density, const Vec3& origin) {
    std::vector<Part> parts;
    parts.emplace_back(ClosedSurface::from(part), density);
    return body_of(box({1, 2, 3}), origin, std::move(parts));
  };
  const RawMesh ball = icosphere(1, 0.5);
  for (const Body& body : {with_part(translated(ball, {1e8, 0, 0}), 2, {3e7, 0, 0}),
                           with_part(translated(ball, {0, 1e3, 10}), 1, {0, 0, 0}),
                           with_part(box({1, 2, 2.9999}, {0, 0, 5e-5}), -1, {0.5, 1, 1.5}),
                           with_part(translated(ball, {0.5, 1, 1.5}), -1, {0.5, 1, 1e4})}) {
    const auto truth = truth_of(body, 24);
    paths.each([&](Backend& backend) {
      check_estimate(fmt::format("part at {}", body.parts[0].centre_of_mass.norm()), expand(body, 24, backend), truth);
    });
  }
}

TEST_CASE("the estimate from a sample of the triangles holds for all of them", "[estimate]") {
  const auto cpu = make_cpu_backend();
  const RawMesh cow = load_mesh("builtin:cow@1");
  const RawMesh hollow = together(icosphere(3), flipped(scaled(icosphere(3), Vec3::Constant(1 - 0x1p-20))));
  for (const auto& [mesh, origin] : {std::pair(cow, Vec3(0.04, 0.4, 0)), std::pair(torus(27, 19), Vec3(0, 0, 0)),
                                     std::pair(hollow, Vec3(0, 0, 0))}) {
    const Body body = body_of(mesh, origin);
    REQUIRE(mesh.faces.size() > 256); // more than the sample
    const auto problem = mass_problems(body, 40, 0).front();
    std::vector<Wide> truth;
    for (const long double value : reference::moments<long double>(problem)) truth.emplace_back(value);
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U})
      check_estimate(mesh.name, expand(body, 40, *cpu, Verify::sample, seed), truth);
    check_estimate(mesh.name, expand(body, 40, *cpu, Verify::full), truth);
  }
}

TEST_CASE("a wrong path is caught, whatever is wrong with it", "[estimate]") {
  const Body body = body_of(load_mesh("builtin:cow@1"), {0.04, 0.4, 0});
  const auto passes = [&](Faulty::Fault fault, bool loses = false, Verify how = Verify::sample) {
    Faulty backend(std::move(fault), loses);
    Monitor monitor;
    return verify_moments(mass_problems(body, 64, default_cut_off).front(), backend, how, 1, monitor).passed();
  };
  const auto nothing = [](Multipoles&) {};
  CHECK(passes(nothing));
  CHECK(passes(nothing, false, Verify::full));
  CHECK_FALSE(passes(nothing, true)); // one of the sample's triangles
  const auto one = [](int l, int m, double factor) { return [=](Multipoles& q) { q(l, m) *= factor; }; };
  for (const int l : {0, 1, 2, 5, 17, 40, 63, 64})
    for (const int m : {0, l / 2, l}) {
      INFO(l << " " << m);
      // Orders near the degree are small in a lying body.
      CHECK_FALSE(passes(one(l, m, -1)));
      CHECK_FALSE(passes(one(l, m, std::numeric_limits<double>::quiet_NaN())));
    }
  CHECK_FALSE(passes(one(30, 0, 1 + 1e-9)));
  CHECK_FALSE(passes([](Multipoles& q) { // the last degree of a sweep
    for (int m = 0; m <= 64; ++m) q(64, m) = 0;
  }));
  CHECK_FALSE(passes([](Multipoles& q) { // the conjugate
    for (auto& value : q.values) value = std::conj(value);
  }));
  CHECK_FALSE(passes([](Multipoles& q) { // single precision
    for (auto& value : q.values) value = std::complex<double>(std::complex<float>(value));
  }));
  CHECK_FALSE(passes([](Multipoles& q) {
    for (auto& value : q.values) value = std::numeric_limits<double>::infinity();
  }));
}

TEST_CASE("the second recursion is right to the estimate at every size", "[estimate]") {
  Monitor monitor;
  const RawMesh body = torus(27, 19);
  for (const std::size_t count : {0U, 1U, 7U, 8U, 9U, 33U, 257U})
    for (const int lmax : {0, 1, 2, 3, 4, 5, 31, 100}) {
      const RawMesh mesh = some_faces(body, count, 7 % (count + 1) + 1);
      const MomentProblem problem = moment_problem(mesh, lmax);
      const MomentTerms one = moment_terms(problem, 1, monitor), all = moment_terms(problem, 0, monitor);
      CHECK(same_bits(one.sum, all.sum));
      CHECK(one.root == all.root);
      const auto truth = reference::moments<long double>(problem);
      const auto error = compare_by_bound(one.sum, truth, plan::degree_bound(problem));
      check_at_most(error.worst, 4e-14, fmt::format("{} faces, degree {}", count, error.worst_degree));
      // A_l from the triangles one by one.
      if (count == 0 || count > 33 || lmax > 5) continue;
      for (int l = 0; l <= lmax; ++l) {
        double squares = 0;
        for (const Face& face : mesh.faces) {
          MomentProblem single = problem;
          single.faces = {&face, 1};
          squares += std::pow(degree_norm(moments(*make_cpu_backend(1), single), l), 2) +
                     std::pow(share_without_cancelling(single, l) / (8 + l), 2);
        }
        CHECK(one.root[std::size_t(l)] == Approx(std::sqrt(squares)).epsilon(1e-13));
      }
    }
}

TEST_CASE("determinants that cancel keep their digits", "[estimate]") {
  using Exact = mp::cpp_bin_float_100;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> in(-1, 1);
  for (const double off : {1.0, 1e-3, 1e-9, 1e-15, 1e-17})
    for (int i = 0; i < 50; ++i) {
      const auto point = [&] { return Vec3(in(random), in(random), in(random)); };
      const Vec3 a = point(), b = point(), o = point() * 10;
      const Vec3 c = Vec3(0.3 * a + 0.7 * b) * (1 + off * in(random)) + off * point();
      const auto exact = [&](int k, const Vec3& p, const Vec3& q) { return Exact(p[k]) - Exact(q[k]); };
      const Exact det = exact(0, a, o) * (exact(1, b, a) * exact(2, c, a) - exact(2, b, a) * exact(1, c, a)) +
                        exact(1, a, o) * (exact(2, b, a) * exact(0, c, a) - exact(0, b, a) * exact(2, c, a)) +
                        exact(2, a, o) * (exact(0, b, a) * exact(1, c, a) - exact(1, b, a) * exact(0, c, a));
      const Exact error = abs(Exact(determinant(a, b, c, o)) - det);
      CHECK(error <= 0x1p-57 * abs(det) + Exact((a - o).norm() * (b - a).norm() * (c - a).norm()) * 0x1p-110);
    }
}

TEST_CASE("mass, centre of mass and tensors of bodies whose terms cancel are as good as the input", "[estimate]") {
  for (const Case& c : cases()) {
    if (c.mesh.faces.size() > 200) continue;
    INFO(c.name);
    const Body body = body_of(c.mesh, c.origin);
    MomentProblem problem = mass_problems(body, 2, 0).front();
    const auto truth = reference::moments<Wide>(problem);
    const double mass = double(truth[0]) * std::sqrt(4 * std::acos(-1));
    CHECK(body.volume == Approx(mass).epsilon(8e-16));
    // The dipole about the centre is nothing beside what one place of its coordinates is worth.
    problem.origin = body.centre_of_mass;
    problem.reference_radius = brillouin_radius(body.surface, problem.origin);
    const auto about_centre = reference::moments<Wide>(problem);
    const double size = std::max(body.box.longest_side(), body.centre_of_mass.norm());
    Wide dipole = 0;
    for (int m = 0; m <= 1; ++m)
      for (std::size_t part = 0; part < 2; ++part) {
        const Wide value = about_centre[2 * SphereCoefficients::index(2, 1, m) + part];
        dipole += (m == 0 ? 1 : 2) * value * value;
      }
    CHECK(double(sqrt(dipole)) * problem.reference_radius <= 2e-16 * mass * size);
  }
}

TEST_CASE("tensors about a far origin are moved there by the parallel-axis theorem", "[estimate]") {
  const Body body = body_of(slab(1e-12), {0, 0, 1e4});
  const double mass = 1e-12, square = 1e8;
  const Tensors t = tensors(body);
  CHECK(t.quadrupole(2, 2) == Approx(2 * mass * square - mass / 6).epsilon(4e-16));
  CHECK(t.second_moment(0, 0) == Approx(mass / 12).epsilon(4e-16));
  CHECK(t.inertia(2, 2) == Approx(mass / 6).epsilon(1e-8)); // a difference of numbers 1e9 times as large
  // x_i x_j x_k of a box about a corner far away: products of one-dimensional moments.
  const Body cube = body_of(box({1, 1, 1}), {-1000, 0, 0});
  const Tensor3 third = third_moment(cube);
  CHECK(third[0](0, 0) == Approx((std::pow(1001.0, 4) - std::pow(1000.0, 4)) / 4).epsilon(4e-16));
  CHECK(third[0](1, 2) == Approx(1000.5 / 4).epsilon(4e-16));
  CHECK(third[1](1, 2) == Approx(1.0 / 6).epsilon(4e-16));
}

TEST_CASE("the estimate is said in words", "[estimate]") {
  const auto list = [](std::vector<int> degrees) { return degree_list(degrees); };
  CHECK(list({0, 1, 2, 3}) == "0 to 3");
  CHECK(list({4}) == "4");
  CHECK(list({4, 5}) == "4, 5");
  CHECK(list({1, 3, 5, 7, 9, 11}) == "1, 3, 5 ... 11");
  CHECK(list({0, 2, 3, 4, 5, 9}) == "0, 2 to 5, 9");
  CHECK(list({1, 4, 7, 10, 13, 16, 19, 22}) == "1, 4, 7, 10, 13, 16, 2 more to 22");
  const std::vector<std::string> text =
      sentences({{1e-16, 3e-17, 2e-3, 1e-9, 1e-12}, {1, 1e-18, 1, 0.5, 1}, {1, 1.5, 2, 2, 2}});
  REQUIRE(text.size() == 3);
  CHECK(text[0] == "degrees 0, 3, 4 known to 2.0e-09 of their norm or better (worst: 3)");
  CHECK(text[1].find("degree 2 known to no better than 1e-6 of its norm: to 2e-03") == 0);
  CHECK(text[2].find("degree 1 zero within 2e-17 of the bound") == 0);
}

TEST_CASE("sound runs on thin bodies and bodies far apart pass", "[cli][estimate]") {
  const TemporaryFolder folder;
  const RawMesh lens = rotated(scaled(icosphere(2), {1, 1, 1e-9}), tilt);
  const std::vector<std::pair<std::string, RawMesh>> bodies = {
      {"slab9", slab(1e-9)},
      {"slab12", rotated(slab(1e-12), tilt)},
      {"needle", rotated(box({1, 1e-6, 1e-6}), tilt)},
      {"lens", lens},
      {"apart5", together(box({1, 2, 3}), translated(icosphere(1, 0.5), {1e5, 0, 0}))},
      {"apart8", together(box({1, 2, 3}), translated(icosphere(1, 0.5), {1e8, 0, 0}))}};
  for (const auto& [name, mesh] : bodies) {
    const std::string file = folder / (name + ".off");
    write_text(file, off_text(mesh));
    for (const char* command : {"expand", "validate"}) {
      const ProgramRun run = run_program({command, file, "--lmax", "16", "--device", "cpu"});
      INFO(command << " " << name << "\n" << run.out << run.err);
      CHECK(run.exit_code == 0);
    }
  }
}

TEST_CASE("a thin body about a far origin has its mass and its multipoles, and says how well they are known",
          "[cli][estimate]") {
  const TemporaryFolder folder;
  const std::string file = folder / "thin.off";
  write_text(file, off_text(slab(1e-12)));
  const ProgramRun run = run_program({"expand", file, "--origin", "0,0,1e5", "--lmax", "8"});
  INFO(run.out << run.err);
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("+2.820948e-13") && Contains("degrees 0 to 8 known to"));
  const ProgramRun near = run_program({"expand", file, "--origin", "0,0,8", "--lmax", "64", "--json"});
  CHECK(near.exit_code == 0);
  const auto json = nlohmann::json::parse(near.out);
  const auto& estimate = json["accuracy"]["estimate"];
  CHECK(estimate["error"].size() == 65);
  CHECK(estimate["relative"] > 1e-6);
  CHECK_THAT(estimate["sentences"].dump(), Contains("no better than 1e-6"));
  const ProgramRun valid = run_program({"validate", file, "--origin", "0,0,8", "--lmax", "40", "--device", "cpu"});
  INFO(valid.out << valid.err);
  CHECK(valid.exit_code == 0);
  CHECK_THAT(valid.out, Contains("no better than 1e-6") && Contains("about (0, 0, 8) (given)"));
}

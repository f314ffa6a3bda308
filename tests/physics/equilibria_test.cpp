#include "host/physics/equilibria.hpp"

#include "host/error.hpp"
#include "host/mesh/builtin.hpp"
#include "host/physics/equilibrium_bounds.hpp"
#include "host/physics/polyhedron.hpp"
#include "host/physics/zero_velocity.hpp"
#include "tests/support/meshes.hpp"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

using namespace cowgpu;
using namespace cowgpu::physics;
using Catch::Contains;

namespace {

constexpr double pi = std::numbers::pi;

Body body_of(RawMesh mesh, double density = 1, std::vector<Part> parts = {}) {
  return make_body(ClosedSurface::from(std::move(mesh)), {}, density, std::move(parts));
}

Equilibria search(const Body& body, double rate, double smallest = 1e-4, std::uint64_t most = 1'000'000) {
  EquilibriaProblem problem;
  problem.spin = {rate, Vec3::UnitZ(), body.centre_of_mass};
  problem.smallest = smallest;
  problem.most_places = most;
  const auto cpu = make_cpu_backend(0);
  Monitor monitor;
  return equilibria(body, problem, *cpu, monitor);
}

// R_D(x, y, z) = (3/2) integral of du/((u + z) sqrt((u + x)(u + y)(u + z))), u from 0, by duplication (B. C. Carlson, Numerical
// computation of real or complex elliptic integrals, Numer. Algorithms 10 (1995) 13, algorithm of section 2).
long double carlson_rd(long double x, long double y, long double z) {
  long double sum = 0, power = 1;
  for (int i = 0; i < 40; ++i) {
    const long double root = std::sqrt(x * y) + std::sqrt(x * z) + std::sqrt(y * z);
    sum += power / (std::sqrt(z) * (z + root));
    power /= 4;
    x = (x + root) / 4;
    y = (y + root) / 4;
    z = (z + root) / 4;
  }
  const long double mean = (x + y + 3 * z) / 5;
  return 3 * sum + power / (mean * std::sqrt(mean));
}

// Where the pull of an ellipsoid of density 1 on its first axis is that of a turn: w^2 = 2 pi a b c times the integral of
// du/((a^2 + u) sqrt((a^2 + u)(b^2 + u)(c^2 + u))) from u = x^2 - a^2 on (S. Chandrasekhar, Ellipsoidal Figures of Equilibrium, 1969,
// chapter 3).
double equilibrium_on_axis(double a, double b, double c, double rate) {
  const auto excess = [&](double x) {
    const long double l = (long double)x * x - a * a;
    return double(2 * std::numbers::pi_v<long double> * a * b * c * 2 / 3 *
                  carlson_rd(b * b + l, c * c + l, a * a + l)) -
           rate * rate;
  };
  double low = a, high = 100 * a;
  REQUIRE(excess(low) > 0);
  for (int i = 0; i < 100; ++i) {
    const double x = (low + high) / 2;
    (excess(x) > 0 ? low : high) = x;
  }
  return low;
}

// The equilibrium nearest to a place.
const Equilibrium& near(const Equilibria& found, const Vec3& place) {
  REQUIRE_FALSE(found.points.empty());
  return *std::min_element(found.points.begin(), found.points.end(),
                           [&](const auto& a, const auto& b) { return (a.at - place).norm() < (b.at - place).norm(); });
}

// Places where grad V of a box changes most: on its faces, edges and corners, and elsewhere.
Vec3 scattered(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> at(-size, size);
  return {at(random), at(random), at(random)};
}

} // namespace

TEST_CASE("small motions about the triangular points of two masses are those of the textbook", "[equilibria]") {
  // V. Szebehely, Theory of Orbits, 1967, sect. 5.4: s^2 = (-1 +- sqrt(1 - 27 m (1 - m)))/2, and 1 along the axis.
  const auto at = [](double m) {
    Eigen::Matrix3d j = Eigen::Matrix3d::Zero();
    j(0, 0) = 0.75;
    j(1, 1) = 2.25;
    j(0, 1) = j(1, 0) = 0.75 * std::sqrt(3.0) * (1 - 2 * m);
    j(2, 2) = -1;
    return small_motions(j, Vec3::UnitZ(), 1);
  };
  const SmallMotions light = at(0.01), heavy = at(0.1);
  REQUIRE(light.kind == EquilibriumKind::stable);
  REQUIRE(light.frequencies.size() == 3);
  const double root = std::sqrt(1 - 27 * 0.01 * 0.99);
  CHECK(light.frequencies[0] == Approx(std::sqrt((1 - root) / 2)).epsilon(1e-13));
  CHECK(light.frequencies[1] == Approx(std::sqrt((1 + root) / 2)).epsilon(1e-13));
  CHECK(light.frequencies[2] == Approx(1).epsilon(1e-13));
  CHECK(light.index == -1);
  CHECK(light.growth == 0);
  CHECK(heavy.kind == EquilibriumKind::spiral);
  const std::complex<double> s = std::sqrt(std::complex<double>(-0.5, std::sqrt(27 * 0.1 * 0.9 - 1) / 2));
  CHECK(heavy.growth == Approx(std::abs(s.real())).epsilon(1e-13));
  CHECK(heavy.growth_frequency == Approx(std::abs(s.imag())).epsilon(1e-13));
  CHECK(heavy.frequencies.size() == 1);
  CHECK(small_motions(Vec3(-1, 0, 3).asDiagonal(), Vec3::UnitZ(), 1).kind == EquilibriumKind::marginal);
  // Szebehely's collinear points: -1, 1 - c, 1 + 2 c.
  const SmallMotions collinear = small_motions(Vec3(9, -3, -4).asDiagonal(), Vec3::UnitZ(), 1);
  CHECK(collinear.kind == EquilibriumKind::saddle);
  CHECK(collinear.growth == Approx(std::sqrt(1 + std::sqrt(28.0))).epsilon(1e-13)); // q^2 - 2 q - 27 = 0
  CHECK(collinear.index == 1);
}

TEST_CASE("the eigenvalues of small motions are those of the six linear equations, about any axis", "[equilibria]") {
  std::mt19937 random(7);
  for (int k = 0; k < 50; ++k) {
    const Eigen::Matrix3d any =
        (Eigen::Matrix3d() << scattered(random, 1), scattered(random, 1), scattered(random, 1)).finished();
    const Eigen::Matrix3d j = any + any.transpose();
    const Vec3 axis = scattered(random, 1).normalized();
    const double rate = 0.7;
    Eigen::Matrix<double, 6, 6> equations = Eigen::Matrix<double, 6, 6>::Zero();
    equations.topRightCorner<3, 3>().setIdentity();
    equations.bottomLeftCorner<3, 3>() = j;
    equations.bottomRightCorner<3, 3>() << 0, axis[2], -axis[1], -axis[2], 0, axis[0], axis[1], -axis[0], 0;
    equations.bottomRightCorner<3, 3>() *= 2 * rate;
    const Eigen::Matrix<std::complex<double>, 6, 1> all = equations.eigenvalues();
    double growth = 0;
    for (int i = 0; i < 6; ++i) growth = std::max(growth, all[i].real());
    const SmallMotions found = small_motions(j, axis, rate);
    CHECK(std::abs(found.growth - growth) < 1e-6); // two that meet are known to a root of rounding
    for (const auto& q : found.squares) {
      double nearest = 1;
      for (int i = 0; i < 6; ++i) nearest = std::min(nearest, std::abs(all[i] * all[i] - q));
      CHECK(nearest < 1e-6);
    }
  }
}

TEST_CASE("no field changes faster than its bounds, and a box's comes near them", "[equilibria]") {
  const Polyhedron box_body(test::box(Vec3(1, 2, 3)).vertices, test::box(Vec3(1, 2, 3)).faces);
  const Vec3 low(0, 0, 0), high(1, 2, 3);
  const GravityBounds bounds(1, 6, low, high);
  std::mt19937 random(3);
  double change = 0, remainder = 0, gradient = 0;
  for (int k = 0; k < 600; ++k) {
    Vec3 x = Vec3(0.5, 1, 1.5) + scattered(random, 2);
    // A third of the places lie on faces, where it changes most.
    if (k % 3 == 0) x[k % 2] = k % 2 ? 2 : 1;
    const double h = std::pow(10, -2 * std::uniform_real_distribution<double>(0, 1)(random));
    const Vec3 d = h * scattered(random, 1).normalized();
    const double reach = ((x - Vec3(0.5, 1, 1.5)).cwiseAbs() + Vec3(0.5, 1, 1.5)).norm();
    const PolyhedronAt here = box_body.at(x), there = box_body.at(Vec3(x + d));
    const Vec3 by = (there.gradient - here.gradient).cast<double>();
    const double changed = (by + 2 * pi / 3 * d).norm();
    CHECK(changed <= bounds.change(reach, h));
    change = std::max(change, changed / bounds.change(reach, h));
    const Vec3 past = x.cwiseMax(low).cwiseMin(high) - x;
    const bool outside = past.norm() > 0;
    const double depth = outside ? past.norm() : (x - low).cwiseMin(high - x).minCoeff();
    if (!(depth > h)) continue;
    const Eigen::Matrix3d tensor = here.hessian.cast<double>();
    const double left = (by - tensor * d).norm();
    CHECK(left <= bounds.remainder(x, depth, outside, h));
    remainder = std::max(remainder, left / bounds.remainder(x, depth, outside, h));
    const double turned =
        (there.hessian.cast<double>() - tensor).selfadjointView<Eigen::Lower>().eigenvalues().cwiseAbs().maxCoeff();
    CHECK(turned <= bounds.gradient_change(x, depth, outside, h));
    gradient = std::max(gradient, turned / bounds.gradient_change(x, depth, outside, h));
  }
  CHECK(change > 0.05);
  CHECK(remainder > 0.05);
  CHECK(gradient > 0.05);
  const Vec3 middle(0.5, 1, 1.5);
  const double h = bounds.injective_within(middle, 0.5, false, 2);
  CHECK(bounds.gradient_change(middle, 0.5, false, h * (1 - 1e-9)) < 2);
  CHECK(bounds.gradient_change(middle, 0.5, false, h * (1 + 1e-9)) > 2);
}

TEST_CASE("the least of a linear field over a box is never above the truth, and mostly half of it", "[equilibria]") {
  std::mt19937 random(11);
  double sum = 0, truth = 0;
  for (int k = 0; k < 100; ++k) {
    const Eigen::Matrix3d any =
        (Eigen::Matrix3d() << scattered(random, 1), scattered(random, 1), scattered(random, 1)).finished();
    const Eigen::Matrix3d j = any + any.transpose();
    const Vec3 a = scattered(random, 3), half(0.3, 0.6, 0.5);
    const double bound = least_over_box(a, j, half);
    double least = 1e300;
    for (int z = -8; z <= 8; ++z)
      for (int y = -8; y <= 8; ++y)
        for (int x = -8; x <= 8; ++x) least = std::min(least, (a + j * half.cwiseProduct(Vec3(x, y, z) / 8)).norm());
    CHECK(bound <= least * (1 + 1e-12));
    sum += bound;
    truth += least;
  }
  CHECK(sum > 0.5 * truth);
}

TEST_CASE("an ellipsoid has its centre and four equilibria on its axes, at the places of the closed form",
          "[equilibria]") {
  const double a = 2, b = 1.4, c = 1, rate = 0.9;
  const Vec3 on_long(equilibrium_on_axis(a, b, c, rate), 0, 0), on_short(0, equilibrium_on_axis(b, a, c, rate), 0);
  std::array<double, 2> off_long{}, off_short{};
  for (const int level : {1, 2}) {
    const Equilibria found =
        search(body_of(builtin_mesh(level == 1 ? "ellipsoid:2,1.4,1@1" : "ellipsoid:2,1.4,1@2")), rate);
    REQUIRE(found.points.size() == 5);
    CHECK(found.complete());
    CHECK(found.index_sum == -1);
    CHECK(found.undecided_cells == 0);
    for (const Equilibrium& e : found.points) {
      CHECK(e.residual < 1e-13);
      CHECK(e.alone_within > 0);
    }
    // Its facets are symmetric about the three planes.
    CHECK(near(found, Vec3::Zero()).at.norm() < 1e-13);
    CHECK(near(found, Vec3::Zero()).inside);
    CHECK(near(found, Vec3::Zero()).motions.kind == EquilibriumKind::stable);
    for (const Vec3& place : {on_long, on_short}) {
      const Equilibrium &one = near(found, place), &other = near(found, -place);
      CHECK((one.at + other.at).norm() < 1e-12);
      CHECK(one.jacobi == Approx(other.jacobi).epsilon(1e-13));
      CHECK_FALSE(one.inside);
      CHECK(one.at[2] == Approx(0).margin(1e-13));
    }
    CHECK(near(found, on_long).motions.index == 1);
    CHECK(near(found, on_long).motions.kind == EquilibriumKind::saddle);
    CHECK(near(found, on_short).motions.index == -1);
    off_long[std::size_t(level - 1)] = near(found, on_long).at[0] - on_long[0];
    off_short[std::size_t(level - 1)] = near(found, on_short).at[1] - on_short[1];
  }
  // Facets are right to the second order of their sizes.
  CHECK(off_long[0] / off_long[1] == Approx(4).margin(0.8));
  CHECK(off_short[0] / off_short[1] == Approx(4).margin(0.8));
  CHECK(std::abs((4 * off_long[1] - off_long[0]) / 3) < 4e-3);
  CHECK(std::abs((4 * off_short[1] - off_short[0]) / 3) < 4e-3);
}

TEST_CASE("a ball has a ring of equilibria, which is told and not listed as all of them", "[equilibria]") {
  const Body ball = body_of(builtin_mesh("sphere:1@1"));
  const Equilibria found = search(ball, 0.8, 0.03, 60'000);
  CHECK_FALSE(found.complete());
  CHECK(found.undecided_cells > 100);
  REQUIRE_FALSE(found.undecided.empty());
  CHECK(found.undecided.front().ring);
  const double radius = synchronous_radius(ball, 1, {0.8, Vec3::UnitZ(), Vec3::Zero()});
  CHECK(radius == Approx(std::cbrt(ball.mass() / 0.64)).epsilon(1e-15));
  CHECK(found.undecided.front().radius == Approx(radius).epsilon(0.2));
}

TEST_CASE("two balls on a circular orbit have the five points of Lagrange and a centre each", "[equilibria]") {
  // Outside of balls of facets the field is that of points up to the facets' icosahedral degree 6.
  RawMesh second = builtin_mesh("sphere:0.5@2");
  for (Vec3& v : second.vertices) v[0] += 3;
  std::vector<Part> parts;
  parts.emplace_back(ClosedSurface::from(std::move(second)), 1);
  const Body pair = body_of(builtin_mesh("sphere:1@2"), 1, std::move(parts));
  const double m = pair.parts[0].mass() / pair.mass();
  const double rate = std::sqrt(pair.mass() / 27);
  const Equilibria found = search(pair, rate);
  REQUIRE(found.points.size() == 7);
  CHECK(found.complete());
  CHECK(std::count_if(found.points.begin(), found.points.end(), [](const auto& e) { return e.inside; }) == 2);
  // In units of the distance, from the common centre: Euler's quintic by bisection.
  const auto pull = [&](double x) {
    const double from_large = x + m, from_small = x - 1 + m;
    return x - (1 - m) * from_large / std::pow(std::abs(from_large), 3) -
           m * from_small / std::pow(std::abs(from_small), 3);
  };
  const auto root = [&](double low, double high) {
    const bool rises = pull(high) > 0;
    for (int i = 0; i < 100; ++i) {
      const double x = (low + high) / 2;
      ((pull(x) < 0) == rises ? low : high) = x;
    }
    return low;
  };
  const Vec3 centre = pair.centre_of_mass;
  CHECK(centre[0] == Approx(3 * m).epsilon(1e-12));
  for (const double x : {root(-m + 1e-3, 1 - m - 1e-3), root(1 - m + 1e-3, 2), root(-2, -m - 1e-3)}) {
    const Vec3 place = centre + Vec3(3 * x, 0, 0);
    const Equilibrium& e = near(found, place);
    INFO(place.transpose() << " found " << e.at.transpose());
    CHECK((e.at - place).norm() < 1e-5);
    CHECK(e.motions.kind == EquilibriumKind::saddle);
  }
  for (const double side : {1, -1}) {
    const Vec3 place = centre + 3 * Vec3(0.5 - m, side * std::sqrt(0.75), 0);
    const Equilibrium& e = near(found, place);
    CHECK((e.at - place).norm() < 1e-5);
    CHECK(e.motions.index == -1);
  }
}

TEST_CASE("bodies that hold nothing, and requests of nonsense, are refused", "[equilibria]") {
  const Body cube = body_of(test::box(Vec3::Ones()));
  CHECK_THROWS_WITH(search(cube, -1), Contains("rate"));
  CHECK_THROWS_WITH(search(cube, 1, 1), Contains("1e-8 to 0.1"));
  CHECK_THROWS_WITH(search(cube, 1, 1e-3, 10), Contains("1000"));
  CHECK_THROWS_WITH(search(body_of(test::box(Vec3::Ones()), -1), 1), Contains("holds nothing"));
  std::vector<Part> hole;
  hole.emplace_back(ClosedSurface::from(test::box(Vec3::Constant(0.4), Vec3::Constant(0.3))), -2);
  CHECK_THROWS_WITH(search(body_of(test::box(Vec3::Ones()), 1, std::move(hole)), 1), Contains("dig"));
}

TEST_CASE("the zero-velocity surface of a body that does not turn is its equipotential: of a ball, a sphere",
          "[equilibria]") {
  const Body ball = body_of(builtin_mesh("sphere:1@2"));
  ZeroVelocityProblem problem;
  problem.jacobi = -ball.mass() / 1.6;
  problem.extent = 2;
  const auto cpu = make_cpu_backend(0);
  Monitor monitor;
  std::array<double, 2> off{};
  for (const int k : {0, 1}) {
    problem.cells = k ? 16 : 8;
    const TriangleSurface surface = zero_velocity_surface(ball, problem, *cpu, monitor);
    REQUIRE(surface.faces.size() > 100);
    check(surface);
    const Polyhedron exact(ball.surface.vertices(), ball.surface.faces());
    for (std::size_t v = 0; v < surface.vertices.size(); v += 7) {
      CHECK(double(-exact.at(surface.vertices[v]).value) == Approx(problem.jacobi).epsilon(1e-11));
      CHECK(surface.normals[v].dot(surface.vertices[v]) < 0); // towards the body, where it may be
    }
    // Counter-clockwise seen from within.
    off[std::size_t(k)] = volume(surface.vertices, surface.faces) + 4 * pi / 3 * std::pow(1.6, 3);
  }
  CHECK(off[0] / off[1] == Approx(4).margin(1));
  problem.jacobi = 1;
  CHECK(zero_velocity_surface(ball, problem, *cpu, monitor).faces.empty());
  problem.cells = 2;
  CHECK_THROWS_WITH(zero_velocity_surface(ball, problem, *cpu, monitor), Contains("4 to 512"));
}

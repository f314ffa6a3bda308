#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/mass/verify.hpp"
#include "host/mesh/body.hpp"
#include "host/mesh/tensors.hpp"
#include "host/spectrum/rotation.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace cowgpu;
using Catch::Contains;

namespace {

constexpr double pi = std::numbers::pi;

ClosedSurface mesh(const std::string& name, const Placement& placement = {}) {
  RawMesh raw = load_mesh(name);
  place(raw, placement);
  return ClosedSurface::from(std::move(raw));
}

ClosedSurface moved(const std::string& name, const Vec3& by) {
  RawMesh raw = load_mesh(name);
  for (Vec3& v : raw.vertices) v += by;
  return ClosedSurface::from(std::move(raw));
}

Multipoles moments(const Body& body, int lmax) {
  Monitor monitor;
  return mass_moments(mass_problems(body, lmax, default_cut_off), *make_cpu_backend(1), monitor);
}

// Largest difference of a degree over its norm.
double distance(const Multipoles& a, const Multipoles& b) {
  double worst = 0;
  for (int l = 0; l <= a.lmax; ++l) {
    Multipoles difference = a;
    for (std::size_t i = 0; i < a.values.size(); ++i) difference.values[i] -= b.values[i];
    worst = std::max(worst, degree_norm(difference, l) / std::abs(a(0, 0)));
  }
  return worst;
}

Eigen::Matrix3d turn(double alpha, double beta, double gamma) {
  return rotation_matrix({alpha, beta, gamma});
}

} // namespace

TEST_CASE("parts add: mass, centre, tensors and moments of two boxes side by side are those of the box of both",
          "[body]") {
  // [-1/2, 1/2] x ... and, beside it along x, [1/2, 3/2].
  const OriginChoice origin{"given", Vec3(0.25, -0.5, 0.125)};
  std::vector<Part> parts;
  parts.emplace_back(moved("builtin:box:1,1,1", {1, 0, 0}), 3);
  const Body two = make_body(mesh("builtin:box:1,1,1"), origin, 3, std::move(parts));
  const Body one = make_body(moved("builtin:box:2,1,1", {0.5, 0, 0}), origin, 3);
  CHECK(two.mass() == 6);
  CHECK((two.centre_of_mass - one.centre_of_mass).norm() < 1e-15);
  CHECK(two.brillouin_radius == one.brillouin_radius);
  CHECK((two.box.max - one.box.max).norm() == 0);
  CHECK((tensors(two).inertia - tensors(one).inertia).norm() < 1e-15 * tensors(one).inertia.norm());
  CHECK(distance(moments(two, 40), moments(one, 40)) < 1e-15);
}

TEST_CASE("a part of negative density digs a hole: a cube in a cube is the mesh with the cavity", "[body]") {
  std::vector<Part> parts;
  parts.emplace_back(moved("builtin:box:1,1,1", {0.25, 0, 0}), -1000);
  const Body dug = make_body(mesh("builtin:box:3,3,3"), {}, 1000, std::move(parts));
  RawMesh raw = load_mesh("builtin:box:3,3,3");
  const RawMesh inner = load_mesh("builtin:box:1,1,1");
  const auto first = std::uint32_t(raw.vertices.size());
  for (const Vec3& v : inner.vertices) raw.vertices.push_back(v + Vec3(0.25, 0, 0));
  for (const Face& f : inner.faces) raw.faces.push_back({first + f[0], first + f[2], first + f[1]});
  const Body cavity = make_body(ClosedSurface::from(std::move(raw)), {}, 1000);
  CHECK(dug.mass() == 26000);
  CHECK(cavity.mass() == Approx(26000).epsilon(1e-15));
  CHECK((dug.centre_of_mass - cavity.centre_of_mass).norm() < 1e-15);
  CHECK(distance(moments(dug, 30), moments(cavity, 30)) < 1e-15);
  Monitor monitor;
  const auto cpu = make_cpu_backend(1);
  const auto problems = mass_problems(dug, 4, default_cut_off);
  std::vector<std::vector<double>> norms;
  const Multipoles q = mass_moments(problems, *cpu, monitor, nullptr, &norms);
  const Accuracy accuracy = verify_all(problems, q, norms, *cpu, Verify::full, 1, monitor);
  CHECK(accuracy.passed());
  CHECK(compare_with_tensors(dug, q, accuracy.estimate.error).errors.ratio < 1);
}

TEST_CASE("parts that cancel have no centre of mass, and need an origin", "[body]") {
  const auto both = [](const OriginChoice& origin) {
    std::vector<Part> parts;
    parts.emplace_back(moved("builtin:box:1,1,1", {2, 0, 0}), -1);
    return make_body(mesh("builtin:box:1,1,1"), origin, 1, std::move(parts));
  };
  CHECK_THROWS_WITH(both({}), Contains("--origin"));
  const Body dipole = both({"mesh", Vec3::Zero()});
  CHECK_FALSE(dipole.centre_of_mass.allFinite());
  const Multipoles q = moments(dipole, 1);
  CHECK(std::abs(q(0, 0)) < 1e-16);
  // Q_11 = -sqrt(3 / 8 pi) (p_x + i p_y), p = -2.
  CHECK(q(1, 1).real() * q.reference_radius == Approx(2 * std::sqrt(3 / (8 * pi))).epsilon(1e-14));
}

TEST_CASE("metres: moments scale by L^(3 + l), tensors by L^5, the rest with them", "[body]") {
  const Placement unit{{0.3048, 1, true}, Eigen::Matrix3d::Identity()};
  const Body feet = make_body(mesh("builtin:cow@1"), {}, 1000),
             metres = make_body(mesh("builtin:cow@1", unit), {}, 1000);
  const double l3 = std::pow(0.3048, 3), l5 = std::pow(0.3048, 5);
  CHECK(metres.mass() == Approx(feet.mass() * l3).epsilon(1e-14));
  CHECK(metres.brillouin_radius == Approx(feet.brillouin_radius * 0.3048).epsilon(1e-14));
  CHECK((tensors(metres).inertia - l5 * tensors(feet).inertia).norm() < 1e-14 * tensors(metres).inertia.norm());
  Multipoles scaled = moments(feet, 20);
  for (auto& q : scaled.values) q *= l3;
  CHECK(distance(moments(metres, 20), scaled) < 1e-14);
}

TEST_CASE("a body that is turned has moments that are turned by Wigner's matrices", "[body]") {
  const double a = 0.3, b = 1.1, c = -2.5;
  const Placement turned{{}, turn(a, b, c)};
  const OriginChoice origin{"mesh", Vec3::Zero()};
  const Multipoles q = moments(make_body(mesh("builtin:cow@1"), origin, 1), 24);
  const Multipoles direct = moments(make_body(mesh("builtin:cow@1", turned), origin, 1), 24);
  SphereCoefficients fields(24, 1);
  for (int l = 0; l <= 24; ++l)
    for (int m = 0; m <= l; ++m) fields.at(0, l, m) = q(l, m);
  Monitor monitor;
  // Not conjugated, Q_lm is what conj a_lm of a density on the sphere is.
  for (auto& v : fields.values) v = std::conj(v);
  const SphereCoefficients wigner = rotate(fields, {a, b, c}, monitor);
  Multipoles turned_q = direct;
  for (int l = 0; l <= 24; ++l)
    for (int m = 0; m <= l; ++m) turned_q(l, m) = std::conj(wigner.at(0, l, m));
  CHECK(distance(direct, turned_q) < 2e-14);
}

TEST_CASE("axes are named anew without rounding", "[body]") {
  const Eigen::Matrix3d r = axes_rotation("x,-z,y");
  CHECK((r * Vec3(1, 2, 3) - Vec3(1, -3, 2)).norm() == 0);
  RawMesh mesh = load_mesh("builtin:cow@1");
  const std::vector<Vec3> before = mesh.vertices;
  place(mesh, {{}, r});
  bool same = true;
  for (std::size_t i = 0; i < before.size(); ++i)
    same = same && mesh.vertices[i] == Vec3(before[i].x(), -before[i].z(), before[i].y());
  CHECK(same);
  CHECK_THROWS_WITH(axes_rotation("x,z,y"), Contains("mirror image"));
  CHECK_THROWS_WITH(axes_rotation("x,x,y"), Contains("twice"));
  for (const char* text : {"", "x", "x,y", "x,y,z,x", "x,y,w", "x,y,", "x, y, z", "X,Y,Z"}) {
    INFO(text);
    CHECK_THROWS_AS(axes_rotation(text), Error);
  }
}

TEST_CASE("the mass and the centre of parts that cancel are those of what is left of them", "[body]") {
  // A slab of the thickness z - thinner between two boxes of one corner.
  const double x = 0.1, y = 0.7, z = 1.3, thinner = z * (1 - 0x1p-30);
  RawMesh outer = test::box({x, y, z}), inner = test::box({x, y, thinner});
  std::vector<Part> parts;
  parts.emplace_back(ClosedSurface::from(inner), -3);
  const Body body = make_body(ClosedSurface::from(outer), {}, 3, std::move(parts));
  const long double mass = 3 * (long double)(x)*y * ((long double)(z)-thinner);
  CHECK(std::abs(body.mass() / mass - 1) < 4e-16L);
  const Vec3 middle(x / 2, y / 2, (z + thinner) / 2);
  CHECK((body.centre_of_mass - middle).norm() < 4e-16);
}

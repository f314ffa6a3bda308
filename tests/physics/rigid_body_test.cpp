#include "host/backend.hpp"
#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/mass/mass_moments.hpp"
#include "host/mesh/tensors.hpp"
#include "host/physics/rigid_body.hpp"
#include "host/spectrum/convert.hpp"
#include "tests/support/meshes.hpp"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <stdexcept>

using namespace cowgpu;
using namespace cowgpu::physics;
using namespace cowgpu::test;

namespace {

Body body_of(RawMesh mesh, const OriginChoice& origin = {}, double density = 1) {
  return make_body(ClosedSurface::from(std::move(mesh)), origin, density);
}

CoefficientSet multipoles(const Body& body, int lmax) {
  Monitor monitor;
  const Multipoles q = mass_moments(mass_problems(body, lmax, 0), *make_cpu_backend(1), monitor);
  CoefficientSet set(lmax, 1);
  set.kind = CoefficientKind::multipoles;
  set.form = Form::complex;
  set.reference_radius = q.reference_radius;
  for (int l = 0; l <= lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      set.first[set.index(0, l, m)] = q(l, m).real();
      set.second[set.index(0, l, m)] = q(l, m).imag();
    }
  return set;
}

double difference(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return (a - b).norm() / b.norm();
}

template <class Call>
Fault fault_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.fault();
  }
  throw std::runtime_error("nothing was thrown");
}

} // namespace

TEST_CASE("a box has the tensors of the textbook, and its edges for principal axes", "[tensors]") {
  const RigidBody box = rigid_body(body_of(test::box(Vec3(1, 2, 3), Vec3(5, -7, 11)), {}, 2));
  CHECK(box.mass == 12);
  CHECK(box.first_moment.norm() < 1e-14);
  CHECK((box.inertia().diagonal() - Vec3(13, 10, 5)).norm() < 1e-13);
  CHECK((box.quadrupole.diagonal() - Vec3(-11, -2, 13)).norm() < 1e-13);
  CHECK((box.second_moment().diagonal() - Vec3(1, 4, 9)).norm() < 1e-13);
  const PrincipalAxes principal = principal_axes(box);
  CHECK((*principal.moments - Vec3(5, 10, 13)).norm() < 1e-13);
  Eigen::Matrix3d axes; // z, y, and z cross y
  axes << 0, 0, -1, 0, 1, 0, 1, 0, 0;
  CHECK((principal.axes - axes).norm() < 1e-14);
  CHECK_FALSE(principal.first_two_alike);
  CHECK_FALSE(principal.last_two_alike);
}

TEST_CASE("an ellipsoid's inertia is m/5 (b^2 + c^2), which its tessellations approach by a factor of four a level",
          "[tensors]") {
  const auto error = [](const char* name) {
    const RigidBody e = rigid_body(body_of(load_mesh(name)));
    const double mass = 4.0 / 3 * 3.14159265358979323846 * 1 * 2 * 3;
    return difference(e.inertia(), mass / 5 * Vec3(13, 10, 5).asDiagonal().toDenseMatrix());
  };
  const double coarse = error("builtin:ellipsoid:1,2,3@4"), fine = error("builtin:ellipsoid:1,2,3@5");
  CHECK(coarse < 0.01);
  CHECK(coarse / fine == Approx(4).epsilon(0.02));
}

TEST_CASE("coefficients of degree 0 to 2 and the trace hold the tensors of the mesh", "[tensors]") {
  for (const Vec3& at : {Vec3(0, 0, 0), Vec3(0.3, -0.2, 0.1)}) {
    const Body body = body_of(load_mesh("builtin:cow@2"), {"given", at}, 3);
    const RigidBody mesh = rigid_body(body);
    CoefficientSet set = multipoles(body, 3);
    set.second_moment = *mesh.trace;
    ConversionTarget geodesy;
    geodesy.kind = CoefficientKind::potential;
    geodesy.form = Form::real;
    geodesy.normalisation = Normalisation::four_pi;
    geodesy.phase = Phase::none;
    geodesy.reference_radius = 7;
    for (const CoefficientSet& stored : {set, converted(set, geodesy)}) {
      const RigidBody read = rigid_body(stored);
      CHECK(read.mass == Approx(mesh.mass).epsilon(1e-14));
      CHECK((read.first_moment - mesh.first_moment).norm() < 1e-14 * mesh.mass * mesh.radius);
      CHECK(difference(read.quadrupole, mesh.quadrupole) < 1e-13);
      CHECK(difference(read.inertia(), mesh.inertia()) < 1e-13);
      const auto q = spherical_quadrupole(read.quadrupole);
      for (int m = 0; m <= 2; ++m) {
        const auto i = set.index(0, 2, m);
        const double r2 = *set.reference_radius * *set.reference_radius;
        CHECK(std::abs(q[std::size_t(m)] - r2 * std::complex(set.first[i], set.second[i])) <
              1e-13 * mesh.quadrupole.norm());
      }
    }
  }
}

TEST_CASE("what has no inertia or is of no mass is refused by name", "[tensors]") {
  const CoefficientSet set = multipoles(body_of(test::box(Vec3(1, 2, 3))), 2);
  CHECK_THROWS_WITH(rigid_body(set).inertia(), Catch::Contains("second moment"));
  CHECK(fault_of([&] { rigid_body(set).second_moment(); }) == Fault::file_format);
  CoefficientSet surface = set;
  surface.kind = CoefficientKind::field;
  CHECK(fault_of([&] { rigid_body(surface); }) == Fault::file_format);
  ConversionTarget target;
  target.lmax = 1;
  CHECK(fault_of([&] { rigid_body(converted(set, target)); }) == Fault::file_format);
  RigidBody nothing;
  nothing.radius = 1;
  CHECK(fault_of([&] { about_centre(nothing); }) == Fault::bad_argument);
}

TEST_CASE("tensors about another point are brought to the centre of mass by Steiner's theorem", "[tensors]") {
  const RigidBody own = rigid_body(body_of(load_mesh("builtin:cow@2")));
  const RigidBody there = rigid_body(body_of(load_mesh("builtin:cow@2"), {"given", Vec3(0.5, 1, -0.25)}));
  const RigidBody moved = about_centre(there);
  CHECK((*moved.origin - *own.origin).norm() < 1e-14);
  CHECK(moved.first_moment.norm() == 0);
  CHECK(difference(moved.inertia(), own.inertia()) < 4e-14);
  CHECK((moved.quadrupole - own.quadrupole).norm() < 4e-14 * there.quadrupole.norm());
  CHECK((there.inertia() - own.inertia()).norm() > own.inertia().norm());
}

TEST_CASE("principal axes turn with the body, are right-handed, and say where they are not determined", "[tensors]") {
  const RigidBody own = rigid_body(body_of(load_mesh("builtin:cow@2")));
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()) * Eigen::AngleAxisd(2.1, Vec3::UnitX())).toRotationMatrix();
  const RigidBody turned = rigid_body(body_of(test::rotated(load_mesh("builtin:cow@2"), turn)));
  const PrincipalAxes a = principal_axes(own), b = principal_axes(turned);
  CHECK((*a.moments - *b.moments).norm() < 1e-14 * a.moments->norm());
  for (int i = 0; i < 3; ++i) {
    CHECK(std::abs((turn * a.axes.col(i)).dot(b.axes.col(i))) == Approx(1).epsilon(1e-13));
    if (i < 2) CHECK(b.axes.col(i).maxCoeff() > -b.axes.col(i).minCoeff());
  }
  CHECK(b.axes.determinant() == Approx(1).epsilon(1e-14));
  CHECK(difference(b.axes * b.moments->asDiagonal() * b.axes.transpose(), turned.inertia()) < 1e-14);
  const PrincipalAxes cube = principal_axes(rigid_body(body_of(test::box(Vec3(1, 1, 1)))));
  CHECK((cube.first_two_alike && cube.last_two_alike));
  const PrincipalAxes plate = principal_axes(rigid_body(body_of(test::box(Vec3(2, 2, 1)))));
  CHECK((plate.first_two_alike && !plate.last_two_alike));
}

TEST_CASE("third moments of boxes and a tetrahedron are those of the integrals", "[tensors]") {
  const Tensor3 cube = third_moment(body_of(test::box(Vec3(1, 1, 1)), {"mesh", Vec3::Zero()}, 2));
  const Tensor3 corner = third_moment(
      body_of(test::tetrahedron(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()), {"mesh", Vec3::Zero()}));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        const int alike = (i == j) + (j == k) + (i == k); // 3: x^3, 1: x^2 y, 0: xyz
        const double in_cube = alike == 3 ? 1.0 / 4 : alike == 1 ? 1.0 / 6 : 1.0 / 8;
        const double in_corner = (alike == 3 ? 6.0 : alike == 1 ? 2.0 : 1.0) / 720; // a! b! c! / 6!
        CHECK(cube[std::size_t(i)](j, k) == Approx(2 * in_cube).epsilon(1e-15));
        CHECK(corner[std::size_t(i)](j, k) == Approx(in_corner).epsilon(1e-14));
      }
}

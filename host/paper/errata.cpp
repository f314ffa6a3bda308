#include "host/paper/errata.hpp"

#include "host/mesh/geometry.hpp"
#include "host/paper/printed.hpp"
#include "host/paper/surface_tables.hpp"
#include "host/physics/radiate.hpp"
#include "host/physics/rigid_body.hpp"
#include "host/reference/potential.hpp"
#include "host/sphere_grid.hpp"
#include "host/units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu::paper {
namespace {

using namespace physics;

constexpr double pi = std::numbers::pi;

Eigen::Matrix3d paper_quadrupole() {
  const auto t = tensor("quadrupole");
  Eigen::Matrix3d q;
  q << t[0], t[1], t[2], t[1], t[3], t[4], t[2], t[4], t[5];
  return q;
}

// The paper's units in m, kg and kg m^2.
double length_unit() {
  return number("radiation", "length unit in m");
}

double mass_unit() {
  return number("radiation", "mass unit in kg");
}

double inertia_unit() {
  return mass_unit() * length_unit() * length_unit();
}

// 1 - omega/omega_0 about y at 1 rad/s after the paper's time, without its rounding.
double deficit(const Eigen::Matrix3d& quadrupole, double moment) {
  const double unit = inertia_unit(), square = quadrupole_square(quadrupole, Vec3::UnitY()) * unit * unit;
  const double time = (13.787e9 - 12e6) * julian_year;
  return double(spin_down(moment * unit, quadrupole_power(square, 1), 1, time).deficit);
}

// sum |Q'''_2m|^2 over Q'''_ij Q'''_ij, of a turning tensor: the factor of the spherical formula is 1/45 over this.
double spherical_factor(const Eigen::Matrix3d& tensor) {
  // The printed digits leave a trace of 1e-8.
  const Eigen::Matrix3d q = tensor - tensor.trace() / 3 * Eigen::Matrix3d::Identity();
  double sum = 0;
  const auto spherical = spherical_quadrupole(q);
  for (int m = -2; m <= 2; ++m) sum += std::norm(spherical[std::size_t(std::abs(m))]);
  return q.squaredNorm() / (45 * sum);
}

// Integral of |Y_22|^2 over the sphere: Y_22 is what a moment Q_22 alone makes of the potential at r = 1.
double norm_of_y22() {
  Multipoles only(2);
  only(2, 2) = 1;
  const reference::ExteriorPotential<double> real_part(only);
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 8);
  double sum = 0;
  for (int i = 0; i < grid.rings; ++i)
    for (int j = 0; j < grid.ring_length; ++j) {
      const double theta = grid.theta[std::size_t(i)], phi = grid.phi(j);
      const Vec3 n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      const double twice_re = real_part(n).value * 5 / (4 * pi);
      sum += twice_re * twice_re * grid.weights[std::size_t(i)] * 2 * pi / grid.ring_length;
    }
  return sum / 2; // half the integral of (Y + conj Y)^2
}

// The lowest corner on the right, about which the cow is tipped.
Vec3 pivot(const Body& body) {
  const Vec3 centre = body.centre_of_mass;
  Vec3 lowest = Vec3::Constant(std::numeric_limits<double>::infinity());
  for (const Vec3& p : body.surface.vertices())
    if (p.z() > centre.z() && p.y() < lowest.y()) lowest = p;
  return lowest - centre;
}

} // namespace

Comparison erratum_number(int erratum, std::string quantity, double right, double printed, double uncertainty) {
  return {std::move(quantity), right, printed, "", uncertainty, erratum};
}

std::vector<Comparison> errata_numbers() {
  const double square = quadrupole_square(paper_quadrupole(), Vec3::UnitY()) * inertia_unit() * inertia_unit();
  Multipoles monopole;
  monopole.values = {1 / std::sqrt(4 * pi)};
  const double far = reference::ExteriorPotential<double>(monopole)(Vec3(3, 4, 12)).value * 13;
  int degree = 0;
  for (const PaperRow& row : paper_harmonic_table()) degree = std::max(degree, row.l);
  const double printed_time = (13.787e9 - 12e6) * 365 * 86400, deficit_now = number("radiation", "1 - omega now");
  return {erratum_number(1, "square of the paper's tensor in kg^2 m^4", square,
                         number("radiation", "Q'''^2/omega^6 in kg^2 m^4")),
          erratum_number(1, "power of it in erg/s", double(quadrupole_power(square, 1)) * 1e7,
                         number("radiation", "power in erg/s")),
          erratum_number(2, "factor of G/c^5 sum |Q'''_2m|^2", spherical_factor(paper_quadrupole()),
                         number("radiation", "factor of sum |Q'''_2m|^2 G/c^5")),
          erratum_number(3, "r V/M of a point mass", far, far * std::sqrt(1 / (4 * pi))),
          erratum_number(4, "integral of |Y_22|^2", norm_of_y22(), norm_of_y22() * 120 / 5),
          erratum_number(7, "deficit with the paper's tensors", deficit(paper_quadrupole(), tensor("inertia")[3]),
                         deficit_now),
          erratum_number(7, "deficit with the paper's rounding",
                         printed_time / (2 * number("radiation", "timescale in s")), deficit_now),
          erratum_number(10, "highest degree of the harmonic table", double(degree), 2)};
}

std::vector<Comparison> errata_numbers(const Body& benchmark) {
  const RigidBody body = about_centre(rigid_body(benchmark));
  const Vec3 p = pivot(benchmark);
  const RawMesh& mesh = benchmark.surface.mesh();
  const double unit_of_length = cow_length_m / bounding_box(mesh.vertices, mesh.faces).longest_side();
  const double mass = number("radiation", "mass in kg");
  return {
      erratum_number(5, "Im Q_22", spherical_quadrupole(body.quadrupole)[2].imag(), number("tensors", "Im conj Q_22")),
      erratum_number(7, "deficit with exact tensors", deficit(body.quadrupole, body.inertia()(1, 1)),
                     number("radiation", "1 - omega now")),
      erratum_number(11, "lever of the lowest hoof about x", p.z(), std::hypot(p.x(), p.z())),
      erratum_number(14, "volume", benchmark.volume, number("tensors", "volume")),
      erratum_number(14, "mass in kg", benchmark.volume * mass_unit(), mass),
      erratum_number(14, "Q_00", body.mass / std::sqrt(4 * pi), number("tensors", "Q_00")),
      erratum_number(18, "length of the mesh", cow_length_m / unit_of_length, number("bounding box", "x")),
      erratum_number(18, "unit of length in m", unit_of_length, length_unit()),
      erratum_number(18, "power at fixed density, over that of 2.39 m", std::pow(unit_of_length / length_unit(), 10),
                     1),
      erratum_number(18, "mass in kg", benchmark.volume * 1000 * std::pow(unit_of_length, 3), mass)};
}

} // namespace cowgpu::paper

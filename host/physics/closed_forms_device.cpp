#include "host/physics/closed_forms.hpp"

#include "host/error.hpp"
#include "host/parallel.hpp"
#include "host/physics/far_field.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <utility>

namespace cowgpu::physics {
namespace {

using Real = long double;

// Units in the last place that the sums of a surface lose, in units of what rounding their edges' terms once would: measured on
// boxes, balls, needles and asteroids (tests/physics/body_field_test.cpp), and doubled.
constexpr double units_lost = 4;

constexpr std::size_t points_per_task = 4096;

double ball_radius(double volume) {
  return std::cbrt(std::abs(volume) * 3 / (4 * std::numbers::pi));
}

// Root of the sum over the edges of (rounding times length)^2, as reference::Polyhedron::rounding() has it.
double spread(const ClosedSurface& surface) {
  double sum = 0;
  for (const Face& face : surface.faces()) {
    const Vec3 &a = surface.vertices()[face[0]], &b = surface.vertices()[face[1]], &c = surface.vertices()[face[2]];
    const Vec3 ab = b - a, bc = c - b, ca = a - c;
    const Vec3& u = ab.squaredNorm() <= std::max(bc.squaredNorm(), ca.squaredNorm()) ? ab : bc;
    const Vec3& v = &u == &ab ? (bc.squaredNorm() <= ca.squaredNorm() ? bc : ca) : ca;
    const double norm = u.cross(v).norm();
    if (!(norm > 0)) continue;
    const Vec3 first = u.cwiseAbs(), second = v.cwiseAbs();
    const Vec3 products(first.y() * second.z() + first.z() * second.y(),
                        first.z() * second.x() + first.x() * second.z(),
                        first.x() * second.y() + first.y() * second.x());
    const double rounding = 1 + products.norm() / norm;
    sum += rounding * rounding * (ab.squaredNorm() + bc.squaredNorm() + ca.squaredNorm());
  }
  return std::sqrt(sum);
}

// Inside thin bodies each face is seen under large angles, and rounded coordinates turn those: an error that grows with the radius
// over the thickness (1 for a ball), as needles showed to a thickness of 1e-3.
double thinness(const DenseSurface& part) {
  const Box box = bounding_box(*part.surface);
  const double radius = (box.max - box.min).norm() / 2;
  return radius * (radius * area(*part.surface) / (3 * std::abs(part.volume))) / 4;
}

void check_tolerance(double tolerance) {
  if (tolerance == 0 || (tolerance >= least_polyhedron_tolerance && tolerance <= largest_polyhedron_tolerance)) return;
  throw Error(Fault::bad_argument,
              fmt::format("the tolerance {} must be 0, which sums all faces at all points, or from {} to {} of GM/R^2",
                          tolerance, least_polyhedron_tolerance, largest_polyhedron_tolerance));
}

// sum += density * more.
void add(double density, const PolyhedronValues& more, PolyhedronValues& sum) {
  const std::size_t count = more.field.value.size();
  for (std::size_t i = 0; i < count; ++i) {
    sum.field.value[i] += density * more.field.value[i];
    sum.winding[i] += density * more.winding[i];
    if (!more.field.gradient.empty()) sum.field.gradient[i] += density * more.field.gradient[i];
    if (!more.field.hessian.empty())
      for (std::size_t c = 0; c < 6; ++c) sum.field.hessian[i][c] += density * more.field.hessian[i][c];
    if (!more.bound.empty()) sum.bound[i] += std::abs(density) * more.bound[i];
    if (!more.on_edge.empty()) sum.on_edge[i] |= more.on_edge[i];
  }
}

class DeviceForms final : public ClosedForms {
public:
  DeviceForms(const Body& body, const BodyFieldProblem& problem, const Backend& backend)
      : surfaces_(body_surfaces(body)), threads_(problem.threads ? problem.threads : all_threads()) {
    check_tolerance(problem.tolerance);
    // v/R^2 of a ball is 4 pi R/3. Each surface may leave out the same part of its own.
    double whole = 0;
    for (const DenseSurface& part : surfaces_) {
      const double own = 4 * std::numbers::pi / 3 * ball_radius(part.volume);
      whole += std::abs(part.density) * own;
    }
    const double share = whole > 0 ? problem.tolerance * std::min(1.0, gravity_scale(body) / whole) : 0;
    far_reach_ = 4 * Real(middle(body).radius);
    for (const DenseSurface& part : surfaces_) {
      PolyhedronProblem one{part.surface->vertices(), part.surface->faces()};
      one.derivatives = problem.derivatives;
      one.tolerance = share >= least_polyhedron_tolerance ? share : 0;
      one.guarantee = problem.guarantee;
      tolerance_ = one.tolerance;
      parts_.push_back({backend.polyhedron(one), part.density});
    }
    left_out_.gradient = tolerance_ * whole;
    // V holds the product of the gradient and the way from the body's middle, which is long beside a thin body's v/R^2.
    left_out_.value = left_out_.gradient * double(middle(body).radius);
  }

  // Beyond 3 radii the device takes each surface's multipoles (host/plan/polyhedron_call.hpp), whose errors fall as the field.
  FieldError rounding(Real reach) const override {
    std::call_once(measured_, [&] {
      for (const DenseSurface& part : surfaces_)
        spread_ += std::abs(part.density) * (spread(*part.surface) + thinness(part));
    });
    const Real unit = units_lost * std::numeric_limits<double>::epsilon() * spread_;
    const Real x = std::min<Real>(1, far_reach_ / reach);
    return {unit * std::min(reach, far_reach_) * x, unit * x * x, unit / reach * x * x};
  }

  FieldError left_out() const override { return left_out_; }

  void at(std::span<const Vec3> points, std::span<const std::uint32_t> which, const Put& put, Monitor& monitor,
          RunReport* report) const override {
    std::vector<Vec3> some;
    if (which.size() != points.size()) {
      some.reserve(which.size());
      for (const std::uint32_t i : which) some.push_back(points[i]);
      points = some;
    }
    if (report) *report = {};
    PolyhedronValues sum;
    for (const Piece& part : parts_) {
      RunReport one;
      PolyhedronValues values = part.polyhedron->at(points, monitor, &one);
      if (sum.field.value.empty()) {
        sum = std::move(values);
        scale(part.density, sum);
      } else {
        add(part.density, values, sum);
      }
      if (!report) continue;
      report->seconds += one.seconds;
      report->setup_seconds += one.setup_seconds;
      report->elements += one.elements;
      report->full_elements += one.full_elements;
      report->kernels.insert(report->kernels.end(), one.kernels.begin(), one.kernels.end());
    }
    const std::size_t tasks = (which.size() + points_per_task - 1) / points_per_task;
    parallel_for(threads_, tasks, [&](std::size_t task, unsigned thread) {
      const std::size_t end = std::min(which.size(), (task + 1) * points_per_task);
      for (std::size_t k = task * points_per_task; k < end; ++k)
        put(which[k], entry(sum, k), sum.bound.empty() ? 0 : sum.bound[k], thread);
    });
  }

  MemoryNeed memory(std::uint64_t points) const override {
    MemoryNeed most;
    for (const Piece& part : parts_) {
      const MemoryNeed need = part.polyhedron->memory(points);
      most.host = std::max(most.host, need.host);
      most.device = std::max(most.device, need.device);
    }
    // One result more than the surface's own, and the points.
    most.host += points * (sizeof(Vec3) + (parts_.size() > 1 ? 16 * sizeof(double) : 0));
    return most;
  }

private:
  struct Piece {
    std::unique_ptr<PreparedPolyhedron> polyhedron;
    double density;
  };

  static void scale(double density, PolyhedronValues& values) {
    if (density == 1) return;
    for (double& v : values.field.value) v *= density;
    for (Vec3& g : values.field.gradient) g *= density;
    for (SymmetricTensor& h : values.field.hessian)
      for (double& component : h) component *= density;
    for (double& w : values.winding) w *= density;
    for (double& b : values.bound) b *= std::abs(density);
  }

  static PolyhedronAt entry(const PolyhedronValues& values, std::size_t k) {
    PolyhedronAt at;
    at.value = values.field.value[k];
    if (!values.field.gradient.empty()) at.gradient = values.field.gradient[k].cast<Real>();
    if (!values.field.hessian.empty()) {
      const SymmetricTensor& h = values.field.hessian[k];
      at.hessian << h[0], h[1], h[2], h[1], h[3], h[4], h[2], h[4], h[5];
    }
    if (!values.winding.empty()) at.winding = values.winding[k];
    at.on_edge = !values.on_edge.empty() && values.on_edge[k] != 0;
    return at;
  }

  std::vector<DenseSurface> surfaces_;
  unsigned threads_;
  std::vector<Piece> parts_;
  double tolerance_ = 0;
  mutable std::once_flag measured_;
  mutable double spread_ = 0; // weighed by the densities
  Real far_reach_ = 0;        // to the farthest vertex from a point 3 radii away
  FieldError left_out_;
};

} // namespace

double gravity_scale(const Body& body) {
  const double radius = ball_radius(body.volume);
  return std::abs(body.mass()) / (radius * radius);
}

std::unique_ptr<const ClosedForms> device_forms(const Body& body, const BodyFieldProblem& problem,
                                                const Backend& backend) {
  return std::make_unique<DeviceForms>(body, problem, backend);
}

} // namespace cowgpu::physics

#include "tests/support/polyhedron_errors.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace cowgpu::test {
namespace {

double volume(const RawMesh& mesh) {
  double sum = 0;
  for (const Face& f : mesh.faces) sum += mesh.vertices[f[0]].dot(mesh.vertices[f[1]].cross(mesh.vertices[f[2]])) / 6;
  return sum;
}

} // namespace

std::vector<Vec3> centroids(const RawMesh& mesh) {
  std::vector<Vec3> found;
  for (const Face& f : mesh.faces)
    found.push_back((mesh.vertices[f[0]] + mesh.vertices[f[1]] + mesh.vertices[f[2]]) / 3);
  return found;
}

PolyhedronProblem fast_problem(const RawMesh& mesh, double tolerance, Derivatives derivatives, bool guarantee) {
  PolyhedronProblem made;
  made.vertices = mesh.vertices;
  made.faces = mesh.faces;
  made.tolerance = tolerance;
  made.derivatives = derivatives;
  made.guarantee = guarantee;
  return made;
}

FieldErrors field_errors(const RawMesh& mesh, const PolyhedronValues& found, const PolyhedronValues& truth) {
  const double v = volume(mesh), radius = std::cbrt(0.75 * v * std::numbers::inv_pi), weight = v / (radius * radius);
  FieldErrors worst;
  const auto note = [](double& most, double error) {
    if (!(error <= most)) most = error;
  };
  for (std::size_t i = 0; i < truth.field.value.size(); ++i) {
    const double error = (found.field.gradient[i] - truth.field.gradient[i]).norm();
    note(worst.gradient, error / weight);
    note(worst.value, std::abs(found.field.value[i] - truth.field.value[i]) * radius / v);
    note(worst.winding, std::abs(found.winding[i] - truth.winding[i]));
    for (std::size_t k = 0; !truth.field.hessian.empty() && k < 6; ++k)
      note(worst.hessian, std::abs(found.field.hessian[i][k] - truth.field.hessian[i][k]));
    if (found.bound.empty()) continue;
    // Rounding, which bounds leave out, is some units of 1e-16.
    worst.bounded = worst.bounded && error <= found.bound[i] + 3e-14 * weight;
    note(worst.bound, found.bound[i] / weight);
  }
  return worst;
}

} // namespace cowgpu::test

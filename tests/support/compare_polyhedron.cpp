#include "tests/support/compare_polyhedron.hpp"

#include "host/reference/polyhedron.hpp"
#include "tests/support/compare_potential.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

namespace cowgpu::test {
namespace {

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

} // namespace

PolyhedronProblem polyhedron_problem(const RawMesh& mesh, Derivatives derivatives) {
  PolyhedronProblem problem;
  problem.vertices = mesh.vertices;
  problem.faces = mesh.faces;
  problem.derivatives = derivatives;
  return problem;
}

std::vector<Vec3> points_about(const RawMesh& mesh, std::size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1), part(0, 1);
  Vec3 middle = Vec3::Zero();
  for (const Vec3& v : mesh.vertices) middle += v / double(mesh.vertices.size());
  double radius = 0;
  for (const Vec3& v : mesh.vertices) radius = std::max(radius, (v - middle).norm());
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Face& f = mesh.faces[random() % mesh.faces.size()];
    const Vec3 &a = mesh.vertices[f[0]], &b = mesh.vertices[f[1]], &c = mesh.vertices[f[2]];
    const Vec3 normal = (b - a).cross(c - a).normalized(), any(uniform(random), uniform(random), uniform(random));
    switch (i % 7) {
    case 0: points.emplace_back((a + b + c) / 3); break;
    case 1: points.push_back(a); break;
    case 2: points.emplace_back((a + b) / 2); break;
    case 3: points.emplace_back((a + b + c) / 3 + normal * 1e-3 * radius); break;
    case 4: points.emplace_back((a + b + c) / 3 - normal * part(random) * radius / 4); break;
    case 5: points.emplace_back(middle + 1.5 * radius * any); break;
    default: points.emplace_back(middle + radius * std::pow(20.0, part(random)) * any.normalized()); break;
    }
  }
  return points;
}

PolyhedronValues polyhedron(Backend& backend, const PolyhedronProblem& problem, std::span<const Vec3> points,
                            RunReport* report) {
  Monitor silent;
  return backend.polyhedron(problem)->at(points, silent, report);
}

void compare_polyhedron(Paths& paths, const PolyhedronProblem& problem, std::span<const Vec3> points,
                        const PolyhedronFigures& figures) {
  const reference::Polyhedron<long double> reference(problem.vertices, problem.faces);
  const std::size_t count = points.size(), step = count / 64 + 1;
  std::vector<reference::PolyhedronAt<long double>> truth;
  for (std::size_t i = 0; i < count; i += step) truth.push_back(reference.at(points[i]));
  const bool with_gradient = problem.derivatives != Derivatives::none,
             with_hessian = problem.derivatives == Derivatives::second;
  paths.each([&](Backend& backend) {
    const PolyhedronValues found = polyhedron(backend, problem, points);
    REQUIRE(found.field.value.size() == count);
    REQUIRE(found.winding.size() == count);
    REQUIRE(found.field.gradient.size() == (with_gradient ? count : 0));
    REQUIRE(found.field.hessian.size() == (with_hessian ? count : 0));
    REQUIRE(found.on_edge.size() == (with_hessian ? count : 0));
    double value = 0, gradient = 0, hessian = 0, winding = 0;
    const auto note = [](double& worst, long double error) {
      if (!(double(error) <= worst)) worst = double(error);
    };
    for (std::size_t t = 0; t < truth.size(); ++t) {
      const std::size_t i = t * step;
      const auto& at = truth[t];
      note(value, std::fabs((found.field.value[i] - at.value) / at.value));
      note(winding, std::fabs(found.winding[i] - at.winding));
      if (with_gradient)
        note(gradient, (found.field.gradient[i].cast<long double>() - at.gradient).norm() / at.gradient.norm());
      if (!with_hessian) continue;
      CHECK((found.on_edge[i] != 0) == at.on_edge);
      for (Eigen::Index a = 0, k = 0; a < 3; ++a)
        for (Eigen::Index b = a; b < 3; ++b, ++k)
          note(hessian, std::fabs(found.field.hessian[i][std::size_t(k)] - at.hessian(a, b)) / at.hessian.norm());
    }
    const std::string what = fmt::format("{}, {} faces, {} points", backend.facts().type, problem.faces.size(), count);
    check_at_most(value, figures.field, what + ", V");
    check_at_most(gradient, figures.field, what + ", gradient");
    if (figures.tensor == 0) return;
    check_at_most(winding, figures.tensor, what + ", winding");
    check_at_most(hessian, figures.tensor, what + ", second derivatives");
  });
}

bool same_bits(const PolyhedronValues& a, const PolyhedronValues& b) {
  return same_bits(a.field, b.field) && same(a.winding, b.winding) && same(a.bound, b.bound) &&
         same(a.on_edge, b.on_edge);
}

} // namespace cowgpu::test

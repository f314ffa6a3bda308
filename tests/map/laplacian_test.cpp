#include "host/error.hpp"
#include "host/map/laplacian.hpp"
#include "host/map/solve.hpp"
#include "host/mesh/topology.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

ManifoldSurface manifold(RawMesh mesh) {
  return ManifoldSurface::from(ClosedSurface::from(std::move(mesh)));
}

SparseMatrix laplacian_of(const ManifoldSurface& surface, EdgeWeights weights) {
  return laplacian(surface, HalfEdges(surface), weights);
}

constexpr EdgeWeights all_weights[] = {EdgeWeights::cotangent, EdgeWeights::mean_value, EdgeWeights::tutte};

std::vector<ManifoldSurface> bodies() {
  std::mt19937 random(3);
  std::vector<ManifoldSurface> list;
  list.push_back(manifold(tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3})));
  list.push_back(manifold(box({1, 2, 3})));
  list.push_back(manifold(icosphere(3)));
  list.push_back(manifold(torus(12, 8)));
  list.push_back(manifold(two_shells()));
  for (int i = 0; i < 5; ++i) list.push_back(manifold(convex_polyhedron(random, 40, 50)));
  return list;
}

// The largest |sum of a row| over the sum of its sizes.
double row_sums(const SparseMatrix& matrix) {
  const Eigen::VectorXd sum = matrix * Eigen::VectorXd::Ones(matrix.cols());
  const Eigen::VectorXd size = matrix.cwiseAbs() * Eigen::VectorXd::Ones(matrix.cols());
  double worst = 0;
  for (Eigen::Index i = 0; i < sum.size(); ++i)
    if (size[i] > 0) worst = std::max(worst, std::abs(sum[i]) / size[i]);
  return worst;
}

} // namespace

TEST_CASE("Laplacians take constants to zero", "[laplacian]") {
  for (const auto& surface : bodies())
    for (const EdgeWeights weights : all_weights)
      check_at_most(row_sums(laplacian_of(surface, weights)), 1e-15, std::string(name(weights)));
}

TEST_CASE("cotangent and Tutte Laplacians are symmetric to the last bit, mean-value ones are not", "[laplacian]") {
  for (const auto& surface : bodies()) {
    for (const EdgeWeights weights : {EdgeWeights::cotangent, EdgeWeights::tutte}) {
      const SparseMatrix matrix = laplacian_of(surface, weights);
      CHECK((matrix - SparseMatrix(matrix.transpose())).norm() == 0);
    }
  }
  const SparseMatrix matrix = laplacian_of(bodies()[1], EdgeWeights::mean_value);
  CHECK((matrix - SparseMatrix(matrix.transpose())).norm() > 0.01 * matrix.norm());
}

TEST_CASE("a Laplacian has one entry a directed edge and one a vertex", "[laplacian]") {
  for (const auto& surface : bodies()) {
    const SparseMatrix matrix = laplacian_of(surface, EdgeWeights::tutte);
    const std::size_t used = surface.vertices().size() - unused_vertices(surface.faces(), surface.vertices().size());
    CHECK(std::size_t(matrix.nonZeros()) == 3 * surface.faces().size() + used);
    for (const Face& f : surface.faces())
      for (std::size_t k = 0; k < 3; ++k) CHECK(matrix.coeff(f[k], f[(k + 1) % 3]) == -1);
  }
}

TEST_CASE("the cotangent Laplacian gives the Dirichlet energy of coordinates, twice the area", "[laplacian]") {
  // The gradients of x, y, z on a triangle have squares that add up to 2.
  for (const auto& surface : bodies()) {
    const SparseMatrix matrix = laplacian_of(surface, EdgeWeights::cotangent);
    Eigen::MatrixXd x(matrix.cols(), 3);
    for (Eigen::Index i = 0; i < x.rows(); ++i) x.row(i) = surface.vertices()[std::size_t(i)];
    double area = 0;
    for (const Face& f : surface.faces()) {
      const auto& v = surface.vertices();
      area += (v[f[1]] - v[f[0]]).cross(v[f[2]] - v[f[0]]).norm() / 2;
    }
    check_at_most(std::abs(x.cwiseProduct(matrix * x).sum() / (2 * area) - 1), 2e-14, "energy");
  }
}

TEST_CASE("the weights of a regular tetrahedron are those of equilateral triangles", "[laplacian]") {
  const auto surface = manifold(tetrahedron({1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}));
  const SparseMatrix cotangent = laplacian_of(surface, EdgeWeights::cotangent);
  const SparseMatrix mean_value = laplacian_of(surface, EdgeWeights::mean_value);
  // Mean-value weights count lengths in the power of two at or below the longest side of the box, 2; edges are sqrt 8.
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      if (i == j) continue;
      CHECK(cotangent.coeff(i, j) == Approx(-1 / std::sqrt(3.0)).epsilon(1e-15));
      CHECK(mean_value.coeff(i, j) == Approx(-2 * std::tan(std::numbers::pi / 6) / std::sqrt(2.0)).epsilon(1e-15));
    }
}

TEST_CASE("mean-value weights reproduce points of a plane", "[laplacian]") {
  // Where the faces at a vertex lie in a plane, the vertex is the mean of its neighbours with their weights.
  RawMesh mesh = box({1, 1, 1});
  const Face split = mesh.faces[0];
  const Vec3 inside = 0.2 * mesh.vertices[split[0]] + 0.3 * mesh.vertices[split[1]] + 0.5 * mesh.vertices[split[2]];
  const auto added = std::uint32_t(mesh.vertices.size());
  mesh.vertices.push_back(inside);
  mesh.faces[0] = {split[0], split[1], added};
  mesh.faces.push_back({split[1], split[2], added});
  mesh.faces.push_back({split[2], split[0], added});
  const auto surface = manifold(std::move(mesh));
  for (const EdgeWeights weights : {EdgeWeights::cotangent, EdgeWeights::mean_value}) {
    const SparseMatrix matrix = laplacian_of(surface, weights);
    Vec3 sum = Vec3::Zero();
    double size = 0;
    for (int j = 0; j < matrix.cols(); ++j) {
      sum += matrix.coeff(int(added), j) * surface.vertices()[std::size_t(j)];
      size += std::abs(matrix.coeff(int(added), j));
    }
    check_at_most(sum.norm() / size, 1e-15, std::string(name(weights)));
  }
}

TEST_CASE("cotangent and mean-value weights do not depend on the unit of length", "[laplacian]") {
  for (const double factor : {1e-40, 1e40}) {
    const auto before = manifold(box({1, 2, 3})), after = manifold(scaled(box({1, 2, 3}), Vec3::Constant(factor)));
    const SparseMatrix a = laplacian_of(before, EdgeWeights::cotangent),
                       b = laplacian_of(after, EdgeWeights::cotangent);
    check_at_most((a - b).norm() / a.norm(), 1e-15, "cotangent");
    const SparseMatrix m = laplacian_of(after, EdgeWeights::mean_value);
    CHECK(m.coeffs().allFinite());
  }
}

TEST_CASE("a triangle without area is refused by cotangent weights and taken by Tutte's", "[laplacian]") {
  // A vertex on the edge of a box: the triangle that it makes with the edge is flat.
  RawMesh mesh = box({1, 1, 1});
  const Face f = mesh.faces[0];
  const auto added = std::uint32_t(mesh.vertices.size());
  mesh.vertices.push_back((mesh.vertices[f[0]] + mesh.vertices[f[1]]) / 2);
  mesh.faces[0] = {f[0], f[1], added};
  mesh.faces.push_back({f[1], f[2], added});
  mesh.faces.push_back({f[2], f[0], added});
  const auto surface = manifold(std::move(mesh));
  for (const EdgeWeights weights : {EdgeWeights::cotangent, EdgeWeights::mean_value}) {
    try {
      laplacian_of(surface, weights);
      FAIL("accepted");
    } catch (const Error& error) {
      CHECK(error.fault() == Fault::map_failed);
      CHECK(std::string(error.what()).find("face 0") != std::string::npos);
    }
  }
  CHECK(laplacian_of(surface, EdgeWeights::tutte).coeffs().allFinite());
}

TEST_CASE("vertex areas add up to 1", "[laplacian]") {
  for (const auto& surface : bodies()) {
    double sum = 0;
    for (const double area : vertex_areas(surface)) sum += area;
    CHECK(sum == Approx(1).epsilon(1e-14));
  }
}

TEST_CASE("both orderings solve symmetric systems to rounding", "[solve]") {
  const auto surface = manifold(icosphere(4));
  SparseMatrix matrix = laplacian_of(surface, EdgeWeights::cotangent);
  for (int i = 0; i < matrix.cols(); ++i) matrix.coeffRef(i, i) += 1e-3;
  const Eigen::MatrixXd expected = Eigen::MatrixXd::Random(matrix.cols(), 3);
  const Eigen::MatrixXd right = matrix * expected;
  for (const Ordering ordering : {Ordering::minimum_degree, Ordering::nested_dissection}) {
    SymmetricSolver solver(matrix, "the test's system", ordering);
    CHECK(solver.ordering() == ordering);
    check_at_most((solver.solve(right) - expected).norm() / expected.norm(), 4e-13, "solution");
    check_at_most(solver.residual(), 5e-16, "residual");
    CHECK(solver.factor_size() < 100 * std::size_t(matrix.cols())); // 1281 a column would be a full factor
    solver.factorise(4 * matrix);
    check_at_most((4 * solver.solve(right) - expected).norm() / expected.norm(), 4e-13, "solution of the second");
  }
  double residual = 1;
  const Eigen::MatrixXd general = solve_general(matrix, right, "the test's system", &residual);
  check_at_most((general - expected).norm() / expected.norm(), 4e-13, "solution by LU");
  check_at_most(residual, 5e-16, "residual of LU");
}

TEST_CASE("systems without unknowns have empty solutions", "[solve]") {
  SymmetricSolver solver(SparseMatrix(0, 0), "nothing");
  CHECK(solver.solve(Eigen::MatrixXd(0, 2)).rows() == 0);
  CHECK(solve_general(SparseMatrix(0, 0), Eigen::MatrixXd(0, 2), "nothing").cols() == 2);
}

TEST_CASE("singular and indefinite systems are refused with sentences", "[solve]") {
  const auto surface = manifold(icosphere(1));
  const SparseMatrix singular = laplacian_of(surface, EdgeWeights::tutte), indefinite = -singular;
  for (const SparseMatrix& matrix : {singular, indefinite}) {
    try {
      SymmetricSolver(matrix, "the test's system").solve(Eigen::MatrixXd::Random(matrix.cols(), 1));
      FAIL("accepted");
    } catch (const Error& error) {
      CHECK(error.fault() == Fault::map_failed);
      CHECK(std::string(error.what()).find("the test's system") != std::string::npos);
    }
  }
}

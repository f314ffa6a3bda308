// Moments against closed forms, rational arithmetic, brute-force quadrature and 113-bit arithmetic: nothing here shares a
// line with the recursions.
#include "host/mesh/geometry.hpp"
#include "host/plan/moments.hpp"
#include "host/reference/moments.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>
#include <boost/multiprecision/float128.hpp>
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;
namespace mp = boost::multiprecision;

namespace {

constexpr int exact_degree = 16;
constexpr long double pi = std::numbers::pi_v<long double>;

__extension__ using Wide = __int128;
using Integer = mp::number<mp::cpp_int_backend<>, mp::et_off>;

/// A homogeneous polynomial of degree n in s, t, u; s^i t^j u^(n-i-j) stands at i (n+1) + j.
struct Form {
  int n = 0;
  std::vector<Wide> c;
  explicit Form(int degree) : n(degree), c(std::size_t(degree + 1) * std::size_t(degree + 1), 0) {}
  Wide& at(int i, int j) { return c[std::size_t(i * (n + 1) + j)]; }
  Wide at(int i, int j) const { return c[std::size_t(i * (n + 1) + j)]; }
};

Form times(const Form& f, const std::array<std::int64_t, 3>& linear) {
  Form g(f.n + 1);
  for (int i = 0; i <= f.n; ++i)
    for (int j = 0; i + j <= f.n; ++j) {
      g.at(i + 1, j) += f.at(i, j) * linear[0];
      g.at(i, j + 1) += f.at(i, j) * linear[1];
      g.at(i, j) += f.at(i, j) * linear[2];
    }
  return g;
}

/// Integrals of x^a y^b z^c over a body of integer coordinates, times (a+b+c+3)!, for a+b+c up to exact_degree.
class Monomials {
public:
  Monomials(const RawMesh& mesh, const std::array<std::int64_t, 3>& origin) {
    factorial_.push_back(1);
    for (int n = 1; n <= 2 * exact_degree; ++n) factorial_.push_back(factorial_.back() * n);
    for (const Face& face : mesh.faces) {
      std::array<std::array<std::int64_t, 3>, 3> x{}; // x[k]: coordinate k of the three corners
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t corner = 0; corner < 3; ++corner)
          x[k][corner] = std::int64_t(mesh.vertices[face[corner]][Eigen::Index(k)]) - origin[k];
      add_tetrahedron(x);
    }
  }

  const Integer& operator()(int a, int b, int c) const { return sum_[index(a, b, c)]; }
  const Integer& factorial(int n) const { return factorial_[std::size_t(n)]; }

private:
  static std::size_t index(int a, int b, int c) {
    return std::size_t((a * (exact_degree + 1) + b) * (exact_degree + 1) + c);
  }

  // On the tetrahedron (0, A, B, C) a point is s A + t B + u C, and the integral of s^i t^j u^k is
  // det(A, B, C) i! j! k! / (i+j+k+3)!.
  void add_tetrahedron(const std::array<std::array<std::int64_t, 3>, 3>& x) {
    const auto& [p, q, r] = x;
    const std::int64_t det =
        p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0]) + p[2] * (q[0] * r[1] - q[1] * r[0]);
    Form xa(0);
    xa.at(0, 0) = 1;
    for (int a = 0; a <= exact_degree; ++a) {
      Form xy = xa;
      for (int b = 0; a + b <= exact_degree; ++b) {
        Form xyz = xy;
        for (int c = 0; a + b + c <= exact_degree; ++c) {
          Integer sum = 0;
          for (int i = 0; i <= xyz.n; ++i)
            for (int j = 0; i + j <= xyz.n; ++j)
              if (xyz.at(i, j) != 0)
                sum += Integer(xyz.at(i, j)) * factorial(i) * factorial(j) * factorial(xyz.n - i - j);
          sum_[index(a, b, c)] += det * sum;
          if (a + b + c < exact_degree) xyz = times(xyz, r);
        }
        if (a + b < exact_degree) xy = times(xy, q);
      }
      if (a < exact_degree) xa = times(xa, p);
    }
  }

  std::vector<Integer> factorial_;
  std::vector<Integer> sum_ = std::vector<Integer>(index(exact_degree + 1, 0, 0), 0);
};

/// Q_lm of the body, from S_lm = sqrt((2l+1)/4pi (l+m)! (l-m)!) sum_k (-1)^(m+k) (x+iy)^m (x^2+y^2)^k z^(l-m-2k)
/// / ((m+k)! k! (l-m-2k)! 2^(m+2k)): all rational but the root and pi.
std::complex<long double> exact_moment(const Monomials& monomial, int l, int m) {
  const auto f = [&](int n) -> const Integer& { return monomial.factorial(n); };
  const auto choose = [&](int n, int k) -> Integer { return f(n) / (f(k) * f(n - k)); };
  std::array<Integer, 2> sum; // real, imaginary: over l! (l+3)! 2^l
  for (int k = 0; m + 2 * k <= l; ++k) {
    const int c = l - m - 2 * k;
    const Integer multinomial = f(l) / (f(m + k) * f(k) * f(c));
    for (int i = 0; i <= m; ++i)     // (x+iy)^m: x^(m-i) (iy)^i
      for (int j = 0; j <= k; ++j) { // (x^2+y^2)^k: x^(2k-2j) y^(2j)
        const int sign = (m + k + i / 2) % 2 == 0 ? 1 : -1;
        sum[std::size_t(i % 2)] +=
            (multinomial << c) * sign * choose(m, i) * choose(k, j) * monomial(m - i + 2 * (k - j), i + 2 * j, c);
      }
  }
  using Float = mp::cpp_bin_float_50;
  const Float norm =
      sqrt(Float((2 * l + 1) * f(l + m) * f(l - m)) / (4 * acos(Float(-1)))) / Float(f(l) * f(l + 3) << l);
  return {static_cast<long double>(Float(norm * Float(sum[0]))), static_cast<long double>(Float(norm * Float(sum[1])))};
}

/// The largest |error| of any Q_lm in units of M R^l, on all three paths, is at most `figure`.
void check_exact(Paths& paths, const RawMesh& mesh, const std::array<std::int64_t, 3>& origin, double figure) {
  const Monomials monomial(mesh, origin);
  MomentProblem problem =
      moment_problem(mesh, exact_degree, Vec3(double(origin[0]), double(origin[1]), double(origin[2])));
  problem.density = 2.5;
  std::vector<std::complex<long double>> exact;
  for (int m = 0; m <= exact_degree; ++m)
    for (int l = m; l <= exact_degree; ++l)
      exact.push_back((long double)(problem.density) * exact_moment(monomial, l, m) /
                      std::pow((long double)(problem.reference_radius), l));
  const auto mass = (long double)(problem.density) * static_cast<long double>(monomial(0, 0, 0)) / 6;
  INFO(mesh.faces.size() << " faces about " << problem.origin.transpose());
  const auto worst = [&](const auto& value) {
    long double largest = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) largest = std::max(largest, std::abs(value(i) - exact[i]));
    return double(largest / mass);
  };
  const auto reference = reference::moments<long double>(problem);
  check_at_most(worst([&](std::size_t i) { return std::complex<long double>(reference[2 * i], reference[2 * i + 1]); }),
                figure / 1000, "the reference");
  paths.each([&](Backend& backend) {
    const Multipoles result = moments(backend, problem);
    check_at_most(worst([&](std::size_t i) { return std::complex<long double>(result.values[i]); }), figure,
                  backend.facts().name);
  });
}

/// Nodes and weights of Gauss and Legendre on [0, 1].
std::vector<std::pair<double, double>> gauss(int n) {
  std::vector<std::pair<double, double>> rule;
  for (int i = 0; i < n; ++i) {
    long double x = std::cos(pi * (i + 0.75L) / (n + 0.5L)), slope = 1;
    for (int step = 0; step < 10; ++step) {
      long double p = 1, before = 0;
      for (int k = 1; k <= n; ++k) before = std::exchange(p, ((2 * k - 1) * x * p - (k - 1) * before) / k);
      slope = n * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    rule.emplace_back(double((1 + x) / 2), double(1 / ((1 - x * x) * slope * slope)));
  }
  return rule;
}

/// Q_lm / R^l by a product rule on every tetrahedron (origin, A, B, C): exact along the radius, where S_lm is
/// homogeneous, and of degree lmax across.
std::vector<long double> by_quadrature(const MomentProblem& problem) {
  std::vector<long double> sums(2 * Multipoles::count(problem.lmax), 0.0L);
  const auto rule = gauss(problem.lmax / 2 + 2);
  const auto corner = [&](std::uint32_t v) {
    return Vec3((problem.vertices[v] - problem.origin) / problem.reference_radius);
  };
  for (const Face& face : problem.faces) {
    const Vec3 a = corner(face[0]), b = corner(face[1]), c = corner(face[2]);
    const double det = a.dot(b.cross(c));
    for (const auto& [v, v_weight] : rule)
      for (const auto& [w, w_weight] : rule) {
        const Vec3 x = a + v * (b - a) + v * w * (c - b);
        const double theta = std::atan2(std::hypot(x.x(), x.y()), x.z()), phi = std::atan2(x.y(), x.x());
        for (int l = 0; l <= problem.lmax; ++l)
          for (int m = 0; m <= l; ++m) {
            const double weight = det * v * v_weight * w_weight / (l + 3);
            const double size = weight * std::pow(x.norm(), l) * std::sph_legendre(unsigned(l), unsigned(m), theta);
            sums[2 * Multipoles::index(problem.lmax, l, m)] += size * std::cos(m * phi);
            sums[2 * Multipoles::index(problem.lmax, l, m) + 1] += size * std::sin(m * phi);
          }
      }
  }
  for (long double& s : sums) s *= problem.density * std::pow(problem.reference_radius, 3);
  return sums;
}

} // namespace

TEST_CASE("moments of a box agree with rational arithmetic to degree 16", "[moments][exact]") {
  Paths paths;
  check_exact(paths, box({2, 3, 6}), {0, 0, 0}, 4e-16);
  check_exact(paths, box({2, 4, 6}), {1, 2, 3}, 4e-16);
  check_exact(paths, box({1, 1, 9}, {-3, 2, 1}), {2, -1, 1}, 4e-16);
}

TEST_CASE("moments of tetrahedra agree with rational arithmetic to degree 16", "[moments][exact]") {
  Paths paths;
  check_exact(paths, tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), {0, 0, 0}, 4e-16);
  check_exact(paths, tetrahedron({3, -1, 2}, {-4, 2, 1}, {0, 5, -3}, {-1, -2, -4}), {0, 0, 0}, 4e-16);
  check_exact(paths, tetrahedron({3, -1, 2}, {-4, 2, 1}, {0, 5, -3}, {-1, -2, -4}), {2, -5, 4}, 4e-16);
}

TEST_CASE("moments of random polyhedra agree with rational arithmetic to degree 16", "[moments][exact]") {
  Paths paths;
  std::mt19937 random(5);
  for (const int points : {4, 5, 7, 9, 13, 20})
    check_exact(paths, convex_polyhedron(random, points, 6), {1, 0, -1}, 4e-16);
}

TEST_CASE("moments of odd bodies agree with quadrature to degree 24", "[moments][exact]") {
  Paths paths;
  for (const RawMesh& mesh : {shell_with_cavity(), two_shells()}) {
    const MomentProblem problem = moment_problem(mesh, 24, {0.4, -0.3, 0.2});
    const auto expected = by_quadrature(problem);
    const auto bound = plan::degree_bound(problem);
    paths.each([&](Backend& backend) {
      check_at_most(compare_by_bound(moments(backend, problem), expected, bound).worst, 1e-14, backend.facts().name);
    });
  }
}

TEST_CASE("a tessellated ellipsoid converges to the closed form with order 2", "[moments][exact]") {
  // S_20 = sqrt(5/16 pi) (2 z^2 - x^2 - y^2), S_22 = sqrt(15/32 pi) (x + iy)^2; the mean of x^2 is a^2/5.
  const double a = 1.1, b = 0.7, c = 0.9;
  const double volume = 4 * std::numbers::pi / 3 * a * b * c;
  const double expected[3] = {volume / std::sqrt(4 * std::numbers::pi),
                              std::sqrt(5 / (16 * std::numbers::pi)) * volume / 5 * (2 * c * c - a * a - b * b),
                              std::sqrt(15 / (32 * std::numbers::pi)) * volume / 5 * (a * a - b * b)};
  Paths paths;
  paths.each([&](Backend& backend) {
    INFO(backend.facts().name);
    std::array<std::array<double, 6>, 3> value{};
    for (std::size_t level = 1; level < 6; ++level) {
      const RawMesh mesh = scaled(icosphere(int(level)), {a, b, c});
      MomentProblem problem = moment_problem(mesh, 2);
      problem.reference_radius = 1.25;
      const Multipoles q = moments(backend, problem);
      const double square = 1.25 * 1.25;
      value[0][level] = q(0, 0).real();
      value[1][level] = q(2, 0).real() * square;
      value[2][level] = q(2, 2).real() * square;
      check_at_most(std::abs(q(2, 2).imag()) + std::abs(q(2, 1)), 2e-17, "what the planes of symmetry forbid");
    }
    for (std::size_t k = 0; k < 3; ++k) {
      auto v = value[k];
      CHECK(std::log2((v[4] - expected[k]) / (v[5] - expected[k])) == Approx(2).margin(0.02));
      // Errors have a series in 4^-level.
      for (std::size_t power = 1; power < 5; ++power)
        for (std::size_t level = 5; level > power; --level)
          v[level] += (v[level] - v[level - 1]) / (std::pow(4.0, double(power)) - 1);
      check_at_most(std::abs(v[5] / expected[k] - 1), 1e-9, "extrapolated");
    }
  });
}

TEST_CASE("a tessellated ball has the mass of a ball and no other moment that its symmetry forbids",
          "[moments][exact]") {
  Paths paths;
  const RawMesh mesh = icosphere(3);
  const MomentProblem problem = moment_problem(mesh, 12);
  paths.each([&](Backend& backend) {
    INFO(backend.facts().name);
    const Multipoles q = moments(backend, problem);
    // The icosahedron's group has invariants of degrees 0, 6, 10, 12 up to here.
    for (const int l : {1, 2, 3, 4, 5, 7, 8, 9, 11})
      check_at_most(degree_norm(q, l), 4e-16, fmt::format("degree {}", l));
    CHECK(degree_norm(q, 6) >= 1e-6);
  });
}

TEST_CASE("80-bit and 113-bit references agree", "[moments][exact]") {
  const RawMesh mesh = together(two_shells(), shell_with_cavity());
  MomentProblem problem = moment_problem(mesh, 64, {0.1, 0.2, -0.3});
  problem.density = 3;
  const auto wide = reference::moments<mp::float128>(problem);
  const auto reference = reference::moments<long double>(problem);
  const auto plain = reference::moments<double>(problem);
  const auto bound = plan::degree_bound(problem);
  // Differences are taken in 113 bits: an 80-bit copy of the wide one would cost as much as is measured.
  const auto worst = [&](const auto& values) {
    double largest = 0;
    for (int l = 0; l <= problem.lmax; ++l) {
      mp::float128 difference = 0, square = 0;
      for (int m = 0; m <= l; ++m)
        for (const int part : {0, 1}) {
          const std::size_t i = 2 * Multipoles::index(problem.lmax, l, m) + std::size_t(part);
          const mp::float128 apart = mp::float128(values[i]) - wide[i];
          difference += apart * apart;
          square += wide[i] * wide[i];
        }
      const double scale = std::max(double(sqrt(square)), 1e-3 * bound[std::size_t(l)]);
      largest = std::max(largest, double(sqrt(difference)) / scale);
    }
    return largest;
  };
  check_at_most(worst(reference), 8e-18, "80 bits");
  check_at_most(worst(plain), 2.4e-14, "64 bits");
  // Leaving out what is negligible is bounded as it says.
  const auto cut = reference::moments<long double>(problem, 1e-10);
  for (int l = 0; l <= problem.lmax; ++l)
    for (int m = 0; m <= l; ++m)
      for (const int part : {0, 1}) {
        const std::size_t i = 2 * Multipoles::index(problem.lmax, l, m) + std::size_t(part);
        REQUIRE(std::abs(cut[i] - reference[i]) <= 1e-10 * bound[std::size_t(l)]);
      }
}

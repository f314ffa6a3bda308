#include "host/geometry/orientation.hpp"

#include <boost/multiprecision/cpp_int.hpp>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>

using namespace cowgpu;

namespace {

int rational_sign(const Vec3& a, const Vec3& b, const Vec3& c) {
  using Rational = boost::multiprecision::cpp_rational;
  Rational sum = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    sum += Rational(a[i]) * (Rational(b[j]) * Rational(c[k]) - Rational(b[k]) * Rational(c[j]));
  }
  return sum.sign();
}

void check_triple(const Vec3& a, const Vec3& b, const Vec3& c) {
  INFO(a.transpose() << " | " << b.transpose() << " | " << c.transpose());
  const int sign = rational_sign(a, b, c);
  REQUIRE(orientation(a, b, c) == sign);
  REQUIRE(orientation_exact(a, b, c) == sign);
  REQUIRE(orientation(b, c, a) == sign);
  REQUIRE(orientation(b, a, c) == -sign);
}

} // namespace

TEST_CASE("orientation of nearly coplanar triples is that of rational arithmetic", "[orientation]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
  int seen[3] = {};
  for (int i = 0; i < 3000; ++i) {
    const Vec3 a = vector().normalized(), b = vector().normalized();
    // On the great circle of a and b but for rounding, and next to one of its ends.
    const Vec3 c = (uniform(random) * a + uniform(random) * b).normalized();
    check_triple(a, b, c);
    check_triple(a, b, a + std::ldexp(1.0, -20 - i % 40) * (c - a));
    ++seen[orientation(a, b, c) + 1];
  }
  CHECK(seen[0] > 500);
  CHECK(seen[2] > 500);
}

TEST_CASE("orientation of tiny spherical triangles is that of rational arithmetic", "[orientation]") {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 3000; ++i) {
    const double size = std::ldexp(1.0, -i % 60);
    const auto corner = [&] {
      return Vec3(size * uniform(random), size * uniform(random), 1 + size * uniform(random)).normalized();
    };
    const Vec3 a = corner(), b = corner(), c = corner();
    check_triple(a, b, c);
    check_triple({a.z(), a.x(), a.y()}, {b.z(), b.x(), b.y()}, {c.z(), c.x(), c.y()});
  }
}

TEST_CASE("orientation of integer triples, many of them coplanar, is that of rational arithmetic", "[orientation]") {
  std::mt19937 random(9);
  std::uniform_int_distribution<int> uniform(-2, 2);
  int zeros = 0;
  for (int i = 0; i < 3000; ++i) {
    Vec3 v[3];
    for (Vec3& p : v) p = Vec3(uniform(random), uniform(random), uniform(random));
    check_triple(v[0], v[1], v[2]);
    zeros += orientation(v[0], v[1], v[2]) == 0;
  }
  CHECK(zeros > 300);
}

TEST_CASE("orientation neither underflows nor overflows", "[orientation]") {
  std::mt19937 random(10);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::uniform_int_distribution<int> exponent(-1074, 1023);
  for (int i = 0; i < 3000; ++i) {
    Vec3 v[3];
    for (Vec3& p : v)
      for (double& x : p) x = i % 7 == 0 && uniform(random) < 0 ? 0 : std::ldexp(uniform(random), exponent(random));
    check_triple(v[0], v[1], v[2]);
  }
  const double least = std::ldexp(1.0, -1074), most = std::ldexp(1.0, 1023);
  check_triple({least, 0, 0}, {0, least, 0}, {0, 0, least});
  check_triple({most, 0, 0}, {0, -most, 0}, {0, 0, most});
  check_triple({most, most, least}, {most, most, 0}, {most, least, most});
}

TEST_CASE("the side of a plane is that of rational arithmetic, for points in it and next to it", "[orientation]") {
  using Rational = boost::multiprecision::cpp_rational;
  std::mt19937 random(17);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
  int seen[3] = {};
  for (int i = 0; i < 3000; ++i) {
    Vec3 a = vector(), b = vector(), c = vector();
    if (i % 3 == 0) // coordinates of few bits, so that planes hold points exactly
      for (Vec3* v : {&a, &b, &c})
        for (int k = 0; k < 3; ++k) (*v)[k] = std::round(4 * (*v)[k]);
    const double u = i % 3 ? uniform(random) : std::round(2 * uniform(random)), w = i % 2 ? 0.5 : 2;
    Vec3 p = a + u * (b - a) + w * (c - a);
    if (i % 5 == 0) p[i % 3] = std::nextafter(p[i % 3], 2.0);
    Rational d[3][3], sum = 0;
    const Vec3* corners[3] = {&a, &b, &c};
    for (int row = 0; row < 3; ++row)
      for (int k = 0; k < 3; ++k) d[row][k] = Rational((*corners[row])[k]) - Rational(p[k]);
    for (int k = 0; k < 3; ++k) {
      const int m = (k + 1) % 3, n = (k + 2) % 3;
      sum += d[0][k] * (d[1][m] * d[2][n] - d[1][n] * d[2][m]);
    }
    const int sign = sum.sign();
    REQUIRE(side_of_plane(a, b, c, p) == sign);
    REQUIRE(side_of_plane_exact(a, b, c, p) == sign);
    REQUIRE(side_of_plane(b, a, c, p) == -sign);
    ++seen[sign + 1];
  }
  CHECK(std::min({seen[0], seen[1], seen[2]}) > 300);
}

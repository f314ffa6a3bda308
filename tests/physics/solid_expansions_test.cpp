#include "host/plan/polyhedron_far.hpp"
#include "host/plan/polyhedron_moments_kernel.hpp"
#include "host/plan/solid_sums_kernel.hpp"
#include "host/plan/translations.hpp"
#include "host/reference/solid_expansions.hpp"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>

using namespace cowgpu;
using namespace cowgpu::plan;

namespace {

using Reference = reference::SolidExpansions<long double>;
using LongVector = Reference::Vector;

std::vector<double> noise(std::mt19937& random, std::size_t count) {
  std::normal_distribution<double> normal;
  std::vector<double> made(count);
  for (double& x : made) x = normal(random);
  return made;
}

Vec3 some_vector(std::mt19937& random) {
  const std::vector<double> x = noise(random, 3);
  return {x[0], x[1], x[2]};
}

Reference::Coefficients density(const std::vector<double>& of, std::size_t q, std::size_t size) {
  Reference::Coefficients one(size);
  for (std::size_t k = 0; k < size; ++k) one[k] = of[densities * k + q];
  return one;
}

Reference::Coefficients moved(const Reference& at, Translation kind, const Reference::Coefficients& from,
                              const Vec3& shift) {
  const LongVector by = shift.cast<long double>();
  if (kind == Translation::multipole_to_local) return at.multipole_to_local(from, by);
  return kind == Translation::multipole_to_multipole ? at.multipole_to_multipole(from, by)
                                                     : at.local_to_local(from, by);
}

struct alignas(64) Line {
  double values[8];
};

} // namespace

TEST_CASE("exchanging x and z turns harmonics into each other by the matrices", "[solid_expansions]") {
  const int top = largest_expansion_order;
  const HarmonicFactors& factors = harmonic_factors();
  const Reference reference(top);
  const LongVector x(0.3L, -0.5L, 0.7L);
  const auto straight = reference.regular(x), exchanged = reference.regular(LongVector(x[2], x[1], x[0]));
  for (int l = 0; l <= top; ++l)
    for (int k = 0; k <= l; ++k) {
      long double cosine = 0, sine = 0;
      for (int m = 0; m <= l; ++m) {
        const auto at = std::size_t(m * (l + 1) + k);
        cosine += factors.cosines[std::size_t(l)][at] * straight[cosine_index(l, m)];
        if (m > 0 && k > 0) sine += factors.sines[std::size_t(l)][at] * straight[sine_index(l, m)];
      }
      const long double scale = std::pow(x.norm(), l);
      CHECK(double(std::abs(cosine - exchanged[cosine_index(l, k)]) / scale) < 2e-16);
      if (k > 0) CHECK(double(std::abs(sine - exchanged[sine_index(l, k)]) / scale) < 2e-16);
    }
}

TEST_CASE("translations are those of plain sums, in any number of pairs", "[solid_expansions]") {
  std::mt19937 random(1);
  for (const int top : {0, 1, 7, 12}) {
    const Translations translations(top);
    Translations::Room room(top);
    const std::size_t size = densities * harmonics(top);
    for (const auto kind :
         {Translation::multipole_to_local, Translation::multipole_to_multipole, Translation::local_to_local})
      for (const int order : {0, 1, 2, 5, 12}) {
        if (order > top || (kind != Translation::multipole_to_local && order != top)) continue;
        for (const std::size_t count : {1, 7, 13}) {
          std::vector<std::vector<double>> from, to(count, std::vector<double>(size));
          std::vector<Vec3> shifts;
          std::vector<TranslationPair> pairs;
          for (std::size_t i = 0; i < count; ++i) {
            from.push_back(noise(random, size));
            shifts.push_back(i == 3   ? Vec3(0, 0, 1.5)
                             : i == 4 ? Vec3(0, 0, -1)
                             : i == 5 ? Vec3(1, 0, 0)
                                      : some_vector(random));
            if (i == 6 && kind != Translation::multipole_to_local) shifts.back() = Vec3::Zero();
          }
          for (std::size_t i = 0; i < count; ++i) pairs.push_back({from[i].data(), to[i].data(), shifts[i]});
          translations.add(kind, order, pairs, room);
          const Reference reference(order);
          double worst = 0;
          for (std::size_t i = 0; i < count; ++i)
            for (std::size_t q = 0; q < densities; ++q) {
              const auto expected = moved(reference, kind, density(from[i], q, reference.size()), shifts[i]);
              long double largest = 0;
              for (const auto& x : expected) largest = std::max(largest, std::abs(x));
              for (std::size_t k = 0; k < expected.size(); ++k)
                worst = std::max(worst, double(std::abs(expected[k] - to[i][densities * k + q]) / largest));
            }
          INFO("kind " << int(kind) << ", order " << order << ", pairs " << count);
          CHECK(worst < 3e-14);
        }
      }
  }
}

TEST_CASE("several pairs may have one target", "[solid_expansions]") {
  std::mt19937 random(2);
  const int order = 6;
  const Translations translations(order);
  Translations::Room room(order);
  const std::size_t size = densities * harmonics(order);
  const auto first = noise(random, size), second = noise(random, size);
  std::vector<double> together(size), apart(size);
  const std::vector<TranslationPair> pairs = {{first.data(), together.data(), Vec3(1, 2, 3)},
                                              {second.data(), together.data(), Vec3(3, -2, 1)}};
  translations.add(Translation::multipole_to_local, order, pairs, room);
  for (TranslationPair pair : pairs) {
    pair.to = apart.data();
    translations.add(Translation::multipole_to_local, order, std::span(&pair, 1), room);
  }
  CHECK(together == apart);
}

TEST_CASE("moments of triangles are those of a quadrature that is exact for them", "[solid_expansions]") {
  std::mt19937 random(3);
  const int order = 12;
  const Reference reference(order);
  const Vec3 centre(0.1, -0.2, 0.3);
  for (const std::size_t count : {1, 7, 13, 70}) {
    std::vector<FaceGroup> groups((count + face_group - 1) / face_group);
    std::vector<long double> expected(densities * harmonics(order));
    for (std::size_t i = 0; i < face_group * groups.size(); ++i) {
      const Vec3 a = some_vector(random), b = some_vector(random), c = some_vector(random);
      const Vec3 normal = i < count ? Vec3((b - a).cross(c - a)) : Vec3(Vec3::Zero());
      FaceGroup& group = groups[i / face_group];
      const std::size_t lane = i % face_group;
      for (int k = 0; k < 3; ++k) {
        group.a[k][lane] = a[k];
        group.b[k][lane] = b[k];
        group.c[k][lane] = c[k];
        group.weights[k][lane] = normal[k];
      }
      group.weights[3][lane] = normal.dot(a);
      group.area[lane] = normal.norm() / 2;
      if (i >= count) continue;
      const auto see = [&](const Vec3& x) { return LongVector((x - centre).cast<long double>()); };
      const auto of_one = reference.triangle(see(a), see(b), see(c));
      for (std::size_t h = 0; h < of_one.size(); ++h)
        for (std::size_t q = 0; q < densities; ++q)
          expected[densities * h + q] += of_one[h] * (q < 3 ? normal[Eigen::Index(q)] : normal.dot(a)) / normal.norm();
    }
    std::vector<Line> room(moment_room(order) / 8 + 1);
    std::vector<double> moments(densities * harmonics(order));
    add_face_moments(groups, centre, order, room.front().values, moments.data());
    for (int l = 0; l <= order; ++l) {
      long double largest = 0, apart = 0;
      for (std::size_t k = densities * std::size_t(l * l); k < densities * harmonics(l); ++k) {
        largest = std::max(largest, std::abs(expected[k]));
        apart = std::max(apart, std::abs(expected[k] - moments[k]));
      }
      INFO("degree " << l << ", faces " << count);
      CHECK(double(apart) < 1e-13 * double(largest));
    }
    const FaceReach reach = face_reach(groups, centre, 5);
    double radius = 0, moment = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const FaceGroup& group = groups[i / face_group];
      double farthest = 0;
      for (const auto* corner : {&group.a, &group.b, &group.c}) {
        Vec3 x;
        for (int k = 0; k < 3; ++k) x[k] = (*corner)[k][i % face_group] - centre[k];
        farthest = std::max(farthest, x.norm());
      }
      radius = std::max(radius, farthest);
      moment += group.area[i % face_group] * std::pow(farthest, 5);
    }
    CHECK(reach.radius == Approx(radius).epsilon(1e-14));
    CHECK(reach.moment == Approx(moment).epsilon(1e-13));
  }
}

TEST_CASE("expansions and their derivatives are summed at points", "[solid_expansions]") {
  std::mt19937 random(4);
  const int order = 9;
  const Reference reference(order);
  const std::size_t size = harmonics(order), count = 16;
  const auto coefficients = noise(random, densities * size);
  std::vector<Line> lines(3 * count / 8);
  double* points = lines.front().values;
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < count; ++i) {
    places.push_back(some_vector(random));
    for (std::size_t k = 0; k < 3; ++k) points[k * count + i] = places[i][Eigen::Index(k)];
  }
  std::vector<Reference::Coefficients> each;
  for (std::size_t q = 0; q < densities; ++q) each.push_back(density(coefficients, q, size));
  // d_j A_i by differences in long double; their error is about step^2.
  const auto derivative = [&](bool local, std::size_t i, int j, const Vec3& x) {
    const long double step = 1e-6L;
    LongVector by = LongVector::Zero();
    by[j] = step;
    const LongVector at = x.cast<long double>();
    const auto field = [&](const LongVector& y) {
      return local ? reference.at(each[i], y) : reference.far(each[i], y);
    };
    return (field(at + by) - field(at - by)) / (2 * step);
  };
  for (const bool local : {true, false})
    for (const std::size_t sets : {5, 10}) {
      std::vector<double> derived(sets * harmonics(order + 1)), sums(sets * count), scale(count, 1);
      if (local)
        derive_locals(order, coefficients.data(), sets, derived.data());
      else
        derive_multipoles(order, coefficients.data(), sets, derived.data());
      std::vector<Line> seen = lines;
      double* y = seen.front().values;
      for (std::size_t i = 0; i < count && !local; ++i) {
        for (std::size_t k = 0; k < 3; ++k) y[k * count + i] /= places[i].squaredNorm();
        scale[i] = 1 / places[i].norm();
      }
      sum_harmonics(local ? order : order + 1, sets, derived.data(), y, count, sums.data());
      for (std::size_t i = 0; i < count; ++i) {
        const auto value = [&](std::size_t set) { return sums[set * count + i] * scale[i]; };
        const LongVector x = places[i].cast<long double>();
        const double size_here = std::pow(std::max(1.0, local ? places[i].norm() : 1 / places[i].norm()), order + 2);
        for (std::size_t q = 0; q < densities; ++q)
          CHECK(std::abs(value(q) - double(local ? reference.at(each[q], x) : reference.far(each[q], x))) <
                1e-13 * size_here);
        if (sets == 5) {
          const long double divergence = derivative(local, 0, 0, places[i]) + derivative(local, 1, 1, places[i]) +
                                         derivative(local, 2, 2, places[i]);
          CHECK(std::abs(value(4) - double(divergence)) < 1e-8 * size_here);
          continue;
        }
        std::size_t set = 4;
        for (std::size_t a = 0; a < 3; ++a)
          for (int b = int(a); b < 3; ++b, ++set)
            CHECK(std::abs(value(set) - double(derivative(local, a, b, places[i]))) < 1e-8 * size_here);
      }
    }
}

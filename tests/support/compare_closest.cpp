#include "tests/support/compare_closest.hpp"

#include "host/mesh/geometry.hpp"
#include "host/reference/closest.hpp"

#include <boost/multiprecision/float128.hpp>
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace cowgpu::test {
namespace {

// Needles lose digits: their normals are short.
using Quad = boost::multiprecision::float128;

bool holds(const Face& face, std::uint32_t vertex) {
  return std::find(face.begin(), face.end(), vertex) != face.end();
}

// The least face with the feature.
std::uint32_t least_face(const RawMesh& mesh, const SurfaceFeature& feature) {
  if (feature.kind == SurfaceFeature::Kind::face) return feature.first;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f)
    if (holds(mesh.faces[f], feature.first) && holds(mesh.faces[f], feature.second)) return f;
  return no_face;
}

// The barycentric coordinates' corners are those of the feature, or there is a message.
std::string misplaced(const RawMesh& mesh, const SurfaceFeature& feature, std::uint32_t face, const Vec3& weights) {
  if (least_face(mesh, feature) != face) return "not the least face";
  if (!(weights.minCoeff() >= 0) || !(std::abs(weights.sum() - 1) <= 4e-16)) return "weights are no partition of one";
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t v = mesh.faces[face][std::size_t(k)];
    const bool on = feature.kind == SurfaceFeature::Kind::face || v == feature.first || v == feature.second;
    if (!on && weights[k] != 0) return "weight off the feature";
  }
  if (feature.kind == SurfaceFeature::Kind::vertex && weights.maxCoeff() != 1) return "vertex without weight 1";
  return {};
}

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
}

} // namespace

double diagonal(const RawMesh& mesh) {
  const Box box = bounding_box(mesh.vertices, mesh.faces);
  return (box.max - box.min).norm();
}

ClosestPoints closest(Backend& backend, const RawMesh& mesh, const std::vector<Vec3>& queries, bool with_sign) {
  Monitor silent;
  return backend.distance_field(mesh.vertices, mesh.faces)->closest(queries, {with_sign}, silent);
}

int winding_reference(const RawMesh& mesh, const Vec3& query) {
  return int(std::lround(double(reference::winding_number<Quad>(mesh.vertices, mesh.faces, query))));
}

void compare_closest(Paths& paths, const RawMesh& mesh, const std::vector<Vec3>& queries, double figure,
                     bool with_sign) {
  struct Truth {
    double distance;
    int winding;
    bool on_surface;
  };
  std::vector<Truth> truth;
  const double size = diagonal(mesh);
  for (const Vec3& q : queries) {
    const double distance = double(sqrt(reference::closest<Quad>(mesh.vertices, mesh.faces, q).distance2));
    // Nearer the reference does not tell the sides apart.
    const bool on_surface = distance < 1e-25 * (size + q.norm());
    truth.push_back({distance, with_sign ? winding_reference(mesh, q) : 0, on_surface});
  }
  ClosestPoints first;
  paths.each([&](Backend& backend) {
    INFO(backend.facts().type << ", " << mesh.faces.size() << " faces, " << queries.size() << " queries");
    const ClosestPoints found = closest(backend, mesh, queries, with_sign);
    REQUIRE(found.size() == queries.size());
    REQUIRE((found.point.size() == queries.size() && found.face.size() == queries.size() &&
             found.barycentric.size() == queries.size() && found.feature.size() == queries.size()));
    REQUIRE(found.winding.size() == (with_sign ? queries.size() : 0));
    double worst = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const Vec3 &q = queries[i], &point = found.point[i];
      INFO(fmt::format("query {} ({}, {}, {})", i, q.x(), q.y(), q.z()));
      const double d = std::abs(found.distance[i]), scale = size + truth[i].distance;
      REQUIRE(found.face[i] < mesh.faces.size());
      const Face& face = mesh.faces[found.face[i]];
      Vec3 placed = Vec3::Zero();
      for (int k = 0; k < 3; ++k) placed += found.barycentric[i][k] * mesh.vertices[face[std::size_t(k)]];
      const double errors[] = {std::abs(d - truth[i].distance) / scale,
                               std::abs((q - point).norm() - d) / (scale + q.norm()),
                               (placed - point).norm() / (size + point.norm())};
      for (const double error : errors)
        if (!(error <= worst)) worst = error;
      const std::string wrong = misplaced(mesh, found.feature[i], found.face[i], found.barycentric[i]);
      if (!wrong.empty()) FAIL_CHECK(wrong);
      if (!with_sign) {
        if (found.distance[i] < 0) FAIL_CHECK("a negative distance without sign");
      } else if (!truth[i].on_surface) {
        if (found.winding[i] != truth[i].winding)
          FAIL_CHECK(fmt::format("winding number {} in place of {}, distance {}", found.winding[i], truth[i].winding,
                                 truth[i].distance));
        if (d > 0 && (found.distance[i] < 0) != (truth[i].winding > 0)) FAIL_CHECK("the wrong sign");
      }
    }
    check_at_most(worst, figure, "distances and points");
    if (first.size() == 0) first = found;
    CHECK((same(found.distance, first.distance) && same(found.point, first.point) && same(found.face, first.face) &&
           same(found.barycentric, first.barycentric) && same(found.feature, first.feature) &&
           same(found.winding, first.winding)));
  });
}

std::vector<Vec3> queries_in_box(const RawMesh& mesh, std::size_t count, double factor, std::uint32_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  const Box box = bounding_box(mesh.vertices, mesh.faces);
  std::vector<Vec3> queries(count);
  for (Vec3& q : queries)
    for (int c = 0; c < 3; ++c) q[c] = box.middle()[c] + factor * (box.max - box.min)[c] * uniform(random);
  return queries;
}

std::vector<Vec3> queries_near_surface(const RawMesh& mesh, std::size_t count, double deviation, std::uint32_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, deviation * diagonal(mesh));
  std::vector<Vec3> queries(count);
  for (Vec3& q : queries) {
    const Face& f = mesh.faces[std::size_t(uniform(random) * double(mesh.faces.size()))];
    double u = uniform(random), v = uniform(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    q = (1 - u - v) * mesh.vertices[f[0]] + u * mesh.vertices[f[1]] + v * mesh.vertices[f[2]];
    for (int c = 0; c < 3; ++c) q[c] += normal(random);
  }
  return queries;
}

std::vector<Vec3> queries_at_edges(const RawMesh& mesh, std::size_t count, std::uint32_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3> queries;
  const double size = diagonal(mesh);
  const double shifts[] = {0, 1e-15, 1e-9};
  for (std::size_t i = 0; queries.size() < count; ++i) {
    const Face& f = mesh.faces[random() % mesh.faces.size()];
    const Vec3 &a = mesh.vertices[f[0]], &b = mesh.vertices[f[1]];
    const double along = i % 2 ? uniform(random) : 0;
    const Vec3 shift(uniform(random) - 0.5, uniform(random) - 0.5, uniform(random) - 0.5);
    queries.push_back(a + along * (b - a) + shifts[i / 2 % 3] * size * shift);
  }
  return queries;
}

} // namespace cowgpu::test

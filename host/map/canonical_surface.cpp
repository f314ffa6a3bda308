#include "host/map/canonical_surface.hpp"

#include "host/error.hpp"
#include "host/mesh/half_edges.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace cowgpu {
namespace {

using Rings = std::vector<std::vector<std::uint32_t>>;
using Key = std::array<double, 3>;

Key key_of(const Vec3& p) {
  return {p[0], p[1], p[2]};
}

// Vertices numbered by `order` instead; order[new] = old.
Rings renumbered(Rings&& rings, const std::vector<std::uint32_t>& order, std::size_t old_count) {
  std::vector<std::uint32_t> number(old_count);
  for (std::uint32_t k = 0; k < order.size(); ++k) number[order[k]] = k;
  Rings result(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    auto& ring = result[k] = std::move(rings[order[k]]);
    for (std::uint32_t& v : ring) v = number[v];
    std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
  }
  return result;
}

// By coordinates as they stand, and where those coincide by the neighbours'.
void sort_by_coordinates(std::vector<std::uint32_t>& order, const std::vector<Vec3>& points, const Rings& rings) {
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Key ka = key_of(points[a]), kb = key_of(points[b]);
    return ka != kb ? ka < kb : a < b;
  });
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && points[order[end]] == points[order[begin]]) ++end;
    if (end - begin == 1) continue;
    std::vector<std::pair<std::vector<Key>, std::uint32_t>> coincident;
    for (std::size_t i = begin; i < end; ++i) {
      std::vector<Key> neighbours;
      for (const std::uint32_t v : rings[order[i]]) neighbours.push_back(key_of(points[v]));
      std::sort(neighbours.begin(), neighbours.end());
      coincident.emplace_back(std::move(neighbours), order[i]);
    }
    std::sort(coincident.begin(), coincident.end());
    for (std::size_t i = begin; i < end; ++i) order[i] = coincident[i - begin].second;
  }
}

// Area 4 pi, its centroid at the origin.
void normalise(std::vector<Vec3>& points, const Rings& rings) {
  double area = 0;
  Vec3 moment = Vec3::Zero();
  for_each_face(rings, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const double twice = (points[b] - points[a]).cross(points[c] - points[a]).norm();
    area += twice / 2;
    moment += twice / 6 * (points[a] + points[b] + points[c]);
  });
  if (!(area > 0))
    throw Error(Fault::mesh_no_volume, "the surface's area is zero in double precision, so nothing of it can be mapped "
                                       "to the sphere: check the file's coordinates");
  const Vec3 centroid = moment / area;
  const double scale = std::sqrt(4 * std::numbers::pi / area);
  for (Vec3& p : points) p = (p - centroid) * scale;
}

// Coordinates along the principal axes of the area, rounded.
std::vector<Key> pose_keys(const std::vector<Vec3>& points, const Rings& rings) {
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  const auto for_weighted_centroids = [&](auto&& f) {
    for_each_face(rings, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      f((points[b] - points[a]).cross(points[c] - points[a]).norm(), (points[a] + points[b] + points[c]) / 3);
    });
  };
  for_weighted_centroids([&](double w, const Vec3& p) { second += w * p * p.transpose(); });
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(second);
  Vec3 skewness = Vec3::Zero();
  for_weighted_centroids(
      [&](double w, const Vec3& p) { skewness += w * (axes.eigenvectors().transpose() * p).array().cube().matrix(); });
  Vec3 directed;
  for (int k = 0; k < 3; ++k) directed[k] = skewness[k] < 0 ? -1 : 1;
  double size = 0;
  for (const Vec3& p : points) size = std::max(size, p.lpNorm<Eigen::Infinity>());
  std::vector<Key> keys;
  keys.reserve(points.size());
  for (const Vec3& p : points) {
    const Vec3 q = directed.cwiseProduct(axes.eigenvectors().transpose() * p) * (0x1p24 / size);
    keys.push_back({std::round(q[2]), std::round(q[1]), std::round(q[0])}); // the longest axis first
  }
  return keys;
}

} // namespace

CanonicalSurface canonical_surface(const ManifoldSurface& surface) {
  const auto& vertices = surface.vertices();
  const auto& faces = surface.faces();
  const HalfEdges half_edges(surface);
  Rings rings(vertices.size());
  std::vector<std::uint32_t> order;
  Vec3 low = vertices[faces[0][0]], high = low;
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    rings[v] = half_edges.ring(faces, v);
    if (rings[v].empty()) continue;
    order.push_back(v);
    low = low.cwiseMin(vertices[v]);
    high = high.cwiseMax(vertices[v]);
  }
  sort_by_coordinates(order, vertices, rings);

  // To size one by a power of two, so that no product leaves the range of doubles and scales of two change no bit.
  const double unit = std::ldexp(1.0, -std::ilogb((high - low).maxCoeff()));
  const Vec3 middle = low / 2 + high / 2;
  CanonicalSurface result;
  result.original = order;
  for (const std::uint32_t v : order) result.points.push_back((vertices[v] - middle) * unit);
  result.rings = renumbered(std::move(rings), order, vertices.size());
  normalise(result.points, result.rings);

  const std::vector<Key> keys = pose_keys(result.points, result.rings);
  std::vector<std::uint32_t> posed(order.size());
  std::iota(posed.begin(), posed.end(), 0U);
  std::stable_sort(posed.begin(), posed.end(), [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
  std::vector<Vec3> points;
  for (std::size_t k = 0; k < posed.size(); ++k) {
    points.push_back(result.points[posed[k]]);
    result.original[k] = order[posed[k]];
  }
  result.points = std::move(points);
  result.rings = renumbered(std::move(result.rings), posed, posed.size());
  return result;
}

} // namespace cowgpu

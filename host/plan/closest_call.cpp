#include "host/plan/closest_call.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/geometry/morton.hpp"
#include "host/parallel.hpp"
#include "host/plan/closest_query.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace cowgpu::plan {
namespace {

// Balls about two queries that reach the surface hold no face inside. Where they overlap, the winding numbers are equal.
// `extent` of the surface, by which distances are rounded.
bool same_winding(const Vec3& p, double p_distance, const Vec3& q, double q_distance, double extent) {
  return (p - q).norm() < (p_distance + q_distance) * (1 - 1e-12) - 1e-13 * extent;
}

} // namespace

std::uint64_t distance_field_bytes(std::uint64_t vertices, std::uint64_t faces, std::uint64_t queries) {
  constexpr std::uint64_t one = 2 * sizeof(double) + 2 * sizeof(Vec3) + sizeof(SurfaceFeature) + 8;
  return ClosestTree::bytes(faces, vertices) + queries * (one + 20);
}

ClosestCall::ClosestCall(const ClosestTree& tree, std::span<const Vec3> queries, const ClosestOptions& options,
                         unsigned threads)
    : tree_(tree), queries_(queries), threads_(threads), start_(Clock::now()) {
  check_queries(queries);
  if (options.with_sign && !tree.closed)
    throw Error(Fault::mesh_open, "the surface has edges that are not run as often one way as the other, so it has no "
                                  "inside; ask for distances without sign");
  if (queries.size() >= no_face)
    throw Error(Fault::too_large,
                fmt::format("{} queries are too many at once; fewer than 2^32 are possible", queries.size()));
  result_.distance.resize(queries.size());
  result_.point.resize(queries.size());
  result_.face.resize(queries.size());
  result_.barycentric.resize(queries.size());
  result_.feature.resize(queries.size());
  if (options.with_sign) result_.winding.resize(queries.size());
  const auto before = Clock::now();
  const Vec3 side = tree.high - tree.low;
  order_ = morton_order(queries, tree.low - side / 2, tree.high + side / 2, threads);
  sort_seconds_ = seconds_since(before);
}

void ClosestCall::each_part(std::size_t begin, std::size_t end, Monitor& monitor, const FindFaces& find) {
  const std::size_t tasks = (end - begin + part - 1) / part;
  parallel_for(threads_, tasks, [&](std::size_t task, unsigned thread) {
    check_stop(monitor);
    const std::size_t first = begin + task * part;
    if (thread == 0) monitor.progress("closest points", double(first) / double(order_.size()));
    answer(std::span(order_).subspan(first, std::min(part, end - first)), first, find);
  });
  if (end == order_.size()) monitor.progress("closest points", 1);
}

ClosestPoints ClosestCall::finish(ClosestReport* report) {
  if (report) *report = {seconds_since(start_), sort_seconds_, rays_, {}};
  return std::move(result_);
}

void ClosestCall::answer(std::span<const std::uint32_t> ids, std::size_t first, const FindFaces& find) {
  std::array<Vec3, part> points;
  std::array<double, part> distances;
  std::array<std::uint32_t, part> faces;
  for (std::size_t i = 0; i < ids.size(); ++i) points[i] = queries_[ids[i]];
  find(std::span(points).first(ids.size()), first, faces.data());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const SurfacePoint found = tree_.on_face(faces[i], points[i]);
    const std::size_t to = ids[i];
    distances[i] = result_.distance[to] = found.distance;
    result_.point[to] = found.point;
    result_.face[to] = found.face;
    result_.barycentric[to] = found.barycentric;
    result_.feature[to] = found.feature;
  }
  if (!result_.winding.empty()) rays_ += set_signs(std::span(points).first(ids.size()), distances.data(), ids);
}

// Returns how many took a ray.
std::uint64_t ClosestCall::set_signs(std::span<const Vec3> points, const double* distances,
                                     std::span<const std::uint32_t> ids) {
  constexpr std::size_t neighbours = 4;
  const double extent = 2 / tree_.scale;
  std::uint64_t rays = 0;
  std::array<int, part> winding;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    std::size_t near = i;
    for (std::size_t j = i; j > 0 && i - j < neighbours; --j)
      if (same_winding(points[j - 1], distances[j - 1], points[i], distances[i], extent)) {
        near = j - 1;
        break;
      }
    if (near < i) {
      winding[i] = winding[near];
    } else {
      winding[i] = winding_number(tree_, points[i]);
      ++rays;
    }
    result_.winding[ids[i]] = winding[i];
    if (winding[i] > 0) result_.distance[ids[i]] = -distances[i];
  }
  return rays;
}

} // namespace cowgpu::plan

#include "host/cpu/closest.hpp"

#include "host/clock.hpp"
#include "host/cpu/closest_kernel.hpp"
#include "host/error.hpp"
#include "host/orientation.hpp"
#include "host/parallel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

namespace cowgpu::cpu {
namespace {

constexpr std::size_t packets_together = 64, together = packets_together * packet;

bool is_far(const plan::ClosestTree& tree, const Vec3& p) {
  return ((p - tree.centre) * tree.scale).cwiseAbs().maxCoeff() > plan::closest_far;
}

// Balls about two queries that reach the surface hold no face inside. Where they overlap, the winding numbers are equal.
// `extent` of the surface, by which distances are rounded.
bool same_winding(const Vec3& p, double p_distance, const Vec3& q, double q_distance, double extent) {
  return (p - q).norm() < (p_distance + q_distance) * (1 - 1e-12) - 1e-13 * extent;
}

class CpuDistanceField final : public DistanceField {
public:
  CpuDistanceField(std::span<const Vec3> vertices, std::span<const Face> faces, unsigned threads)
      : tree_(vertices, faces), threads_(threads ? threads : all_threads()) {}

  ClosestPoints closest(std::span<const Vec3> queries, const ClosestOptions& options, Monitor& monitor,
                        ClosestReport* report) override {
    const auto start = Clock::now();
    check_queries(queries);
    if (options.with_sign && !tree_.closed)
      throw Error(Fault::mesh_open,
                  "the surface has edges that are not run as often one way as the other, so it has no "
                  "inside; ask for distances without sign");
    if (queries.size() >= no_face)
      throw Error(Fault::too_large, fmt::format("{} queries at once; less than 2^32 are possible", queries.size()));
    ClosestReport own;
    ClosestPoints result;
    result.distance.resize(queries.size());
    result.point.resize(queries.size());
    result.face.resize(queries.size());
    result.barycentric.resize(queries.size());
    result.feature.resize(queries.size());
    if (options.with_sign) result.winding.resize(queries.size());

    const Vec3 side = tree_.high - tree_.low;
    const auto order = morton_order(queries, tree_.low - side / 2, tree_.high + side / 2, threads_);
    own.sort_seconds = seconds_since(start);
    const std::size_t tasks = (queries.size() + together - 1) / together;
    std::atomic<std::uint64_t> rays = 0;
    parallel_for(threads_, tasks, [&](std::size_t task, unsigned thread) {
      check_stop(monitor);
      if (thread == 0) monitor.progress("closest points", double(task) / double(tasks));
      const std::span<const std::uint32_t> ids =
          std::span(order).subspan(task * together, std::min(together, order.size() - task * together));
      rays += answer(queries, ids, result);
    });
    monitor.progress("closest points", 1);
    own.rays = rays;
    own.seconds = seconds_since(start);
    if (report) *report = own;
    return result;
  }

private:
  std::uint64_t answer(std::span<const Vec3> queries, std::span<const std::uint32_t> ids, ClosestPoints& result) const {
    std::array<Vec3, together> points;
    std::array<double, together> distances;
    std::array<std::uint32_t, together> faces;
    for (std::size_t i = 0; i < ids.size(); ++i) points[i] = queries[ids[i]];
    WarmSlots warm;
    for (std::size_t first = 0; first < ids.size(); first += packet) {
      const std::size_t count = std::min(packet, ids.size() - first);
      const Vec3* p = points.data() + first;
      if (std::none_of(p, p + count, [&](const Vec3& q) { return is_far(tree_, q); }))
        closest_packet(tree_, p, count, warm, faces.data() + first);
      else
        for (std::size_t i = 0; i < count; ++i)
          faces[first + i] = closest_single(tree_, p[i], std::numeric_limits<double>::infinity(), no_face);
    }
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const SurfacePoint found = tree_.on_face(faces[i], points[i]);
      const std::size_t to = ids[i];
      distances[i] = result.distance[to] = found.distance;
      result.point[to] = found.point;
      result.face[to] = found.face;
      result.barycentric[to] = found.barycentric;
      result.feature[to] = found.feature;
    }
    return result.winding.empty() ? 0 : set_signs(std::span(points).first(ids.size()), distances.data(), ids, result);
  }

  // Returns how many took a ray.
  std::uint64_t set_signs(std::span<const Vec3> points, const double* distances, std::span<const std::uint32_t> ids,
                          ClosestPoints& result) const {
    constexpr std::size_t neighbours = 4;
    const double extent = 2 / tree_.scale;
    std::uint64_t rays = 0;
    std::array<int, together> winding;
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
      result.winding[ids[i]] = winding[i];
      if (winding[i] > 0) result.distance[ids[i]] = -distances[i];
    }
    return rays;
  }

  plan::ClosestTree tree_;
  unsigned threads_;
};

// The sign of the doubled area of the triangle (a, b, p) seen from above, p moved by an infinitesimal along x and by its
// square along y: 0 only where a and b lie above each other.
int perturbed_side(const Vec3& a, const Vec3& b, const Vec3& p) {
  const int side = orientation(Vec3(a.x(), a.y(), 1), Vec3(b.x(), b.y(), 1), Vec3(p.x(), p.y(), 1));
  if (side != 0) return side;
  if (a.y() != b.y()) return a.y() > b.y() ? 1 : -1;
  return (b.x() > a.x()) - (b.x() < a.x());
}

} // namespace

std::unique_ptr<DistanceField> distance_field(std::span<const Vec3> vertices, std::span<const Face> faces,
                                              unsigned threads) {
  return std::make_unique<CpuDistanceField>(vertices, faces, threads);
}

std::uint64_t distance_field_bytes(std::uint64_t vertices, std::uint64_t faces, std::uint64_t queries) {
  constexpr std::uint64_t one = 2 * sizeof(double) + 2 * sizeof(Vec3) + sizeof(SurfaceFeature) + 8;
  return plan::ClosestTree::bytes(faces, vertices) + queries * (one + 20);
}

std::optional<SurfacePoint> closest_point(const plan::ClosestTree& tree, const Vec3& query, double below,
                                          std::uint32_t warm_face) {
  // The search counts by squares, whose rounding must not decide.
  const double wider = below + 1e-15 * (tree.size + query.cwiseAbs().maxCoeff());
  const std::uint32_t face =
      closest_single(tree, query, wider, warm_face == no_face ? no_face : tree.slot_of_face[warm_face]);
  if (face == no_face) return std::nullopt;
  const SurfacePoint found = tree.on_face(face, query);
  if (!(found.distance < below)) return std::nullopt;
  return found;
}

int winding_number(const plan::ClosestTree& tree, const Vec3& query) {
  if ((query.array() < tree.low.array()).any() || (query.array() > tree.high.array()).any()) return 0;
  const bool up = query.z() > tree.centre.z();
  int winding = 0;
  thread_local std::vector<std::uint32_t> column;
  column.clear();
  column_faces(tree, query, up, column);
  for (const std::uint32_t face : column) {
    const Face& f = tree.faces[face];
    const Vec3 &a = tree.vertices[f[0]], &b = tree.vertices[f[1]], &c = tree.vertices[f[2]];
    const int side = perturbed_side(a, b, query);
    if (side == 0 || perturbed_side(b, c, query) != side || perturbed_side(c, a, query) != side) continue;
    // The face looks up if side is 1; it is above the query if the query is on the other side of it.
    if (side_of_plane(a, b, c, query) == (up ? side : -side)) winding += up ? side : -side;
  }
  return winding;
}

} // namespace cowgpu::cpu

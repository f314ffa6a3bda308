#include "host/mesh/overlap.hpp"

#include "host/geometry/orientation.hpp"
#include "host/mesh/face_pieces.hpp"
#include "host/mesh/topology.hpp"
#include "host/mesh/winding.hpp"
#include "host/parallel.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace cowgpu {
namespace {

using Wide3 = Eigen::Matrix<long double, 3, 1>;

enum Region { overlapped, inverted, inside, region_count };

/// For each region the part of a face that bounds it, negative where the region lies in front.
using Parts = std::array<double, region_count>;

/// Whether points of this winding number belong to the regions.
std::array<int, region_count> regions(int winding) {
  return {winding >= 2, winding<0, winding> 0};
}

class Boundary {
public:
  Boundary(std::span<const Vec3> vertices, std::span<const Face> faces, const Bvh& tree, const SelfIntersections& found)
      : vertices_(vertices), faces_(faces), tree_(tree), start_(faces.size() + 1) {
    if (!tree.nodes().empty())
      size_ = std::max(tree.nodes()[0].low.cwiseAbs().maxCoeff(), tree.nodes()[0].high.cwiseAbs().maxCoeff());
    const auto cuts = [](const FacePair& pair) { return pair.how.segment || pair.how.meeting == Meeting::overlapping; };
    for (const FacePair& pair : found.pairs)
      if (cuts(pair)) ++start_[pair.first + 1], ++start_[pair.second + 1];
    for (std::size_t f = 0; f < faces.size(); ++f) start_[f + 1] += start_[f];
    pairs_.resize(start_.back());
    std::vector<std::size_t> at(start_.begin(), start_.end() - 1);
    for (const FacePair& pair : found.pairs)
      if (cuts(pair)) pairs_[at[pair.first]++] = pairs_[at[pair.second]++] = &pair;
  }

  bool is_cut(std::size_t face) const { return start_[face] != start_[face + 1]; }
  bool is_flat(std::size_t face) const { return area_vector(face).squaredNorm() == 0; }

  Vec3 area_vector(std::size_t face) const {
    const Face& f = faces_[face];
    const Vec3& a = vertices_[f[0]];
    return (vertices_[f[1]] - a).cross(vertices_[f[2]] - a) / 2;
  }

  /// Of a face that nothing cuts.
  Parts whole(std::size_t face) const {
    const Face& f = faces_[face];
    return parts_at(face, (vertices_[f[0]] + vertices_[f[1]] + vertices_[f[2]]) / 3, {});
  }

  /// Of a face that others meet: `each(parts, piece, lifted)` for every piece, with what takes its points back to space.
  template <class Each>
  void cut(std::size_t face, Each&& each) const {
    const Face& f = faces_[face];
    int axis = 0;
    area_vector(face).cwiseAbs().maxCoeff(&axis);
    const auto seen = [&](const Vec3& p) { return Vec2(p[(axis + 1) % 3], p[(axis + 2) % 3]); };
    const Vec3 &p = vertices_[f[0]], u = vertices_[f[1]] - p, v = vertices_[f[2]] - p;
    std::vector<Segment2> segments;
    std::vector<std::uint32_t> stacked;
    for (const FacePair* pair : pairs(face)) {
      if (pair->how.segment) {
        segments.emplace_back(seen(pair->how.from), seen(pair->how.to));
        continue;
      }
      stacked.push_back(pair->first == face ? pair->second : pair->first);
      const Face& other = faces_[stacked.back()];
      for (std::size_t k = 0; k < 3; ++k)
        segments.emplace_back(seen(vertices_[other[k]]), seen(vertices_[other[(k + 1) % 3]]));
    }
    const Vec2 a = seen(p), b = seen(vertices_[f[1]]), c = seen(vertices_[f[2]]), u2 = b - a, v2 = c - a;
    const double turn = u2.x() * v2.y() - u2.y() * v2.x();
    if (turn == 0) return;
    const auto lifted = [&](const Vec2& q) -> Vec3 {
      const Vec2 w = q - a;
      return p + (w.x() * v2.y() - w.y() * v2.x()) / turn * u + (u2.x() * w.y() - u2.y() * w.x()) / turn * v;
    };
    for_each_piece(a, b, c, segments,
                   [&](const FacePiece& piece) { each(parts_at(face, lifted(piece.middle), stacked), piece, lifted); });
  }

  Parts cut(std::size_t face) const {
    Parts sum{};
    cut(face, [&](const Parts& here, const FacePiece& piece, const auto&) {
      for (std::size_t r = 0; r < sum.size(); ++r) sum[r] += piece.fraction * here[r];
    });
    return sum;
  }

private:
  std::span<const FacePair* const> pairs(std::size_t face) const {
    return std::span(pairs_).subspan(start_[face], start_[face + 1] - start_[face]);
  }

  /// +1 or -1 if the face holds the point, which lies in its plane but for rounding, and looks the same way as `reference`
  /// or back; else 0.
  int stacked_sign(std::uint32_t face, const Vec3& point, std::size_t reference) const {
    const Face& f = faces_[face];
    const Vec3 normal = area_vector(reference);
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    const Vec3 &a = vertices_[f[0]], &b = vertices_[f[1]], &c = vertices_[f[2]];
    const int turn = orientation_along(axis, a, b, c);
    if (orientation_along(axis, a, b, point) * turn < 0 || orientation_along(axis, b, c, point) * turn < 0 ||
        orientation_along(axis, c, a, point) * turn < 0)
      return 0;
    return turn * (normal[axis] > 0 ? 1 : -1);
  }

  /// 1 where the face bounds a region behind it at this point, -1 where the region is in front, 0 where none ends here.
  Parts parts_at(std::size_t face, Vec3 point, std::span<const std::uint32_t> stacked) const {
    const Face& f = faces_[face];
    const Vec3 &a = vertices_[f[0]], &b = vertices_[f[1]], &c = vertices_[f[2]];
    if (side_of_plane(a, b, c, point) == 0) { // exactly in it: step off
      int axis = 0;
      area_vector(face).cwiseAbs().maxCoeff(&axis);
      point[axis] += 0x1p-50 * size_;
    }
    int jump = 1; // from the front of all faces that lie here to the back
    for (const std::uint32_t other : stacked) jump += stacked_sign(other, point, face);
    if (jump == 0) return {};
    const int here = winding_number(tree_, vertices_, faces_, point);
    const bool behind = side_of_plane(a, b, c, point) > 0;
    const auto back = regions(behind ? here : here + jump), front = regions(behind ? here - jump : here);
    Parts parts{};
    for (std::size_t r = 0; r < parts.size(); ++r) parts[r] = double(back[r] - front[r]) / jump;
    return parts;
  }

  std::span<const Vec3> vertices_;
  std::span<const Face> faces_;
  const Bvh& tree_;
  double size_ = 0;
  std::vector<std::size_t> start_;     // where the pairs of each face begin
  std::vector<const FacePair*> pairs_; // that cut it
};

/// For each face the least of its patch: faces joined over edges of two faces that run them in opposite directions, where
/// nothing cuts either, so that the winding numbers on their sides are the same.
std::vector<std::uint32_t> patches(std::span<const Vec3> vertices, std::span<const Face> faces,
                                   const Boundary& boundary) {
  DisjointSets sets(faces.size());
  const auto plain = [&](std::size_t face) { return !boundary.is_cut(face) && !boundary.is_flat(face); };
  const std::vector<EdgeUse> uses = edge_uses(faces, vertices.size());
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    if (edge.size() == 2 && edge[0].forward != edge[1].forward && plain(edge[0].face) && plain(edge[1].face))
      sets.join(edge[0].face, edge[1].face);
  });
  std::vector<std::uint32_t> patch(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) patch[f] = std::uint32_t(sets.find(f));
  return patch;
}

/// Of cut faces the sum over their pieces.
std::vector<Parts> parts_of_faces(std::span<const Vec3> vertices, std::span<const Face> faces, const Boundary& boundary,
                                  Monitor& monitor, unsigned threads) {
  const std::vector<std::uint32_t> patch = patches(vertices, faces, boundary);
  std::vector<Parts> parts(faces.size());
  constexpr std::size_t faces_a_task = 256, tasks_a_part = 64;
  const std::size_t tasks = (faces.size() + faces_a_task - 1) / faces_a_task;
  for (std::size_t part = 0; part < tasks; part += tasks_a_part) {
    monitor.progress("overlapped volume", double(part) / double(tasks));
    parallel_for(threads, std::min(tasks_a_part, tasks - part), [&](std::size_t task, unsigned) {
      const std::size_t first = (part + task) * faces_a_task;
      for (std::size_t f = first; f < std::min(first + faces_a_task, faces.size()); ++f) {
        if (boundary.is_flat(f)) continue;
        check_stop(monitor);
        if (boundary.is_cut(f))
          parts[f] = boundary.cut(f);
        else if (patch[f] == f)
          parts[f] = boundary.whole(f);
      }
    });
  }
  for (std::size_t f = 0; f < faces.size(); ++f) parts[f] = parts[patch[f]];
  return parts;
}

RegionVolume region_volume(std::span<const Vec3> vertices, std::span<const Face> faces, const Boundary& boundary,
                           const std::vector<Parts>& parts, std::size_t region) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (parts[f][region] != 0)
      for (const std::uint32_t v : faces[f]) low = low.cwiseMin(vertices[v]), high = high.cwiseMax(vertices[v]);
  RegionVolume result;
  if (!(low.x() <= high.x())) return result;
  const Vec3 middle = low / 2 + high / 2, sides = high - low;
  long double volume = 0;
  Wide3 open = Wide3::Zero();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (parts[f][region] == 0) continue;
    const Wide3 piece = (long double)(parts[f][region]) * boundary.area_vector(f).cast<long double>();
    volume += piece.dot((vertices[faces[f][0]] - middle).cast<long double>()) / 3;
    open += piece;
  }
  result.volume = double(std::max(volume, 0.0L));
  result.uncertainty = double(open.norm()) * sides.norm() + 1e-13 * sides.prod();
  return result;
}

/// Both regions by winding numbers at points spread evenly through the box: an additive recurrence on the generalised golden
/// ratio (M. Roberts, The unreasonable effectiveness of quasirandom sequences, 2018). Twice the standard error of as many
/// random points.
std::array<RegionVolume, 2> sampled_volumes(std::span<const Vec3> vertices, std::span<const Face> faces,
                                            const Bvh& tree, Monitor& monitor, unsigned threads,
                                            std::size_t most_points) {
  constexpr std::size_t points_a_task = 4096;
  const std::size_t tasks = std::max<std::size_t>(1, most_points / points_a_task);
  constexpr double ratio = 1.22074408460575947536;
  const Vec3 step(1 / ratio, 1 / (ratio * ratio), 1 / (ratio * ratio * ratio));
  const Vec3 low = tree.nodes()[0].low, sides = tree.nodes()[0].high - low;
  std::vector<std::array<std::size_t, region_count>> hits(tasks);
  parallel_for(threads, tasks, [&](std::size_t task, unsigned) {
    check_stop(monitor);
    for (std::size_t i = 0; i < points_a_task; ++i) {
      Vec3 at = Vec3::Constant(0.5) + double(task * points_a_task + i) * step;
      at -= at.array().floor().matrix();
      const auto in = regions(winding_number(tree, vertices, faces, low + at.cwiseProduct(sides)));
      for (std::size_t r = 0; r < in.size(); ++r) hits[task][r] += std::size_t(in[r]);
    }
  });
  std::array<RegionVolume, 2> volumes;
  const double points = double(tasks * points_a_task);
  for (std::size_t r = 0; r < volumes.size(); ++r) {
    double part = 0;
    for (const auto& counts : hits) part += double(counts[r]) / points;
    const double variance = std::max(part * (1 - part), 1 / points) / points;
    volumes[r] = {part * sides.prod(), 2 * std::sqrt(variance) * sides.prod()};
  }
  return volumes;
}

} // namespace

Overlap overlap(std::span<const Vec3> vertices, std::span<const Face> faces, const Bvh& tree,
                const SelfIntersections& found, Monitor& monitor, unsigned threads, std::size_t most_points) {
  const Boundary boundary(vertices, faces, tree, found);
  const std::vector<Parts> parts = parts_of_faces(vertices, faces, boundary, monitor, threads);
  std::array<RegionVolume, 2> found_volumes = {region_volume(vertices, faces, boundary, parts, overlapped),
                                               region_volume(vertices, faces, boundary, parts, inverted)};
  const auto vague = [](const RegionVolume& region) { return region.uncertainty > 0.01 * region.volume; };
  if (std::any_of(found_volumes.begin(), found_volumes.end(), vague)) {
    const auto sampled = sampled_volumes(vertices, faces, tree, monitor, threads, most_points);
    for (std::size_t r = 0; r < sampled.size(); ++r)
      if (vague(found_volumes[r]) && sampled[r].uncertainty < found_volumes[r].uncertainty)
        found_volumes[r] = sampled[r];
  }
  return {found_volumes[0], found_volumes[1]};
}

TriangleSheet body_boundary(std::span<const Vec3> vertices, std::span<const Face> faces, const Bvh& tree,
                            const SelfIntersections& found, Monitor& monitor, unsigned threads) {
  const Boundary boundary(vertices, faces, tree, found);
  const std::vector<Parts> parts = parts_of_faces(vertices, faces, boundary, monitor, threads);
  TriangleSheet sheet{{vertices.begin(), vertices.end()}, {}};
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!boundary.is_cut(f)) {
      if (parts[f][inside] != 0) sheet.faces.push_back(faces[f]);
      continue;
    }
    if (boundary.is_flat(f)) continue;
    check_stop(monitor);
    boundary.cut(f, [&](const Parts& here, const FacePiece& piece, const auto& lifted) {
      if (here[inside] == 0) return;
      const auto base = static_cast<std::uint32_t>(sheet.vertices.size());
      for (const Vec2& corner : piece.corners) sheet.vertices.push_back(lifted(corner));
      sheet.faces.push_back({base, base + 1, base + 2});
      sheet.faces.push_back({base, base + 2, base + 3});
    });
  }
  return sheet;
}

} // namespace cowgpu

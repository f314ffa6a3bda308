#include "host/plan/polyhedron.hpp"

#include "host/error.hpp"
#include "host/geometry/determinant.hpp"
#include "host/parallel.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace cowgpu::plan {
namespace {

using Long = long double;
using LongVector = Eigen::Matrix<Long, 3, 1>;

// Normal and twice the area of a face; no area where it is thinner than least_relative_height.
struct Plane {
  LongVector normal = LongVector::Zero();
  Long double_area = 0;
  LongVector outward[3];
  Long lengths[3] = {};
};

template <class Real>
LongVector cross_product(const Vec3& o, const Vec3& a, const Vec3& b) {
  const Real ux = Real(a[0]) - Real(o[0]), uy = Real(a[1]) - Real(o[1]), uz = Real(a[2]) - Real(o[2]);
  const Real vx = Real(b[0]) - Real(o[0]), vy = Real(b[1]) - Real(o[1]), vz = Real(b[2]) - Real(o[2]);
  return {Long(uy * vz - uz * vy), Long(uz * vx - ux * vz), Long(ux * vy - uy * vx)};
}

Plane plane_of(const std::array<Vec3, 3>& x) {
  Plane plane;
  LongVector sides[3];
  Long longest = 0;
  for (int k = 0; k < 3; ++k) {
    sides[k] = x[(k + 1) % 3].cast<Long>() - x[k].cast<Long>();
    plane.lengths[k] = sides[k].norm();
    longest = std::max(longest, plane.lengths[k]);
  }
  LongVector area = sides[0].cross(sides[1]);
  // Cross products of needles lose what their height is below their length.
  if (area.norm() < Long(1e-2) * longest * longest) area = cross_product<Quad>(x[0], x[1], x[2]);
  const Long norm = area.norm();
  if (!(norm > Long(least_relative_height) * longest * longest)) return plane;
  plane.normal = area / norm;
  plane.double_area = norm;
  for (int k = 0; k < 3; ++k)
    if (plane.lengths[k] > 0) plane.outward[k] = (sides[k] / plane.lengths[k]).cross(plane.normal);
  return plane;
}

// From keys to small numbers, emptied for each patch.
class Numbers {
public:
  explicit Numbers(std::size_t most) {
    std::size_t slots = 64;
    while (slots < 2 * most) slots *= 2;
    keys_.assign(slots, empty);
    values_.resize(slots);
  }
  /// The key's number; `next` where it is new, which counts up then.
  std::uint32_t number(std::uint64_t key, std::uint32_t& next) {
    const std::size_t mask = keys_.size() - 1;
    std::size_t at = std::size_t(key * 0x9E3779B97F4A7C15U >> 32) & mask;
    while (keys_[at] != key && keys_[at] != empty) at = (at + 1) & mask;
    if (keys_[at] == empty) {
      keys_[at] = key;
      values_[at] = next++;
      used_.push_back(at);
    }
    return values_[at];
  }
  void clear() {
    for (const std::size_t at : used_) keys_[at] = empty;
    used_.clear();
  }

private:
  static constexpr std::uint64_t empty = ~std::uint64_t(0);
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> values_;
  std::vector<std::size_t> used_;
};

struct Box {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
};

} // namespace

double polyhedron_unit(std::span<const Vec3> vertices) {
  Box box;
  for (const Vec3& v : vertices) {
    if (!v.allFinite()) throw Error(Fault::bad_argument, "a vertex of the body is not finite");
    box.low = box.low.cwiseMin(v);
    box.high = box.high.cwiseMax(v);
  }
  if (vertices.empty()) return 1;
  const Vec3 half = box.high / 2 - box.low / 2;
  const double widest = half.maxCoeff();
  if (widest == 0) return 1;
  if (!(widest > 1e-140 && widest < 1e140))
    throw Error(Fault::bad_argument,
                fmt::format("the body is {} across, beyond the range in which its field is computed (1e-140 to 1e140); "
                            "choose another length unit",
                            2 * widest));
  int exponent = 0;
  std::frexp((half / widest).norm() * widest, &exponent);
  return std::ldexp(1.0, exponent);
}

double touching_distance(std::span<const Vec3> vertices) {
  double largest = 0;
  for (const Vec3& v : vertices) largest = std::max(largest, v.cwiseAbs().maxCoeff());
  return 4 * std::numeric_limits<double>::epsilon() * largest;
}

std::vector<std::uint8_t> sharp_edges(std::span<const Vec3> vertices, std::span<const Face> faces) {
  struct Half {
    std::uint32_t high, face;
    std::uint8_t side;
  };
  // Halves of edges, gathered at their lower vertex.
  std::vector<std::uint64_t> starts(vertices.size() + 1);
  for (const Face& f : faces)
    for (std::size_t k = 0; k < 3; ++k) ++starts[std::min(f[k], f[(k + 1) % 3]) + 1];
  for (std::size_t v = 0; v < vertices.size(); ++v) starts[v + 1] += starts[v];
  std::vector<Half> halves(3 * faces.size());
  std::vector<std::uint64_t> next(starts.begin(), starts.end() - 1);
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::uint8_t k = 0; k < 3; ++k) {
      const std::uint32_t a = faces[f][k], b = faces[f][(k + 1U) % 3];
      halves[next[std::min(a, b)]++] = {std::max(a, b), std::uint32_t(f), k};
    }
  std::vector<std::uint8_t> sharp(faces.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const auto begin = halves.begin() + std::ptrdiff_t(starts[v]), end = halves.begin() + std::ptrdiff_t(starts[v + 1]);
    std::sort(begin, end, [](const Half& a, const Half& b) {
      return a.high != b.high ? a.high < b.high : a.face != b.face ? a.face < b.face : a.side < b.side;
    });
    for (auto first = begin; first != end;) {
      Eigen::Matrix<Long, 3, 3> dyad = Eigen::Matrix<Long, 3, 3>::Zero();
      auto last = first;
      for (; last != end && last->high == first->high; ++last) {
        const Face& f = faces[last->face];
        const Plane plane = plane_of({vertices[f[0]], vertices[f[1]], vertices[f[2]]});
        if (plane.double_area > 0) dyad += plane.normal * plane.outward[last->side].transpose();
      }
      const bool flat = dyad.norm() < Long(1e-13);
      for (; first != last; ++first)
        if (!flat) sharp[first->face] = std::uint8_t(sharp[first->face] | 1U << first->side);
    }
  }
  return sharp;
}

template <class Real>
PolyhedronPatches<Real>::PolyhedronPatches(std::span<const Vec3> vertices, std::span<const cowgpu::Face> faces,
                                           const PatchFaces& of, double unit, unsigned threads) {
  const std::size_t count = of.starts.empty() ? 0 : of.starts.size() - 1;
  std::size_t largest = 0;
  for (std::size_t p = 0; p < count; ++p) largest = std::max<std::size_t>(largest, of.starts[p + 1] - of.starts[p]);
  if (largest > largest_polyhedron_patch)
    throw Error(Fault::bad_argument, fmt::format("a patch of {} faces: at most {}", largest, largest_polyhedron_patch));
  patches_.resize(count);
  struct Extent {
    std::uint32_t vertices = 0, edges = 0, faces = 0;
  };
  // As many tasks on any number of threads: a task's patches lie in one block.
  const std::size_t per_task = std::max<std::size_t>(1, 16384 / std::max<std::size_t>(1, largest));
  const std::size_t tasks = (count + per_task - 1) / per_task;
  blocks_.resize(tasks);
  std::vector<std::size_t> most_vertices(tasks), most_edges(tasks);
  const double scale = 1 / unit;
  parallel_for(threads, tasks, [&](std::size_t task, unsigned) {
    const std::size_t begin = task * per_task, end = std::min(count, begin + per_task);
    Block block;
    const std::size_t room = of.starts[end] - of.starts[begin];
    block.faces.reserve(room);
    block.edges.reserve(2 * room);
    block.vertices.reserve(room);
    Numbers corners(3 * largest), sides(3 * largest);
    std::vector<Extent> extents(end - begin);
    for (std::size_t p = begin; p < end; ++p) {
      corners.clear();
      sides.clear();
      Extent& extent = extents[p - begin];
      const Vec3 centre = of.centres.empty() ? Vec3(Vec3::Zero()) : of.centres[p];
      for (std::uint32_t at = of.starts[p]; at < of.starts[p + 1]; ++at) {
        const cowgpu::Face& f = faces[of.order[at]];
        const std::array<Vec3, 3> x = {vertices[f[0]], vertices[f[1]], vertices[f[2]]};
        const Plane plane = plane_of(x);
        if (!(plane.double_area > 0)) continue;
        Face face;
        const Long area = plane.double_area * scale * scale;
        face.four_areas = Real(2 * area);
        face.height = Real(area / (plane.lengths[1] * scale));
        for (std::size_t k = 0; k < 3; ++k) {
          face.normal[k] = Real(plane.normal[Eigen::Index(k)]);
          for (std::size_t c = 0; c < 3; ++c) face.outward[k][c] = Real(plane.outward[k][Eigen::Index(c)]);
          const std::uint32_t before = extent.vertices;
          const std::uint32_t corner = corners.number(f[k], extent.vertices);
          face.corners[k] = std::uint16_t(corner);
          if (extent.vertices > before) {
            const Vec3 to = x[k] * scale - centre;
            block.vertices.push_back({Real(to[0]), Real(to[1]), Real(to[2])});
          }
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint16_t a = face.corners[k], b = face.corners[(k + 1) % 3];
          const std::uint32_t before = extent.edges;
          face.edges[k] =
              std::uint16_t(sides.number(std::uint64_t(std::min(a, b)) << 16 | std::max(a, b), extent.edges));
          if (extent.edges > before)
            block.edges.push_back({Real(plane.lengths[k] * scale), a, b,
                                   of.sharp.empty() ? 0 : std::uint32_t(of.sharp[of.order[at]] >> k & 1U)});
        }
        block.faces.push_back(face);
        ++extent.faces;
      }
    }
    std::size_t v = 0, e = 0, f = 0;
    for (std::size_t p = begin; p < end; ++p) {
      const Extent& extent = extents[p - begin];
      patches_[p] = {{block.vertices.data() + v, extent.vertices},
                     {block.edges.data() + e, extent.edges},
                     {block.faces.data() + f, extent.faces},
                     of.centres.empty() ? Vec3(Vec3::Zero()) : of.centres[p]};
      v += extent.vertices;
      e += extent.edges;
      f += extent.faces;
      most_vertices[task] = std::max<std::size_t>(most_vertices[task], extent.vertices);
      most_edges[task] = std::max<std::size_t>(most_edges[task], extent.edges);
    }
    blocks_[task] = std::move(block);
  });
  for (std::size_t task = 0; task < tasks; ++task) {
    most_vertices_ = std::max(most_vertices_, most_vertices[task]);
    most_edges_ = std::max(most_edges_, most_edges[task]);
  }
}

template <class Real>
std::uint64_t PolyhedronPatches<Real>::bytes(std::uint64_t faces, std::uint64_t patches) {
  // Where no two faces of a patch meet: three corners and three edges a face. Vectors that grow hold up to three times as much.
  return faces * (sizeof(Face) + 3 * 3 * (sizeof(Edge) + sizeof(std::array<Real, 3>))) + patches * (sizeof(Patch) + 16);
}

template class PolyhedronPatches<double>;
template class PolyhedronPatches<float>;

} // namespace cowgpu::plan

#include "host/plan/polyhedron_sources.hpp"

#include "host/parallel.hpp"
#include "host/plan/polyhedron_moments_kernel.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace cowgpu::plan {
namespace {

// Faces of one task: their groups stay in a core's cache while all cells above them are measured.
constexpr std::uint32_t task_faces = 4096;

struct alignas(64) Line {
  double values[8];
};

// The roots of subtrees of at most so many places, first to last.
std::vector<std::uint32_t> subtrees(std::span<const TreeCell> cells, std::uint32_t most) {
  std::vector<std::uint32_t> tops;
  for (std::uint32_t cell = 0; cell < cells.size();) {
    if (cells[cell].count() > most && !cells[cell].leaf()) {
      ++cell;
      continue;
    }
    tops.push_back(cell);
    cell = cells[cell].last;
  }
  return tops;
}

} // namespace

struct PolyhedronSources::Surface {
  std::span<const Vec3> vertices;
  std::span<const Face> faces;
  double scale; // 1/unit
  Vec3 origin;

  Vec3 corner(std::uint32_t face, int k) const { return vertices[faces[face][std::size_t(k)]] * scale; }

  // The faces order[0] ... in groups.
  void gather(std::span<const std::uint32_t> order, std::vector<FaceGroup>& groups) const {
    groups.resize((order.size() + face_group - 1) / face_group);
    for (std::size_t i = 0; i < face_group * groups.size(); ++i) {
      FaceGroup& group = groups[i / face_group];
      const std::size_t lane = i % face_group;
      const std::uint32_t face = order[std::min(i, order.size() - 1)];
      const Vec3 a = corner(face, 0), b = corner(face, 1), c = corner(face, 2);
      const Vec3 normal = i < order.size() ? Vec3((b - a).cross(c - a)) : Vec3(Vec3::Zero());
      for (int k = 0; k < 3; ++k) {
        group.a[k][lane] = a[k];
        group.b[k][lane] = b[k];
        group.c[k][lane] = c[k];
        group.weights[k][lane] = normal[k];
      }
      group.weights[3][lane] = normal.dot(a - origin);
      group.area[lane] = normal.norm() / 2;
    }
  }
};

// Largest distances and moments of the cells above a subtree, by their depth: they hold other subtrees as well.
struct PolyhedronSources::Reaches {
  std::vector<FaceReach> of_depth;
  double area = 0;
};

PolyhedronSources::PolyhedronSources(std::span<const Vec3> vertices, std::span<const Face> faces, double unit,
                                     std::uint32_t largest_leaf, const Translations& translations, unsigned threads,
                                     Monitor& monitor)
    : tree_(
          faces.size(),
          [&](std::size_t i) {
            const auto& [a, b, c] = faces[i];
            return Vec3((vertices[a] / unit + vertices[b] / unit + vertices[c] / unit) / 3);
          },
          largest_leaf, threads),
      order_(translations.order()) {
  std::vector<TreeCell>& cells = tree_.cells;
  multipoles_.resize(cells.size() * densities * harmonics(order_));
  norms_.resize(cells.size() * std::size_t(order_ + 1));
  reach_.resize(cells.size());
  leaf_.resize(cells.size());
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) {
    if (!cells[cell].leaf()) continue;
    leaf_[cell] = std::uint32_t(leaves_.size());
    leaves_.push_back(cell);
  }

  const Surface surface{vertices, faces, 1 / unit, origin()};
  const std::vector<std::uint32_t> tops = subtrees(cells, task_faces);
  std::vector<Reaches> reaches(tops.size());
  std::atomic<std::size_t> done = 0;
  parallel_for(threads, tops.size(), [&](std::size_t i, unsigned thread) {
    check_stop(monitor);
    add_subtree(surface, tops[i], translations, reaches[i]);
    const std::size_t now = ++done;
    if (thread == 0) monitor.progress("multipoles of faces", double(now) / double(tops.size()));
  });

  // The cells above, from the lowest on.
  std::vector<std::vector<std::uint32_t>> levels(tree_.depth() + 1);
  std::vector<std::uint32_t> path;
  std::size_t next = 0;
  std::vector<std::uint32_t> above;
  for (std::uint32_t cell = 0; cell < cells.size();) {
    if (next < tops.size() && cell == tops[next]) {
      for (std::size_t k = 0; k < cells[cell].depth; ++k) {
        const FaceReach& part = reaches[next].of_depth[k];
        cells[path[k]].radius = std::max(cells[path[k]].radius, part.radius);
        reach_[path[k]] += part.moment;
      }
      ++next;
      cell = cells[cell].last;
      continue;
    }
    path.resize(cells[cell].depth);
    path.push_back(cell);
    cells[cell].radius = 0;
    levels[cells[cell].depth].push_back(cell);
    above.push_back(cell);
    ++cell;
  }
  std::vector<Translations::Room> rooms;
  for (unsigned t = 0; t < std::max(1U, threads); ++t) rooms.emplace_back(order_);
  constexpr std::size_t batch = 16;
  for (auto level = levels.rbegin(); level != levels.rend(); ++level)
    parallel_for(threads, (level->size() + batch - 1) / batch, [&](std::size_t i, unsigned thread) {
      const std::span<const std::uint32_t> all = *level;
      gather_up(all.subspan(i * batch, std::min(batch, all.size() - i * batch)), translations, rooms[thread]);
    });
  volume_ = multipoles_[3] / 3;
  // Normals of a closed surface add up to nothing, but for rounding, which would be seen far away.
  double area = 0, open = 0;
  for (const Reaches& part : reaches) area += part.area;
  for (std::size_t k = 0; k < 3; ++k) open = std::max(open, std::abs(multipoles_[k]));
  if (open <= 1e-9 * area) std::fill(multipoles_.begin(), multipoles_.begin() + 3, 0.0);
  for (const std::uint32_t cell : above) {
    cells[cell].radius *= 1 + 1e-14;
    find_norms(cell);
  }
  if (above.empty()) find_norms(0);
}

void PolyhedronSources::add_subtree(const Surface& surface, std::uint32_t top, const Translations& translations,
                                    Reaches& reaches) {
  std::vector<TreeCell>& cells = tree_.cells;
  const std::uint32_t begin = cells[top].begin, last = cells[top].last;
  std::vector<FaceGroup> groups;
  surface.gather(std::span(tree_.order).subspan(begin, cells[top].count()), groups);
  std::vector<Line> room(moment_room(order_) / 8 + 1);
  std::vector<std::vector<std::uint32_t>> levels;
  for (std::uint32_t cell = top; cell < last; ++cell) {
    TreeCell& one = cells[cell];
    const auto own = std::span<const FaceGroup>(groups).subspan((one.begin - begin) / face_group,
                                                                (one.count() + face_group - 1) / face_group);
    const FaceReach reach = face_reach(own, one.centre, order_ + 1);
    one.radius = reach.radius * (1 + 1e-14);
    reach_[cell] = reach.moment;
    if (one.leaf()) {
      add_face_moments(own, one.centre, order_, room.front().values,
                       &multipoles_[cell * densities * harmonics(order_)]);
    } else {
      const std::size_t level = one.depth - cells[top].depth;
      if (levels.size() <= level) levels.resize(level + 1);
      levels[level].push_back(cell);
    }
  }
  Translations::Room shifting(order_);
  for (auto level = levels.rbegin(); level != levels.rend(); ++level) gather_up(*level, translations, shifting);
  for (std::uint32_t cell = top; cell < last; ++cell) find_norms(cell);
  for (const FaceGroup& group : groups)
    for (const double area : group.area) reaches.area += area;
  // From the root down to the cell above this one.
  for (std::uint32_t cell = 0; cell != top;) {
    reaches.of_depth.push_back(face_reach(groups, cells[cell].centre, order_ + 1));
    cell = top < cells[cell].right ? cell + 1 : cells[cell].right;
  }
}

void PolyhedronSources::gather_up(std::span<const std::uint32_t> parents, const Translations& translations,
                                  Translations::Room& room) {
  const std::span<const TreeCell> cells = tree_.cells;
  std::vector<TranslationPair> pairs;
  for (const std::uint32_t parent : parents)
    for (const std::uint32_t child : {parent + 1, cells[parent].right})
      pairs.push_back({multipoles(child), &multipoles_[parent * densities * harmonics(order_)],
                       cells[parent].centre - cells[child].centre});
  translations.add(Translation::multipole_to_multipole, order_, pairs, room);
}

void PolyhedronSources::find_norms(std::uint32_t cell) {
  const double* from = multipoles(cell);
  for (int l = 0; l <= order_; ++l) {
    double sum = 0;
    for (int k = 0; k < 2 * l + 1; ++k, from += densities)
      sum += from[0] * from[0] + from[1] * from[1] + from[2] * from[2];
    norms_[cell * std::size_t(order_ + 1) + std::size_t(l)] = std::sqrt(sum) * (1 + 1e-12);
  }
}

std::uint64_t PolyhedronSources::bytes(std::uint64_t faces, std::uint32_t largest_leaf, int order) {
  const std::uint64_t cells = PlaceTree::cell_count(faces, largest_leaf);
  return PlaceTree::bytes(faces, largest_leaf) +
         cells * (sizeof(double) * (densities * harmonics(order) + std::size_t(order + 2)) + 12);
}

std::uint64_t PolyhedronSources::bytes_while_made(std::uint64_t faces, int order, unsigned threads) {
  // The tree is there before the multipoles.
  const std::uint64_t task = task_faces / face_group * sizeof(FaceGroup) + 8 * moment_room(order) +
                             2 * Translations::Room::bytes(order) + (1 << 16);
  return std::max(PlaceTree::bytes_while_made(faces), task * std::max(1U, threads) + faces / 8);
}

} // namespace cowgpu::plan

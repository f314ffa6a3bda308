#include "host/flow/level_surface.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace cowgpu {
namespace {

constexpr int block = 4; // cubes along a side of what is looked at together
constexpr int most_vertex_passes = 30;

using Cube = std::array<std::int64_t, 3>;

// The six tetrahedra of a cube: from corner 0 to corner 7 along the axes in each order. Bits of a corner are x, y, z. Odd
// orders turn the other way.
struct Path {
  std::array<int, 4> corners;
  bool odd;
};
constexpr std::array<Path, 6> paths = {Path{{0, 1, 3, 7}, false}, Path{{0, 2, 6, 7}, false}, Path{{0, 4, 5, 7}, false},
                                       Path{{0, 1, 5, 7}, true},  Path{{0, 2, 3, 7}, true},  Path{{0, 4, 6, 7}, true}};

class Lattice {
public:
  Lattice(const Vec3& low, const Vec3& high, double level, int cells) {
    const Vec3 sides = high - low + Vec3::Constant(2 * level);
    cell_ = sides.maxCoeff() / cells;
    for (std::size_t c = 0; c < 3; ++c) {
      const double side = sides[Eigen::Index(c)];
      // Two cubes to spare on each side; whole blocks.
      const auto cubes = std::int64_t(std::ceil(side / cell_)) + 4;
      counts_[c] = (cubes + block - 1) / block * block;
      first_[Eigen::Index(c)] = (low[Eigen::Index(c)] + high[Eigen::Index(c)]) / 2 - double(counts_[c]) * cell_ / 2;
    }
  }
  double cell() const { return cell_; }
  const Cube& cubes() const { return counts_; }
  Vec3 at(double x, double y, double z) const { return first_ + cell_ * Vec3(x, y, z); }
  std::uint64_t id(const Cube& p) const {
    return (std::uint64_t(p[2]) * std::uint64_t(counts_[1] + 1) + std::uint64_t(p[1])) * std::uint64_t(counts_[0] + 1) +
           std::uint64_t(p[0]);
  }
  Cube place(std::uint64_t id) const {
    const auto nx = std::uint64_t(counts_[0] + 1), ny = std::uint64_t(counts_[1] + 1);
    return {std::int64_t(id % nx), std::int64_t(id / nx % ny), std::int64_t(id / nx / ny)};
  }

private:
  double cell_ = 0;
  Cube counts_{};
  Vec3 first_;
};

Cube corner_of(const Cube& cube, int corner) {
  return {cube[0] + (corner & 1), cube[1] + (corner >> 1 & 1), cube[2] + (corner >> 2 & 1)};
}

// Corners of the blocks of cubes that the level may pass: distances change no faster than places.
std::vector<Cube> near_blocks(DistanceField& field, const Lattice& lattice, double level, Monitor& monitor,
                              LevelSurfaceReport& report, std::uint64_t& cubes_inside) {
  std::vector<Cube> blocks;
  std::vector<Vec3> middles;
  const Cube n = lattice.cubes();
  for (std::int64_t z = 0; z < n[2]; z += block)
    for (std::int64_t y = 0; y < n[1]; y += block)
      for (std::int64_t x = 0; x < n[0]; x += block) {
        blocks.push_back({x, y, z});
        middles.push_back(lattice.at(double(x) + block / 2., double(y) + block / 2., double(z) + block / 2.));
      }
  const ClosestPoints closest = field.closest(middles, {}, monitor);
  report.queries += middles.size();
  const double reach = std::sqrt(3.0) / 2 * block * lattice.cell() * (1 + 1e-9);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    if (std::abs(closest.distance[i] - level) <= reach)
      blocks[kept++] = blocks[i];
    else if (closest.distance[i] < level)
      cubes_inside += block * block * block;
  blocks.resize(kept);
  return blocks;
}

// Signed distances at the corners of the cubes.
std::unordered_map<std::uint64_t, double> distances_at(DistanceField& field, const Lattice& lattice,
                                                       const std::vector<Cube>& blocks, Monitor& monitor,
                                                       LevelSurfaceReport& report) {
  std::vector<std::uint64_t> ids;
  for (const Cube& b : blocks)
    for (int z = 0; z <= block; ++z)
      for (int y = 0; y <= block; ++y)
        for (int x = 0; x <= block; ++x) ids.push_back(lattice.id({b[0] + x, b[1] + y, b[2] + z}));
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::vector<Vec3> points;
  points.reserve(ids.size());
  for (const std::uint64_t id : ids) {
    const Cube p = lattice.place(id);
    points.push_back(lattice.at(double(p[0]), double(p[1]), double(p[2])));
  }
  const ClosestPoints closest = field.closest(points, {}, monitor);
  report.queries += points.size();
  std::unordered_map<std::uint64_t, double> values;
  values.reserve(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) values.emplace(ids[i], closest.distance[i]);
  return values;
}

struct EdgeHash {
  std::size_t operator()(const std::array<std::uint64_t, 2>& edge) const {
    return std::size_t(edge[0] * 0x9e3779b97f4a7c15ULL ^ (edge[1] + 0x7f4a7c15ULL) * 0xbf58476d1ce4e5b9ULL);
  }
};

enum class Side { outside, inside, cut };

// A cube that the level may pass; of its corners.
struct Passed {
  Cube cube;
  Side side;
};

class Marching {
public:
  Marching(const Lattice& lattice, const std::unordered_map<std::uint64_t, double>& values, double level,
           TriangleSurface& surface)
      : lattice_(lattice), values_(values), level_(level), surface_(surface) {}

  void cube(const Cube& cube) {
    std::array<std::uint64_t, 8> ids{};
    std::array<double, 8> above{};
    int outside = 0;
    for (int k = 0; k < 8; ++k) {
      const auto i = std::size_t(k);
      ids[i] = lattice_.id(corner_of(cube, k));
      above[i] = values_.at(ids[i]) - level_;
      outside += above[i] >= 0;
    }
    if (outside == 0 || outside == 8) {
      // No point is farther from every corner than half a cube's diagonal.
      const double nearest = std::abs(
          *std::min_element(above.begin(), above.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
      if (nearest <= std::sqrt(0.75) * lattice_.cell())
        passed.push_back({cube, outside == 8 ? Side::outside : Side::inside});
      else
        whole += outside == 0;
      return;
    }
    passed.push_back({cube, Side::cut});
    ++cut;
    for (const Path& path : paths) tetrahedron(path, ids, above);
  }

  std::uint64_t cut = 0, whole = 0; ///< cubes: that it passes; inside it
  std::vector<Passed> passed;

private:
  std::uint32_t vertex(std::uint64_t a, double at_a, std::uint64_t b, double at_b) {
    if (a > b) std::swap(a, b), std::swap(at_a, at_b);
    const auto [found, is_new] = edges_.try_emplace({a, b}, std::uint32_t(surface_.vertices.size()));
    if (!is_new) return found->second;
    const Cube p = lattice_.place(a), q = lattice_.place(b);
    // Away from the corners, where the vertices of all their edges would fall together.
    const double part = std::clamp(at_a / (at_a - at_b), 0.02, 0.98);
    const auto mix = [&](std::size_t c) { return double(p[c]) + part * double(q[c] - p[c]); };
    surface_.vertices.push_back(lattice_.at(mix(0), mix(1), mix(2)));
    return found->second;
  }

  void tetrahedron(const Path& path, const std::array<std::uint64_t, 8>& ids, const std::array<double, 8>& above) {
    // Inside first; an odd number of swaps turns it over.
    std::array<std::size_t, 4> k{};
    for (std::size_t i = 0; i < 4; ++i) k[i] = std::size_t(path.corners[i]);
    bool odd = path.odd;
    std::size_t inside = 0;
    for (std::size_t i = 0; i < 4; ++i)
      if (above[k[i]] < 0) {
        if (i != inside) std::swap(k[i], k[inside]), odd = !odd;
        ++inside;
      }
    const auto on = [&](std::size_t i, std::size_t j) {
      return vertex(ids[k[i]], above[k[i]], ids[k[j]], above[k[j]]);
    };
    const auto put = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      if (odd)
        surface_.faces.push_back({a, c, b});
      else
        surface_.faces.push_back({a, b, c});
    };
    // Of a tetrahedron with det(1 - 0, 2 - 0, 3 - 0) > 0.
    if (inside == 1)
      put(on(0, 1), on(0, 2), on(0, 3));
    else if (inside == 3)
      put(on(0, 3), on(1, 3), on(2, 3));
    else if (inside == 2) {
      const std::uint32_t a = on(0, 2), b = on(0, 3), c = on(1, 3), d = on(1, 2);
      put(a, b, c);
      put(a, c, d);
    }
  }

  const Lattice& lattice_;
  const std::unordered_map<std::uint64_t, double>& values_;
  double level_;
  TriangleSurface& surface_;
  std::unordered_map<std::array<std::uint64_t, 2>, std::uint32_t, EdgeHash> edges_;
};

// Between 0 and 1, without a pattern that a body could share: splitmix64.
double scattered(std::uint64_t number) {
  std::uint64_t z = number * 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return double((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

// Points in every cube, one at random in each of its parts, n along a side.
void sample_volume(DistanceField& field, const Lattice& lattice, double level, const std::vector<Passed>& cubes,
                   std::uint64_t cubes_inside, Monitor& monitor, LevelSurfaceReport& report) {
  const int n = std::clamp(int(std::ceil(std::cbrt(400'000. / (double(cubes.size()) + 1)))), 1, 24);
  const std::size_t each = std::size_t(n) * std::size_t(n) * std::size_t(n);
  const std::size_t cubes_a_batch = std::max<std::size_t>(1, (std::size_t(1) << 18) / each);
  const double part = std::pow(lattice.cell() / n, 3);
  std::uint64_t inside = 0, missed = 0;
  double variance = 0; // in parts, of cubes that hold some of both: about one layer of theirs is open to chance
  for (std::size_t begin = 0; begin < cubes.size(); begin += cubes_a_batch) {
    check_stop(monitor);
    const std::size_t end = std::min(cubes.size(), begin + cubes_a_batch);
    std::vector<Vec3> points;
    points.reserve((end - begin) * each);
    for (std::size_t i = begin; i < end; ++i) {
      const Cube& cube = cubes[i].cube;
      std::uint64_t number = 3 * each * lattice.id(cube);
      for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
          for (int x = 0; x < n; ++x, number += 3)
            points.push_back(lattice.at(double(cube[0]) + (x + scattered(number)) / n,
                                        double(cube[1]) + (y + scattered(number + 1)) / n,
                                        double(cube[2]) + (z + scattered(number + 2)) / n));
    }
    const ClosestPoints closest = field.closest(points, {}, monitor);
    report.queries += points.size();
    for (std::size_t i = begin; i < end; ++i) {
      std::uint64_t within = 0;
      for (std::size_t k = 0; k < each; ++k) within += closest.distance[(i - begin) * each + k] < level;
      inside += within;
      if (cubes[i].side == Side::outside) missed += within;
      if (cubes[i].side == Side::inside) missed += each - within;
      if (cubes[i].side == Side::cut || (within > 0 && within < each)) variance += double(n) * n / 4;
    }
  }
  report.sampled_volume = double(cubes_inside) * std::pow(lattice.cell(), 3) + double(inside) * part;
  report.sampled_chance = 3 * part * std::sqrt(variance);
  report.missed = double(missed) * part;
}

// Newton's method along the gradient, which has length 1.
void move_onto(DistanceField& field, double level, double enough, double cell, Monitor& monitor,
               TriangleSurface& surface, LevelSurfaceReport& report) {
  surface.normals.assign(surface.vertices.size(), Vec3::UnitZ());
  std::vector<std::uint32_t> left(surface.vertices.size());
  for (std::size_t v = 0; v < left.size(); ++v) left[v] = std::uint32_t(v);
  for (int pass = 0; pass < most_vertex_passes && !left.empty(); ++pass) {
    check_stop(monitor);
    std::vector<Vec3> places;
    places.reserve(left.size());
    for (const std::uint32_t v : left) places.push_back(surface.vertices[v]);
    const ClosestPoints closest = field.closest(places, {}, monitor);
    report.queries += places.size();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const double d = closest.distance[i];
      const Vec3 away = places[i] - closest.point[i];
      Vec3& normal = surface.normals[left[i]];
      if (d != 0) normal = (d > 0 ? away : Vec3(-away)).normalized();
      if (std::abs(d - level) <= enough || pass + 1 == most_vertex_passes) {
        report.largest_residual = std::max(report.largest_residual, std::abs(d - level));
        continue;
      }
      // Where two sheets meet a step goes to and fro between them: shorter ones end that.
      const double step = (pass < 8 ? 1 : 0.5) * std::clamp(level - d, -cell / 2, cell / 2);
      surface.vertices[left[i]] += step * normal;
      left[kept++] = left[i];
    }
    left.resize(kept);
  }
}

TriangleSurface surface_in_cubes(DistanceField& field, const Vec3& low, const Vec3& high, double level, int cells,
                                 bool sampled, Monitor& monitor, LevelSurfaceReport& found) {
  const auto start = Clock::now();
  const Lattice lattice(low, high, level, cells);
  found.cell = lattice.cell();
  monitor.progress("looking for the level set", 0);
  std::uint64_t cubes_inside = 0;
  const std::vector<Cube> blocks = near_blocks(field, lattice, level, monitor, found, cubes_inside);
  check_stop(monitor);
  const auto values = distances_at(field, lattice, blocks, monitor, found);
  check_stop(monitor);
  monitor.progress("looking for the level set", 0.5);
  TriangleSurface surface;
  Marching marching(lattice, values, level, surface);
  for (const Cube& b : blocks)
    for (int z = 0; z < block; ++z)
      for (int y = 0; y < block; ++y)
        for (int x = 0; x < block; ++x) marching.cube({b[0] + x, b[1] + y, b[2] + z});
  if (surface.vertices.size() > 0x7fffffffULL)
    throw Error(Fault::too_large, "the level set has more than 2^31 vertices: take fewer cubes");
  found.cubes = marching.cut;
  if (sampled) sample_volume(field, lattice, level, marching.passed, cubes_inside + marching.whole, monitor, found);
  move_onto(field, level, 1e-12 * (high - low).norm(), lattice.cell(), monitor, surface, found);
  monitor.progress("looking for the level set", 1);
  found.seconds = seconds_since(start);
  return surface;
}

struct Measures {
  double volume, area;
};

Measures measure(const TriangleSurface& surface, const Vec3& middle) {
  double volume = 0, area = 0;
  for (const Face& f : surface.faces) {
    const Vec3 a = surface.vertices[f[0]] - middle, b = surface.vertices[f[1]] - middle,
               c = surface.vertices[f[2]] - middle;
    volume += a.dot(b.cross(c)) / 6;
    area += (b - a).cross(c - a).norm() / 2;
  }
  return {volume, area};
}

} // namespace

TriangleSurface level_surface(DistanceField& field, const Vec3& low, const Vec3& high, double level, int cells,
                              Monitor& monitor, LevelSurfaceReport* report) {
  if (!(level > 0) || !std::isfinite(level))
    throw Error(Fault::bad_argument, fmt::format("a body is inflated by a distance above 0, not {}", level));
  if (cells < 4 || cells > 1024)
    throw Error(Fault::bad_argument, fmt::format("a level set is looked for in 4 to 1024 cubes a side, not {}", cells));
  LevelSurfaceReport found;
  TriangleSurface surface = surface_in_cubes(field, low, high, level, cells, true, monitor, found);
  if (report) *report = found;
  return surface;
}

LevelSurfaceError level_surface_error(DistanceField& field, const Vec3& low, const Vec3& high, double level, int cells,
                                      const TriangleSurface& surface, const LevelSurfaceReport& report,
                                      Monitor& monitor) {
  const Vec3 middle = (low + high) / 2;
  const Measures fine = measure(surface, middle);
  std::array<Measures, 2> coarser{};
  for (std::size_t k = 0; k < 2; ++k) {
    LevelSurfaceReport own;
    coarser[k] =
        measure(surface_in_cubes(field, low, high, level, std::max(1, cells >> (k + 1)), false, monitor, own), middle);
  }
  const auto change = [&](double Measures::*what) {
    const double first = std::abs(fine.*what - coarser[0].*what),
                 before = std::abs(coarser[0].*what - coarser[1].*what);
    return 1.5 * std::max(first, before / 4);
  };
  LevelSurfaceError error{fine.volume, fine.area, 0, 0};
  error.volume_error =
      std::max(change(&Measures::volume), std::abs(fine.volume - report.sampled_volume) + report.sampled_chance);
  const double relative =
      report.sampled_volume > 0 ? fine.area * error.volume_error / report.sampled_volume : fine.area;
  error.area_error = std::max(change(&Measures::area), relative) + 3 * report.missed / level;
  return error;
}

} // namespace cowgpu

#include "host/plan/polyhedron_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace cowgpu::plan {
namespace {

constexpr int more_degrees = 4; // of locals above P, whose parts are summed; those above are a geometric series
constexpr int least_order = 2;

// binomial[j][l] = C(l + j, l)
using Binomials =
    std::array<std::array<double, largest_expansion_order + 1>, largest_expansion_order + more_degrees + 1>;
const Binomials& binomials() {
  static const Binomials table = [] {
    Binomials made{};
    for (std::size_t j = 0; j < made.size(); ++j) {
      made[j][0] = 1;
      for (std::size_t l = 1; l < made[j].size(); ++l) made[j][l] = made[j][l - 1] * double(l + j) / double(l);
    }
    return made;
  }();
  return table;
}

double share(const PolyhedronSources& sources, const TreeCell& target, const PairTolerance& tolerance) {
  const double far = (target.centre - sources.origin()).norm() + target.radius;
  const double outside = far > tolerance.reach ? tolerance.reach / far : 1;
  const double larger = std::max(1.0, double(target.count()) / tolerance.largest_leaf);
  return tolerance.tau * outside * outside / std::sqrt(std::sqrt(larger));
}

} // namespace

double multipole_bound(const PolyhedronSources& sources, std::uint32_t source, double distance) {
  const double radius = sources.cells()[source].radius, x = 1 / distance;
  if (!(distance > radius) || distance < least_shift) return std::numeric_limits<double>::infinity();
  return sources.reach(source) * std::pow(x, sources.order() + 2) / (1 - radius * x);
}

double far_distance(const PolyhedronSources& sources, const PairTolerance& tolerance) {
  double distance = std::max(2 * sources.cells()[0].radius, tolerance.reach);
  const auto kept = [&] {
    const double outside = tolerance.reach / distance;
    return multipole_bound(sources, 0, distance) <= tolerance.tau * outside * outside;
  };
  for (int step = 0; step < 100 && !kept(); ++step) distance *= 1.125;
  return distance;
}

std::optional<FarPair> far_pair(const PolyhedronSources& sources, std::uint32_t source, const TreeCell& target,
                                const PairTolerance& tolerance) {
  const TreeCell& from = sources.cells()[source];
  const double s = from.radius, t = target.radius, d = (from.centre - target.centre).norm();
  if (!(d - s - t > 0) || d < least_shift) return {};
  const int top = sources.order();
  const double* norms = sources.norms(source);
  const double x = 1 / (d - t), u = 1 / d, y = t * u;
  const double tau = share(sources, target, tolerance);

  std::array<double, largest_expansion_order + 2> powers; // of x
  powers[0] = x;
  for (int l = 1; l <= top + 1; ++l) powers[std::size_t(l)] = powers[std::size_t(l - 1)] * x;
  double sum = sources.reach(source) * powers[std::size_t(top + 1)] / (1 - s * x);
  if (!(sum <= tau)) return {};
  std::array<double, largest_expansion_order + more_degrees + 1> of_target; // y^j
  of_target[0] = 1;
  for (int j = 1; j <= top + more_degrees; ++j) of_target[std::size_t(j)] = of_target[std::size_t(j - 1)] * y;
  if (norms[0] * u * of_target[std::size_t(top)] * y > tau) return {}; // the first term alone
  std::array<double, largest_expansion_order + 1> of_source;           // N_l/d^(l+1)
  double inverse = u;
  for (int l = 0; l <= top; ++l, inverse *= u) of_source[std::size_t(l)] = norms[l] * inverse;
  const auto of_degree = [&](int j) {
    const auto& binomial = binomials()[std::size_t(j)];
    double total = 0;
    for (std::size_t l = 0; l <= std::size_t(top); ++l) total += binomial[l] * of_source[l];
    return total * of_target[std::size_t(j)];
  };

  const int most = top + more_degrees;
  const double ratio = y * (top + most + 1.0) / (most + 1.0); // of a degree's part to the one below, at most
  if (!(ratio < 0.95)) return {};
  sum += of_degree(most) / (1 - ratio);
  for (int j = most - 1; j > top; --j) sum += of_degree(j);
  if (!(sum <= tau)) return {};
  int order = top;
  while (order > least_order) {
    const double without = sum + of_degree(order) + norms[order] * powers[std::size_t(order)];
    if (!(without <= tau)) break;
    sum = without;
    --order;
  }
  return FarPair{order, sum};
}

std::span<const CellPair> TaskPairs::of_leaf(const std::vector<CellPair>& of, std::uint32_t leaf) {
  const auto [begin, end] = std::equal_range(of.begin(), of.end(), CellPair{0, leaf},
                                             [](const CellPair& a, const CellPair& b) { return a.target < b.target; });
  return {begin, end};
}

void find_pairs(const PolyhedronSources& sources, const PlaceTree& targets, std::span<const Vec3> points,
                std::uint32_t task, const PairTolerance& tolerance, TaskPairs& found) {
  const std::span<const TreeCell> from = sources.cells(), to = targets.cells;
  found.first = task;
  found.last = to[task].last;
  found.to_locals.resize(std::size_t(sources.order() + 1));
  for (auto& pairs : found.to_locals) pairs.clear();
  found.at_points.clear();
  found.near.clear();
  found.bound.assign(found.last - found.first, 0.0);
  found.near_faces = 0;

  // Each step replaces a pair by two whose cells are one level lower, so the list of waiting ones stays as long as both trees
  // are deep.
  std::vector<CellPair> waiting = {{0, task}};
  while (!waiting.empty()) {
    const CellPair pair = waiting.back();
    waiting.pop_back();
    const TreeCell &source = from[pair.source], &target = to[pair.target];
    double& bound = found.bound[pair.target - found.first];
    if (const auto far = far_pair(sources, pair.source, target, tolerance)) {
      found.to_locals[std::size_t(far->order)].push_back(pair);
      bound += far->bound;
      continue;
    }
    // Few points that lie apart: their cell's ball holds the faces that a point of it does not see near.
    if (target.leaf() && target.radius > 1.5 * source.radius && source.count() * 12 > harmonics(sources.order())) {
      double nearest2 = std::numeric_limits<double>::infinity();
      for (const Vec3& point : points.subspan(target.begin, target.count()))
        nearest2 = std::min(nearest2, (point - source.centre).squaredNorm());
      const double lost = multipole_bound(sources, pair.source, std::sqrt(nearest2));
      if (lost <= share(sources, target, tolerance)) {
        found.at_points.push_back(pair);
        bound += lost;
        continue;
      }
    }
    if (source.leaf() && target.leaf()) {
      found.near.push_back(pair);
      found.near_faces += std::uint64_t(source.count()) * target.count();
    } else if (target.leaf() || (!source.leaf() && source.radius >= target.radius)) {
      waiting.push_back({source.right, pair.target});
      waiting.push_back({pair.source + 1, pair.target});
    } else {
      waiting.push_back({pair.source, target.right});
      waiting.push_back({pair.source, pair.target + 1});
    }
  }

  const auto by_target = [](const CellPair& a, const CellPair& b) { return a.target < b.target; };
  std::stable_sort(found.at_points.begin(), found.at_points.end(), by_target);
  std::stable_sort(found.near.begin(), found.near.end(), by_target);
  found.largest_bound = 0;
  for (std::uint32_t cell = found.first; cell < found.last; ++cell) {
    const double bound = found.bound[cell - found.first];
    found.largest_bound = std::max(found.largest_bound, bound);
    if (to[cell].leaf()) continue;
    found.bound[cell + 1 - found.first] += bound;
    found.bound[to[cell].right - found.first] += bound;
  }
}

std::vector<std::uint32_t> point_tasks(const PlaceTree& targets, std::uint32_t points) {
  std::vector<std::uint32_t> tasks;
  for (std::uint32_t cell = 0; cell < targets.cells.size();) {
    const TreeCell& one = targets.cells[cell];
    const bool task = one.leaf() || one.count() <= points;
    if (task) tasks.push_back(cell);
    cell = task ? one.last : cell + 1;
  }
  return tasks;
}

} // namespace cowgpu::plan

#include "host/plan/polyhedron_fast.hpp"

#include "host/error.hpp"
#include "host/flush_denormals.hpp"
#include "host/parallel.hpp"
#include "host/plan/polyhedron_call.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace cowgpu::plan {
namespace {

using Rows = PolyhedronRows;

// Beyond so many units from the body's origin it is a point: what is left out is the square of its inverse.
constexpr double farthest_distance = 0x1p100;

// The field of a point mass.
void set_farthest(const FastBody& body, const Vec3& from, std::size_t i, PolyhedronValues& values) {
  const double distance = from.stableNorm(), volume = body.sources.volume();
  const Vec3 direction = from / distance;
  const double value = volume / distance, slope = value / distance, curve = slope / distance;
  values.field.value[i] = value * body.unit * body.unit;
  if (!values.field.gradient.empty()) values.field.gradient[i] = -slope * body.unit * direction;
  if (!values.field.hessian.empty()) {
    const Eigen::Matrix3d h = curve * (3 * direction * direction.transpose() - Eigen::Matrix3d::Identity());
    values.field.hessian[i] = {h(0, 0), h(0, 1), h(0, 2), h(1, 1), h(1, 2), h(2, 2)};
  }
  // What a point leaves out is of the second degree, 2^-200 of this.
  if (!values.bound.empty()) values.bound[i] = slope * body.unit * 0x1p-100;
}

// v/R^2 in units, v the volume and R the radius of its ball.
struct Scale {
  explicit Scale(const FastBody& body) {
    const double volume = std::abs(body.sources.volume());
    radius = std::cbrt(0.75 * std::numbers::inv_pi * volume);
    gradient = volume > 0 ? volume / (radius * radius) : 0;
  }
  double radius, gradient;
};

class FasterPolyhedron final : public PreparedPolyhedron {
public:
  FasterPolyhedron(const PolyhedronProblem& problem, std::unique_ptr<PreparedPolyhedron> fast,
                   std::unique_ptr<PreparedPolyhedron> direct, std::function<bool(std::uint64_t)> pays)
      : problem_(problem), fast_(std::move(fast)), direct_(std::move(direct)), pays_(std::move(pays)) {}

  MemoryNeed memory(std::uint64_t points) const override { return chosen(points).memory(points); }
  PolyhedronValues at(std::span<const Vec3> points, Monitor& monitor, RunReport* report) const override {
    if (problem_.tolerance != 0) check_fast(problem_);
    return chosen(points.size()).at(points, monitor, report);
  }

private:
  const PreparedPolyhedron& chosen(std::uint64_t points) const { return pays_(points) ? *fast_ : *direct_; }

  PolyhedronProblem problem_;
  std::unique_ptr<PreparedPolyhedron> fast_, direct_;
  std::function<bool(std::uint64_t)> pays_;
};

} // namespace

FastBody::FastBody(const PolyhedronProblem& problem, const FastSettings& settings, unsigned threads, Monitor& monitor)
    : unit(polyhedron_unit(problem.vertices)), touching(touching_distance(problem.vertices) / unit),
      translations(settings.order),
      sources(problem.vertices, problem.faces, unit, largest_tree_leaf, translations, threads, monitor) {}

std::uint64_t FastBody::bytes(const PolyhedronProblem& problem, const FastSettings& settings) {
  return PolyhedronSources::bytes(problem.faces.size(), largest_tree_leaf, settings.order);
}

std::uint64_t FastBody::bytes_while_made(const PolyhedronProblem& problem, const FastSettings& settings,
                                         unsigned threads) {
  return PolyhedronSources::bytes_while_made(problem.faces.size(), settings.order, threads);
}

LeafFaces::LeafFaces(const PolyhedronProblem& problem, const PolyhedronSources& sources) {
  for (const std::uint32_t leaf : sources.leaves()) {
    starts.push_back(sources.cells()[leaf].begin);
    centres.push_back(sources.cells()[leaf].centre);
  }
  starts.push_back(std::uint32_t(problem.faces.size()));
  if (problem.derivatives == Derivatives::second) sharp = sharp_edges(problem.vertices, problem.faces);
}

FastPoints::FastPoints(const PolyhedronProblem& problem, const FastSettings& settings, const FastBody& body,
                       std::span<const Vec3> all, std::uint32_t largest_leaf, unsigned threads) {
  for (const Vec3& p : all)
    if (!p.allFinite()) throw Error(Fault::bad_argument, "a point is not finite");
  if (all.size() >= std::uint64_t(1) << 32)
    throw Error(Fault::too_large, "more than 2^32 points at once: ask for them in parts");
  const Scale scale(body);
  tolerance = {settings.tau * scale.gradient, scale.radius, largest_leaf};
  limit = problem.tolerance * scale.gradient;
  const double far_from = far_distance(body.sources, tolerance);
  std::vector<std::uint32_t> near;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Vec3 from = all[i] / body.unit - body.sources.origin();
    if (from.cwiseAbs().maxCoeff() >= farthest_distance)
      farthest.push_back(std::uint32_t(i));
    else
      (from.norm() < far_from ? near : far).push_back(std::uint32_t(i));
  }
  if (near.empty()) return;
  targets.emplace(
      near.size(), [&](std::size_t i) { return Vec3(all[near[i]] / body.unit); }, largest_leaf, threads);
  points.resize(near.size());
  for (std::size_t i = 0; i < near.size(); ++i) {
    targets->order[i] = near[targets->order[i]];
    points[i] = all[targets->order[i]] / body.unit;
  }
  tasks = point_tasks(*targets, task_points);
}

std::uint64_t FastPoints::bytes(std::uint64_t points, std::uint32_t largest_leaf) {
  return PlaceTree::bytes(points, largest_leaf) + points * sizeof(Vec3);
}

std::uint64_t FastPoints::bytes_while_made(std::uint64_t points) {
  return PlaceTree::bytes_while_made(points);
}

void check_fast(const PolyhedronProblem& problem) {
  if (!(problem.tolerance >= least_polyhedron_tolerance && problem.tolerance <= largest_polyhedron_tolerance))
    throw Error(Fault::bad_argument,
                fmt::format("a tolerance of {} is out of range: 0 for the direct sum, or {} ... {}", problem.tolerance,
                            least_polyhedron_tolerance, largest_polyhedron_tolerance));
}

// Where it is guaranteed, the pairs' share follows from what their bounds add up to at the worst of the task's points: these go
// in proportion, so that few rounds find the largest share that keeps the limit.
void find_task_pairs(const PolyhedronProblem& problem, const FastBody& body, const FastPoints& points,
                     std::uint32_t task, TaskPairs& pairs) {
  PairTolerance tolerance = points.tolerance;
  const auto find = [&] {
    find_pairs(body.sources, *points.targets, points.points, task, tolerance, pairs);
    return pairs.largest_bound / points.limit;
  };
  double part = find();
  if (!problem.guarantee) return;
  constexpr int most_rounds = 12;
  for (int round = 0; round < most_rounds && !(part <= 1 && (part > 0.5 || round > 2)); ++round) {
    if (!(part > 0)) break;
    tolerance.tau *= part > 1 ? std::min(0.8 / part, 0.5) : std::min(0.8 / part, 100.0);
    part = find();
  }
  if (part <= 1) return;
  tolerance.tau = 0; // all faces by their closed forms
  find();
}

void count_task(const FastBody& body, const TaskPairs& pairs, RunReport& report) {
  report.elements += double(pairs.near_faces);
  for (std::size_t order = 0; order < pairs.to_locals.size(); ++order) {
    const std::size_t count = pairs.to_locals[order].size();
    report.pairs += count;
    report.multiply_adds += double(count) * body.translations.multiply_adds(int(order));
  }
}

void set_far_points(const PolyhedronProblem& problem, const FastBody& body, const FastPoints& points,
                    std::span<const Vec3> all, unsigned threads, Monitor& monitor, PolyhedronValues& values) {
  for (const std::uint32_t i : points.farthest)
    set_farthest(body, all[i] / body.unit - body.sources.origin(), i, values);
  const bool second = problem.derivatives == Derivatives::second;
  constexpr std::size_t block = 64;
  parallel_for(threads, (points.far.size() + block - 1) / block, [&](std::size_t task, unsigned) {
    const FlushDenormals flush;
    check_stop(monitor);
    const auto own = std::span(points.far).subspan(task * block, std::min(block, points.far.size() - task * block));
    alignas(64) double places[3 * block], sums[Rows::second * block] = {};
    for (std::size_t i = 0; i < block; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        places[k * block + i] = all[own[std::min(i, own.size() - 1)]][Eigen::Index(k)] / body.unit;
    FarSums field(body.sources, body.translations);
    field.add_multipoles(0, places, block, second, sums);
    for (std::size_t i = 0; i < own.size(); ++i) {
      store_sums(problem, body.unit, sums + i, block, own[i], values);
      const double distance = (all[own[i]] / body.unit - body.sources.origin()).norm();
      if (problem.guarantee) values.bound[own[i]] = body.unit * multipole_bound(body.sources, 0, distance);
    }
  });
}

LeafColumns LeafRoom::columns(const FastPoints& points, const TreeCell& leaf, std::size_t group, std::size_t rows) {
  const std::size_t count = (leaf.count() + group - 1) / group * group;
  points_.resize(3 * count / 8);
  sums_.assign(rows * count / 8, Line{});
  double* columns = points_.front().values;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3& point = points.points[std::min<std::size_t>(leaf.begin + i, leaf.end - 1)];
    for (std::size_t k = 0; k < 3; ++k) columns[k * count + i] = point[Eigen::Index(k)];
  }
  return {count, columns, sums_.front().values};
}

void store_leaf(const PolyhedronProblem& problem, const FastBody& body, const FastPoints& points,
                const TaskPairs& pairs, std::uint32_t leaf, const LeafColumns& columns, PolyhedronValues& values) {
  const TreeCell& cell = points.targets->cells[leaf];
  const double bound = pairs.bound[leaf - pairs.first];
  for (std::size_t i = 0; i < cell.count(); ++i) {
    const std::uint32_t to = points.targets->order[cell.begin + i];
    store_sums(problem, body.unit, columns.sums + i, columns.count, to, values);
    if (problem.guarantee) values.bound[to] = body.unit * bound;
  }
}

std::uint64_t task_bytes(std::uint64_t points, std::uint32_t largest_leaf, const FastSettings& settings) {
  // Lists of pairs: of tasks of 2048 points and more, 18 to 69 bytes a point with 88,320 faces. Few points far apart take more
  // each, 160 bytes of 256 and 768 of 16, in all below the room that a task gets (bench/polyhedron_fast.md).
  return FarSums::bytes(points, largest_leaf, settings.order) + points * 200 + (1 << 20);
}

std::uint64_t fast_value_bytes(const PolyhedronProblem& problem, std::uint64_t points) {
  return points * (8 + 24 + 8 + (problem.derivatives == Derivatives::second ? 49 : 0) + (problem.guarantee ? 8 : 0));
}

std::unique_ptr<PreparedPolyhedron> faster_polyhedron(const PolyhedronProblem& problem,
                                                      std::unique_ptr<PreparedPolyhedron> fast,
                                                      std::unique_ptr<PreparedPolyhedron> direct,
                                                      std::function<bool(std::uint64_t)> pays) {
  return std::make_unique<FasterPolyhedron>(problem, std::move(fast), std::move(direct), std::move(pays));
}

} // namespace cowgpu::plan

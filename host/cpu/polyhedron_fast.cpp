#include "host/cpu/polyhedron_fast.hpp"

#include "host/clock.hpp"
#include "host/cpu/polyhedron_kernel.hpp"
#include "host/error.hpp"
#include "host/flush_denormals.hpp"
#include "host/parallel.hpp"
#include "host/plan/polyhedron_call.hpp"
#include "host/plan/polyhedron_far.hpp"
#include "host/plan/polyhedron_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numbers>

namespace cowgpu::cpu {
namespace {

using plan::FarSums;
using plan::PolyhedronPatches;
using Rows = plan::PolyhedronRows;

// Beyond so many units from the body's origin it is a point: what is left out is the square of its inverse.
constexpr double farthest = 0x1p100;

// What does not depend on points.
struct Prepared {
  Prepared(const PolyhedronProblem& problem, const plan::FastSettings& settings, unsigned threads, Monitor& monitor)
      : unit(plan::polyhedron_unit(problem.vertices)), touching(plan::touching_distance(problem.vertices) / unit),
        translations(settings.order),
        sources(problem.vertices, problem.faces, unit, plan::largest_tree_leaf, translations, threads, monitor) {
    std::vector<std::uint32_t> starts;
    std::vector<Vec3> centres;
    for (const std::uint32_t leaf : sources.leaves()) {
      starts.push_back(sources.cells()[leaf].begin);
      centres.push_back(sources.cells()[leaf].centre);
    }
    starts.push_back(std::uint32_t(problem.faces.size()));
    const bool second = problem.derivatives == Derivatives::second;
    const auto sharp = second ? plan::sharp_edges(problem.vertices, problem.faces) : std::vector<std::uint8_t>();
    const plan::PatchFaces of{sources.tree().order, starts, centres, sharp};
    check_stop(monitor);
    if (settings.near == plan::NearDigits::single)
      singles = PolyhedronPatches<float>(problem.vertices, problem.faces, of, unit, threads);
    else
      doubles = PolyhedronPatches<double>(problem.vertices, problem.faces, of, unit, threads);
  }

  double unit, touching;
  plan::Translations translations;
  plan::PolyhedronSources sources;
  PolyhedronPatches<double> doubles;
  PolyhedronPatches<float> singles;
};

// One thread's memory.
struct Worker {
  explicit Worker(const Prepared& prepared) : far(prepared.sources, prepared.translations) {}

  struct alignas(64) Line {
    double values[8];
  };
  plan::TaskPairs pairs;
  FarSums far;
  PolyhedronScratch scratch;
  std::vector<Line> points, sums;
  std::vector<std::uint32_t> patches;
  std::uint64_t near_faces = 0;
};

void check(const PolyhedronProblem& problem) {
  if (!(problem.tolerance >= least_polyhedron_tolerance && problem.tolerance <= largest_polyhedron_tolerance))
    throw Error(Fault::bad_argument,
                fmt::format("a tolerance of {} is out of range: 0 for the direct sum, or {} ... {}", problem.tolerance,
                            least_polyhedron_tolerance, largest_polyhedron_tolerance));
}

// The field of a point mass.
void set_farthest(const Prepared& prepared, const Vec3& from, std::size_t i, PolyhedronValues& values) {
  const double distance = from.stableNorm(), volume = prepared.sources.volume();
  const Vec3 direction = from / distance;
  const double value = volume / distance, slope = value / distance, curve = slope / distance;
  values.field.value[i] = value * prepared.unit * prepared.unit;
  if (!values.field.gradient.empty()) values.field.gradient[i] = -slope * prepared.unit * direction;
  if (!values.field.hessian.empty()) {
    const Eigen::Matrix3d h = curve * (3 * direction * direction.transpose() - Eigen::Matrix3d::Identity());
    values.field.hessian[i] = {h(0, 0), h(0, 1), h(0, 2), h(1, 1), h(1, 2), h(2, 2)};
  }
  // What a point leaves out is of the second degree, 2^-200 of this.
  if (!values.bound.empty()) values.bound[i] = slope * prepared.unit * 0x1p-100;
}

class FastPolyhedron final : public PreparedPolyhedron {
public:
  FastPolyhedron(const PolyhedronProblem& problem, unsigned threads)
      : problem_(problem), threads_(threads ? threads : all_threads()) {}

  MemoryNeed memory(std::uint64_t points) const override;
  PolyhedronValues at(std::span<const Vec3> points, Monitor& monitor, RunReport* report) const override;

private:
  std::shared_ptr<const Prepared> prepare(const plan::FastSettings& settings, Monitor& monitor) const;
  struct Call;
  void find_pairs(const Call& call, std::uint32_t task, Worker& worker) const;
  void sum_task(const Call& call, std::uint32_t task, Worker& worker, PolyhedronValues& values) const;
  void sum_leaf(const Call& call, std::uint32_t leaf, Worker& worker, PolyhedronValues& values) const;
  void sum_far(const Prepared& prepared, std::span<const Vec3> points, std::span<const std::uint32_t> far,
               Monitor& monitor, PolyhedronValues& values) const;
  bool second() const { return problem_.derivatives == Derivatives::second; }

  PolyhedronProblem problem_;
  unsigned threads_;
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const Prepared> prepared_;
};

// What one call of at() sums.
struct FastPolyhedron::Call {
  const Prepared& prepared;
  const plan::PlaceTree& targets;
  std::span<const Vec3> points;          ///< in units, in the tree's order
  std::span<const std::uint32_t> origin; ///< [point in the tree's order]: index of the caller's
  SumDigits digits;
  bool single;
  plan::PairTolerance tolerance;
  double limit; ///< largest bound of the gradient's truncation that is allowed, where it is guaranteed; in units
};

std::shared_ptr<const Prepared> FastPolyhedron::prepare(const plan::FastSettings& settings, Monitor& monitor) const {
  const std::lock_guard lock(mutex_);
  if (!prepared_) prepared_ = std::make_shared<const Prepared>(problem_, settings, threads_, monitor);
  return prepared_;
}

MemoryNeed FastPolyhedron::memory(std::uint64_t points) const {
  using namespace plan;
  const FastSettings settings = fast_settings(problem_);
  const std::uint64_t faces = problem_.faces.size(), leaves = PlaceTree::cell_count(faces, largest_tree_leaf) / 2 + 1;
  const std::uint64_t patches = settings.near == NearDigits::single ? PolyhedronPatches<float>::bytes(faces, leaves)
                                                                    : PolyhedronPatches<double>::bytes(faces, leaves);
  const std::uint64_t held = PolyhedronSources::bytes(faces, largest_tree_leaf, settings.order);
  const std::uint64_t made = PolyhedronSources::bytes_while_made(faces, settings.order, threads_);
  const std::uint64_t sharp = second() ? 64 * faces : 0;
  // Lists of pairs: of tasks of 2048 points and more, 18 to 69 bytes a point with 88,320 faces. Few points far apart take more
  // each, 160 bytes of 256 and 768 of 16, in all below the room that a thread gets (bench/polyhedron_fast.md).
  const std::uint64_t tasks =
      threads_ * (FarSums::bytes(std::min<std::uint64_t>(points, task_points), largest_tree_leaf, settings.order) +
                  std::min<std::uint64_t>(points, task_points) * 200 + (1 << 20));
  const std::uint64_t results = points * (8 + 24 + 8 + (second() ? 49 : 0) + (problem_.guarantee ? 8 : 0));
  const std::uint64_t tree = PlaceTree::bytes(points, largest_tree_leaf) + points * sizeof(Vec3);
  const std::uint64_t call = results + tree + std::max(PlaceTree::bytes_while_made(points), tasks);
  return {held + std::max({made, patches + sharp, patches + call}) + (1 << 20), 0};
}

PolyhedronValues FastPolyhedron::at(std::span<const Vec3> points, Monitor& monitor, RunReport* report) const {
  const auto start = Clock::now();
  check(problem_);
  for (const Vec3& p : points)
    if (!p.allFinite()) throw Error(Fault::bad_argument, "a point is not finite");
  if (points.size() >= std::uint64_t(1) << 32)
    throw Error(Fault::too_large, "more than 2^32 points at once: ask for them in parts");
  const FlushDenormals flush;
  const plan::FastSettings settings = plan::fast_settings(problem_);
  const std::shared_ptr<const Prepared> prepared = prepare(settings, monitor);
  const Vec3& origin = prepared->sources.origin();

  const std::size_t count = points.size();
  PolyhedronValues values = plan::polyhedron_values(problem_, count);
  const double volume = std::abs(prepared->sources.volume()), radius = std::cbrt(0.75 * std::numbers::inv_pi * volume);
  const double weight = volume > 0 ? volume / (radius * radius) : 0;
  const plan::PairTolerance tolerance{settings.tau * weight, radius, plan::largest_tree_leaf};
  const double far_distance = plan::far_distance(prepared->sources, tolerance);

  std::vector<std::uint32_t> near, far;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 from = points[i] / prepared->unit - origin;
    if (from.cwiseAbs().maxCoeff() >= farthest)
      set_farthest(*prepared, from, i, values);
    else
      (from.norm() < far_distance ? near : far).push_back(std::uint32_t(i));
  }
  sum_far(*prepared, points, far, monitor, values);
  double setup = seconds_since(start), near_faces = 0;
  if (!near.empty()) {
    plan::PlaceTree targets(
        near.size(), [&](std::size_t i) { return Vec3(points[near[i]] / prepared->unit); }, plan::largest_tree_leaf,
        threads_);
    std::vector<Vec3> sorted(near.size());
    for (std::size_t i = 0; i < near.size(); ++i) {
      targets.order[i] = near[targets.order[i]];
      sorted[i] = points[targets.order[i]] / prepared->unit;
    }
    near = {};
    setup = seconds_since(start);
    const Call call{*prepared,
                    targets,
                    sorted,
                    targets.order,
                    settings.near == plan::NearDigits::full ? SumDigits::full : SumDigits::nine,
                    settings.near == plan::NearDigits::single,
                    tolerance,
                    problem_.tolerance * weight};
    const std::vector<std::uint32_t> tasks = plan::point_tasks(targets, plan::task_points);
    std::vector<std::unique_ptr<Worker>> workers(threads_);
    std::atomic<std::size_t> done = 0;
    parallel_for(threads_, tasks.size(), [&](std::size_t i, unsigned thread) {
      const FlushDenormals here;
      check_stop(monitor);
      if (!workers[thread]) workers[thread] = std::make_unique<Worker>(*prepared);
      sum_task(call, tasks[i], *workers[thread], values);
      const std::size_t now = ++done;
      if (thread == 0) monitor.progress("polyhedron", double(now) / double(tasks.size()));
    });
    for (const auto& worker : workers)
      if (worker) near_faces += double(worker->near_faces);
  }
  if (report) {
    *report = {};
    report->setup_seconds = setup;
    report->seconds = seconds_since(start);
    report->elements = near_faces;
    report->full_elements = double(count) * double(problem_.faces.size());
  }
  return values;
}

// Where it is guaranteed, the pairs' share follows from what their bounds add up to at the worst of the task's points: these go
// in proportion, so that few rounds find the largest share that keeps the limit.
void FastPolyhedron::find_pairs(const Call& call, std::uint32_t task, Worker& worker) const {
  plan::PairTolerance tolerance = call.tolerance;
  const auto find = [&] {
    plan::find_pairs(call.prepared.sources, call.targets, call.points, task, tolerance, worker.pairs);
    return worker.pairs.largest_bound / call.limit;
  };
  double part = find();
  if (!problem_.guarantee) return;
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

void FastPolyhedron::sum_task(const Call& call, std::uint32_t task, Worker& worker, PolyhedronValues& values) const {
  find_pairs(call, task, worker);
  worker.near_faces += worker.pairs.near_faces;
  worker.far.gather(call.targets, worker.pairs);
  for (std::uint32_t cell = worker.pairs.first; cell < worker.pairs.last; ++cell)
    if (call.targets.cells[cell].leaf()) sum_leaf(call, cell, worker, values);
}

void FastPolyhedron::sum_leaf(const Call& call, std::uint32_t leaf, Worker& worker, PolyhedronValues& values) const {
  const plan::TreeCell& cell = call.targets.cells[leaf];
  const std::size_t count = (cell.count() + polyhedron_group - 1) / polyhedron_group * polyhedron_group;
  const std::size_t rows = second() ? Rows::second : Rows::first;
  worker.points.resize(3 * count / 8);
  worker.sums.assign(rows * count / 8, Worker::Line{});
  double *points = worker.points.front().values, *sums = worker.sums.front().values;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3& point = call.points[std::min<std::size_t>(cell.begin + i, cell.end - 1)];
    for (std::size_t k = 0; k < 3; ++k) points[k * count + i] = point[Eigen::Index(k)];
  }
  worker.far.add_leaf(call.targets, worker.pairs, leaf, points, count, second(), sums);
  worker.patches.clear();
  for (const plan::CellPair& pair : plan::TaskPairs::of_leaf(worker.pairs.near, leaf))
    worker.patches.push_back(call.prepared.sources.leaf_number(pair.source));
  const PolyhedronTerms terms{second(), call.digits, call.prepared.touching};
  if (call.single)
    sum_patches(call.prepared.singles, worker.patches, points, count, terms, worker.scratch, sums);
  else
    sum_patches(call.prepared.doubles, worker.patches, points, count, terms, worker.scratch, sums);

  const double bound = worker.pairs.bound[leaf - worker.pairs.first];
  for (std::size_t i = 0; i < cell.count(); ++i) {
    const std::uint32_t to = call.origin[cell.begin + i];
    plan::store_sums(problem_, call.prepared.unit, sums + i, count, to, values);
    if (problem_.guarantee) values.bound[to] = call.prepared.unit * bound;
  }
}

// Of all faces together.
void FastPolyhedron::sum_far(const Prepared& prepared, std::span<const Vec3> points, std::span<const std::uint32_t> far,
                             Monitor& monitor, PolyhedronValues& values) const {
  constexpr std::size_t block = 64;
  parallel_for(threads_, (far.size() + block - 1) / block, [&](std::size_t task, unsigned) {
    const FlushDenormals flush;
    check_stop(monitor);
    const auto own = far.subspan(task * block, std::min(block, far.size() - task * block));
    alignas(64) double places[3 * block], sums[Rows::second * block] = {};
    for (std::size_t i = 0; i < block; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        places[k * block + i] = points[own[std::min(i, own.size() - 1)]][Eigen::Index(k)] / prepared.unit;
    FarSums field(prepared.sources, prepared.translations);
    field.add_multipoles(0, places, block, second(), sums);
    for (std::size_t i = 0; i < own.size(); ++i) {
      plan::store_sums(problem_, prepared.unit, sums + i, block, own[i], values);
      const double distance = (points[own[i]] / prepared.unit - prepared.sources.origin()).norm();
      if (problem_.guarantee)
        values.bound[own[i]] = prepared.unit * plan::multipole_bound(prepared.sources, 0, distance);
    }
  });
}

class FasterPolyhedron final : public PreparedPolyhedron {
public:
  FasterPolyhedron(const PolyhedronProblem& problem, unsigned threads, std::unique_ptr<PreparedPolyhedron> direct)
      : problem_(problem), fast_(problem, threads), direct_(std::move(direct)) {}

  MemoryNeed memory(std::uint64_t points) const override { return chosen(points).memory(points); }
  PolyhedronValues at(std::span<const Vec3> points, Monitor& monitor, RunReport* report) const override {
    if (problem_.tolerance != 0) check(problem_);
    return chosen(points.size()).at(points, monitor, report);
  }

private:
  const PreparedPolyhedron& chosen(std::uint64_t points) const {
    if (plan::fast_sum_pays(problem_, points)) return fast_;
    return *direct_;
  }

  PolyhedronProblem problem_;
  FastPolyhedron fast_;
  std::unique_ptr<PreparedPolyhedron> direct_;
};

} // namespace

std::unique_ptr<PreparedPolyhedron> fast_polyhedron(const PolyhedronProblem& problem, unsigned threads) {
  return std::make_unique<FastPolyhedron>(problem, threads);
}

std::unique_ptr<PreparedPolyhedron> faster_polyhedron(const PolyhedronProblem& problem, unsigned threads,
                                                      std::unique_ptr<PreparedPolyhedron> direct) {
  return std::make_unique<FasterPolyhedron>(problem, threads, std::move(direct));
}

} // namespace cowgpu::cpu

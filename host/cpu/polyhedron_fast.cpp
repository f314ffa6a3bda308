#include "host/cpu/polyhedron_fast.hpp"

#include "host/clock.hpp"
#include "host/cpu/polyhedron_kernel.hpp"
#include "host/flush_denormals.hpp"
#include "host/parallel.hpp"
#include "host/plan/polyhedron_call.hpp"
#include "host/plan/polyhedron_fast.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>

namespace cowgpu::cpu {
namespace {

using plan::FastBody;
using plan::FastPoints;
using plan::PolyhedronPatches;
using Rows = plan::PolyhedronRows;

// What does not depend on points.
struct FastPrepared {
  FastPrepared(const PolyhedronProblem& problem, const plan::FastSettings& settings, unsigned threads, Monitor& monitor)
      : body(problem, settings, threads, monitor) {
    const plan::LeafFaces leaves(problem, body.sources);
    const plan::PatchFaces of{body.sources.tree().order, leaves.starts, leaves.centres, leaves.sharp};
    check_stop(monitor);
    if (settings.near == plan::NearDigits::single)
      singles = PolyhedronPatches<float>(problem.vertices, problem.faces, of, body.unit, threads);
    else
      doubles = PolyhedronPatches<double>(problem.vertices, problem.faces, of, body.unit, threads);
  }

  FastBody body;
  PolyhedronPatches<double> doubles;
  PolyhedronPatches<float> singles;
};

// One thread's memory.
struct FastWorker {
  explicit FastWorker(const FastBody& body) : far(body.sources, body.translations) {}

  plan::TaskPairs pairs;
  plan::FarSums far;
  plan::LeafRoom room;
  PolyhedronScratch scratch;
  std::vector<std::uint32_t> patches;
  RunReport work;
};

class FastPolyhedron final : public PreparedPolyhedron {
public:
  FastPolyhedron(const PolyhedronProblem& problem, unsigned threads)
      : problem_(problem), threads_(threads ? threads : all_threads()) {}

  MemoryNeed memory(std::uint64_t points) const override;
  PolyhedronValues at(std::span<const Vec3> points, Monitor& monitor, RunReport* report) const override;

private:
  std::shared_ptr<const FastPrepared> prepare(const plan::FastSettings& settings, Monitor& monitor) const;
  void sum_task(const FastPrepared& prepared, const plan::FastSettings& settings, const FastPoints& points,
                std::uint32_t task, FastWorker& worker, PolyhedronValues& values) const;
  bool second() const { return problem_.derivatives == Derivatives::second; }

  PolyhedronProblem problem_;
  unsigned threads_;
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const FastPrepared> prepared_;
};

std::shared_ptr<const FastPrepared> FastPolyhedron::prepare(const plan::FastSettings& settings,
                                                            Monitor& monitor) const {
  const std::lock_guard lock(mutex_);
  if (!prepared_) prepared_ = std::make_shared<const FastPrepared>(problem_, settings, threads_, monitor);
  return prepared_;
}

MemoryNeed FastPolyhedron::memory(std::uint64_t points) const {
  using namespace plan;
  const FastSettings settings = fast_settings(problem_);
  const std::uint64_t faces = problem_.faces.size(), leaves = PlaceTree::cell_count(faces, largest_tree_leaf) / 2 + 1;
  const std::uint64_t patches = settings.near == NearDigits::single ? PolyhedronPatches<float>::bytes(faces, leaves)
                                                                    : PolyhedronPatches<double>::bytes(faces, leaves);
  const std::uint64_t sharp = second() ? 64 * faces : 0;
  const std::uint64_t tasks =
      threads_ * task_bytes(std::min<std::uint64_t>(points, task_points), largest_tree_leaf, settings);
  const std::uint64_t call = fast_value_bytes(problem_, points) + FastPoints::bytes(points, largest_tree_leaf) +
                             std::max(FastPoints::bytes_while_made(points), tasks);
  return {FastBody::bytes(problem_, settings) +
              std::max({FastBody::bytes_while_made(problem_, settings, threads_), patches + sharp, patches + call}) +
              (1 << 20),
          0};
}

PolyhedronValues FastPolyhedron::at(std::span<const Vec3> all, Monitor& monitor, RunReport* report) const {
  const auto start = Clock::now();
  plan::check_fast(problem_);
  const FlushDenormals flush;
  const plan::FastSettings settings = plan::fast_settings(problem_);
  const std::shared_ptr<const FastPrepared> prepared = prepare(settings, monitor);
  const FastPoints points(problem_, settings, prepared->body, all, plan::largest_tree_leaf, threads_);
  PolyhedronValues values = plan::polyhedron_values(problem_, all.size());
  const double setup = seconds_since(start);
  plan::set_far_points(problem_, prepared->body, points, all, threads_, monitor, values);
  std::vector<std::unique_ptr<FastWorker>> workers(threads_);
  std::atomic<std::size_t> done = 0;
  parallel_for(threads_, points.tasks.size(), [&](std::size_t i, unsigned thread) {
    const FlushDenormals here;
    check_stop(monitor);
    if (!workers[thread]) workers[thread] = std::make_unique<FastWorker>(prepared->body);
    sum_task(*prepared, settings, points, points.tasks[i], *workers[thread], values);
    const std::size_t now = ++done;
    if (thread == 0) monitor.progress("polyhedron", double(now) / double(points.tasks.size()));
  });
  if (report) {
    *report = {};
    report->setup_seconds = setup;
    report->seconds = seconds_since(start);
    for (const auto& worker : workers) {
      if (!worker) continue;
      report->elements += worker->work.elements;
      report->pairs += worker->work.pairs;
      report->multiply_adds += worker->work.multiply_adds;
    }
    report->full_elements = double(all.size()) * double(problem_.faces.size());
  }
  return values;
}

void FastPolyhedron::sum_task(const FastPrepared& prepared, const plan::FastSettings& settings,
                              const FastPoints& points, std::uint32_t task, FastWorker& worker,
                              PolyhedronValues& values) const {
  const FastBody& body = prepared.body;
  const plan::PlaceTree& targets = *points.targets;
  plan::find_task_pairs(problem_, body, points, task, worker.pairs);
  plan::count_task(body, worker.pairs, worker.work);
  worker.far.begin(worker.pairs);
  worker.far.translate(targets, worker.pairs);
  worker.far.pass_down(targets, worker.pairs);
  const SumDigits digits = settings.near == plan::NearDigits::full ? SumDigits::full : SumDigits::nine;
  const PolyhedronTerms terms{second(), digits, body.touching};
  for (std::uint32_t leaf = worker.pairs.first; leaf < worker.pairs.last; ++leaf) {
    if (!targets.cells[leaf].leaf()) continue;
    const plan::LeafColumns own =
        worker.room.columns(points, targets.cells[leaf], polyhedron_group, second() ? Rows::second : Rows::first);
    worker.far.add_leaf(targets, worker.pairs, leaf, own.points, own.count, second(), own.sums);
    worker.patches.clear();
    for (const plan::CellPair& pair : plan::TaskPairs::of_leaf(worker.pairs.near, leaf))
      worker.patches.push_back(body.sources.leaf_number(pair.source));
    if (settings.near == plan::NearDigits::single)
      sum_patches(prepared.singles, worker.patches, own.points, own.count, terms, worker.scratch, own.sums);
    else
      sum_patches(prepared.doubles, worker.patches, own.points, own.count, terms, worker.scratch, own.sums);
    plan::store_leaf(problem_, body, points, worker.pairs, leaf, own, values);
  }
}

} // namespace

std::unique_ptr<PreparedPolyhedron> fast_polyhedron(const PolyhedronProblem& problem, unsigned threads) {
  return std::make_unique<FastPolyhedron>(problem, threads);
}

} // namespace cowgpu::cpu

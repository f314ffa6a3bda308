#include "host/gpu/polyhedron_fast.hpp"

#include "engine/kernels/polyhedron.hpp"
#include "engine/kernels/translations.hpp"
#include "host/clock.hpp"
#include "host/flush_denormals.hpp"
#include "host/gpu/errors.hpp"
#include "host/gpu/polyhedron.hpp"
#include "host/gpu/translation_program.hpp"
#include "host/parallel.hpp"
#include "host/plan/polyhedron_call.hpp"
#include "host/plan/polyhedron_fast.hpp"
#include "host/plan/polyhedron_strips.hpp"

#include <algorithm>
#include <future>
#include <mutex>
#include <optional>
#include <utility>

namespace cowgpu::gpu {
namespace {

using plan::FastBody;
using plan::FastPoints;
using plan::TaskPairs;
using Rows = plan::PolyhedronRows;

constexpr std::size_t group_points = engine::polyhedron_points;
static_assert(plan::largest_tree_leaf <= group_points); // a leaf is a group
constexpr std::size_t batch_tasks = 4;                  // so that the device is busy while the host does as many
// Software devices run on the processors that the host has, several times slower: the host keeps translations to itself there,
// and the leaves of points are smaller, so that more pairs of cells are translated and fewer faces are near.
constexpr std::uint32_t software_leaf = 32;

bool is_software(const engine::Gpu& gpu) {
  return gpu.facts().type == "software";
}
bool translations_on_device(const engine::Gpu& gpu, const PolyhedronLayout& layout) {
  return layout.translations || !is_software(gpu);
}

constexpr std::uint32_t no_local = ~std::uint32_t(0);

// What does not depend on points.
struct FastPrepared {
  FastPrepared(engine::Gpu& gpu, const PolyhedronLayout& layout, const PolyhedronProblem& problem, Monitor& monitor)
      : body(problem, plan::fast_settings(problem), all_threads(), monitor) {
    plan::LeafFaces leaves(problem, body.sources);
    const plan::PatchFaces of{body.sources.tree().order, leaves.starts, {}, leaves.sharp};
    {
      const plan::PolyhedronPatches<double> patches(problem.vertices, problem.faces, of, body.unit, 0);
      strips = plan::polyhedron_strips(patches);
    }
    check_stop(monitor);
    near = std::make_unique<engine::Polyhedron>(
        gpu.device(), engine::PolyhedronInput{strips.steps, problem.derivatives == Derivatives::second, body.touching,
                                              layout.iteration_budget});
    strips.steps = {};
    if (is_software(gpu)) largest_leaf = software_leaf;
    if (!translations_on_device(gpu, layout)) return;
    const TranslationProgram program = translation_program(body.translations);
    engine::TranslationsInput input{program.matrix, program.orders, program.places};
    input.iteration_budget = layout.iteration_budget;
    far = std::make_unique<engine::Translations>(gpu.device(), input);
    number.assign(body.sources.cells().size(), no_local);
  }

  FastBody body;
  plan::PolyhedronStrips strips; // without its steps, which are on the device
  std::unique_ptr<engine::Polyhedron> near;
  std::unique_ptr<engine::Translations> far;            // none where the host does what it does
  std::uint32_t largest_leaf = plan::largest_tree_leaf; // largest leaf of the tree of points
  std::vector<std::uint32_t> number;                    // [source cell]: among those of one call of far->add()
};

// Tasks that go through the device together.
struct TaskBatch {
  std::vector<TaskPairs> tasks;
  std::vector<std::uint32_t> first_group;         // [task]
  std::vector<std::vector<std::uint32_t>> locals; // [task][cell - first]: of those on the device; no_local
  std::size_t groups = 0, local_count = 0;
  std::vector<double> sums;       // [group][row][point]
  std::vector<double> expansions; // [local][harmonic][density]
};

class FastPolyhedron final : public PreparedPolyhedron {
public:
  FastPolyhedron(std::shared_ptr<engine::Gpu> gpu, const PolyhedronLayout& layout, const PolyhedronProblem& problem)
      : gpu_(std::move(gpu)), layout_(layout), problem_(problem) {}

  MemoryNeed memory(std::uint64_t points) const override;
  PolyhedronValues at(std::span<const Vec3> points, Monitor& monitor, RunReport* report) const override {
    plan::check_fast(problem_);
    const std::scoped_lock only(mutex_);
    return watched(*gpu_, monitor, [&] { return found(points, monitor, report); });
  }

private:
  PolyhedronValues found(std::span<const Vec3> all, Monitor& monitor, RunReport* report) const;
  TaskBatch find_batch(const FastPoints& points, std::size_t first, Monitor& monitor) const;
  void sum_near(const FastPoints& points, TaskBatch& batch, const engine::Hook& hook) const;
  void translate(const FastPoints& points, TaskBatch& batch, const Monitor& monitor) const;
  void finish_batch(const FastPoints& points, const TaskBatch& batch, Monitor& monitor, PolyhedronValues& values) const;
  bool second() const { return problem_.derivatives == Derivatives::second; }

  std::shared_ptr<engine::Gpu> gpu_;
  PolyhedronLayout layout_;
  PolyhedronProblem problem_;
  mutable std::mutex mutex_;
  mutable std::optional<FastPrepared> prepared_;
};

MemoryNeed FastPolyhedron::memory(std::uint64_t points) const {
  using namespace plan;
  const FastSettings settings = fast_settings(problem_);
  const std::uint64_t faces = problem_.faces.size(), leaves = PlaceTree::cell_count(faces, largest_tree_leaf) / 2 + 1;
  const std::uint64_t in_batch = std::min<std::uint64_t>(points, batch_tasks * task_points);
  const std::uint64_t cells = PlaceTree::cell_count(in_batch, software_leaf), groups = cells / 2 + 1;
  const std::uint64_t expansions = cells * densities * harmonics(settings.order) * sizeof(double);
  // A leaf's near faces are in some tens of patches.
  const std::uint64_t sums =
      engine::Polyhedron::sum_bytes(groups, groups * std::min<std::uint64_t>(leaves, 512), second());
  const std::uint64_t steps = PolyhedronStrips::bytes(faces);
  MemoryNeed need;
  need.device = engine::Polyhedron::step_bytes(3 * faces + 1) + sums;
  if (translations_on_device(*gpu_, layout_))
    need.device += engine::Translations::device_bytes(settings.order, cells) + (std::uint64_t(8) << 20);
  const std::uint64_t batches =
      3 * (batch_tasks * task_bytes(std::min<std::uint64_t>(points, task_points), software_leaf, settings) + 2 * sums +
           2 * expansions);
  const std::uint64_t call = fast_value_bytes(problem_, points) + FastPoints::bytes(points, software_leaf) +
                             std::max(FastPoints::bytes_while_made(points), batches);
  const std::uint64_t made = PolyhedronPatches<double>::bytes(faces, leaves) + 2 * steps + (second() ? 64 * faces : 0);
  need.host = FastBody::bytes(problem_, settings) +
              std::max({FastBody::bytes_while_made(problem_, settings, all_threads()), made,
                        faces * 4 + leaves * sizeof(PolyhedronStrips::Box) + call}) +
              need.device + (1 << 20);
  return need;
}

PolyhedronValues FastPolyhedron::found(std::span<const Vec3> all, Monitor& monitor, RunReport* report) const {
  const auto start = Clock::now();
  const FlushDenormals flush;
  if (!prepared_) prepared_.emplace(*gpu_, layout_, problem_, monitor);
  const FastBody& body = prepared_->body;
  const FastPoints points(problem_, plan::fast_settings(problem_), body, all, prepared_->largest_leaf, all_threads());
  PolyhedronValues values = plan::polyhedron_values(problem_, all.size());
  const double setup = seconds_since(start);
  gpu_->take_profile();
  plan::set_far_points(problem_, body, points, all, all_threads(), monitor, values);

  // While the device works on one batch the host ends the one before and begins the next one.
  const std::size_t count = (points.tasks.size() + batch_tasks - 1) / batch_tasks;
  RunReport work;
  std::optional<TaskBatch> last, now, next;
  if (count > 0) now = find_batch(points, 0, monitor);
  for (std::size_t b = 0; b < count; ++b) {
    auto host = std::async(std::launch::async, [&] {
      const FlushDenormals here;
      if (last) finish_batch(points, *last, monitor, values);
      if (b + 1 < count) next = find_batch(points, (b + 1) * batch_tasks, monitor);
    });
    for (const TaskPairs& pairs : now->tasks) plan::count_task(body, pairs, work);
    sum_near(points, *now, [&](double part) {
      monitor.progress("polyhedron", (double(b) + part) / double(count));
      return !monitor.stopped();
    });
    if (prepared_->far) translate(points, *now, monitor);
    host.get();
    last = std::exchange(now, std::exchange(next, std::nullopt));
  }
  if (last) finish_batch(points, *last, monitor, values);
  if (report) {
    *report = std::move(work);
    report->setup_seconds = setup;
    report->seconds = seconds_since(start);
    report->full_elements = double(all.size()) * double(problem_.faces.size());
    for (const auto& k : gpu_->take_profile()) report->kernels.push_back({k.kernel, k.dispatches, k.seconds});
  }
  return values;
}

TaskBatch FastPolyhedron::find_batch(const FastPoints& points, std::size_t first, Monitor& monitor) const {
  const std::span<const plan::TreeCell> cells = points.targets->cells;
  TaskBatch batch;
  batch.tasks.resize(std::min(batch_tasks, points.tasks.size() - first));
  parallel_for(0, batch.tasks.size(), [&](std::size_t i, unsigned) {
    const FlushDenormals flush;
    check_stop(monitor);
    plan::find_task_pairs(problem_, prepared_->body, points, points.tasks[first + i], batch.tasks[i]);
  });
  for (const TaskPairs& task : batch.tasks) {
    batch.first_group.push_back(std::uint32_t(batch.groups));
    for (std::uint32_t cell = task.first; cell < task.last; ++cell)
      if (cells[cell].leaf()) ++batch.groups;
    std::vector<std::uint32_t>& locals = batch.locals.emplace_back(task.last - task.first, no_local);
    for (const auto& pairs : task.to_locals)
      for (const plan::CellPair& pair : pairs) locals[pair.target - task.first] = 0;
    for (std::uint32_t& local : locals)
      if (local != no_local) local = std::uint32_t(batch.local_count++);
  }
  return batch;
}

// Leaves are groups.
void FastPolyhedron::sum_near(const FastPoints& points, TaskBatch& batch, const engine::Hook& hook) const {
  const plan::PolyhedronStrips& strips = prepared_->strips;
  const plan::PolyhedronSources& sources = prepared_->body.sources;
  plan::DirectLists lists;
  std::vector<double> columns(3 * batch.groups * group_points);
  std::vector<std::uint32_t> counts;
  double* to = columns.data();
  for (const TaskPairs& task : batch.tasks)
    for (std::uint32_t leaf = task.first; leaf < task.last; ++leaf) {
      const plan::TreeCell& cell = points.targets->cells[leaf];
      if (!cell.leaf()) continue;
      const std::span<const Vec3> own = std::span(points.points).subspan(cell.begin, cell.count());
      const plan::PointBox box(own);
      for (const plan::CellPair& pair : TaskPairs::of_leaf(task.near, leaf))
        lists.add(strips, sources.leaf_number(pair.source), box);
      lists.end_group();
      counts.push_back(cell.count());
      for (std::size_t i = 0; i < group_points; ++i)
        for (std::size_t k = 0; k < 3; ++k)
          to[k * group_points + i] = own[std::min(i, own.size() - 1)][Eigen::Index(k)];
      to += 3 * group_points;
    }
  batch.sums.assign(prepared_->near->rows() * batch.groups * group_points, 0.0);
  prepared_->near->sum(columns, counts, {lists.near.ranges, lists.near.starts}, {lists.far.ranges, lists.far.starts},
                       batch.sums, hook);
}

// Order by order, as many sources and pairs at once as the device has room for.
void FastPolyhedron::translate(const FastPoints& points, TaskBatch& batch, const Monitor& monitor) const {
  const plan::PolyhedronSources& sources = prepared_->body.sources;
  const std::span<const plan::TreeCell> from = sources.cells(), to = points.targets->cells;
  engine::Translations& device = *prepared_->far;
  device.begin(batch.local_count);
  struct Pair {
    std::uint32_t source, target, local;
  };
  std::vector<Pair> pairs;
  std::vector<std::uint32_t> used; // sources
  std::vector<double> multipoles;
  std::vector<engine::TranslationPair> shifts;
  std::vector<engine::TranslationRun> runs;
  for (int order = 0; order <= sources.order(); ++order) {
    pairs.clear();
    for (std::size_t t = 0; t < batch.tasks.size(); ++t)
      for (const plan::CellPair& pair : batch.tasks[t].to_locals[std::size_t(order)])
        pairs.push_back({pair.source, pair.target, batch.locals[t][pair.target - batch.tasks[t].first]});
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.local < b.local; });
    const std::size_t numbers = plan::densities * plan::harmonics(order);
    const auto flush = [&] {
      check_stop(monitor);
      multipoles.resize(used.size() * numbers);
      for (std::size_t s = 0; s < used.size(); ++s) {
        std::copy_n(sources.multipoles(used[s]), numbers, &multipoles[s * numbers]);
        prepared_->number[used[s]] = no_local;
      }
      device.add(order, multipoles, shifts, runs);
      used.clear();
      shifts.clear();
      runs.clear();
    };
    for (const Pair& pair : pairs) {
      std::uint32_t& number = prepared_->number[pair.source];
      if (number == no_local) {
        if (used.size() == device.most_sources(order)) flush();
        number = std::uint32_t(used.size());
        used.push_back(pair.source);
      }
      const Vec3 shift = to[pair.target].centre - from[pair.source].centre;
      if (runs.empty() || runs.back().local != pair.local)
        runs.push_back({pair.local, std::uint32_t(shifts.size()), 0});
      ++runs.back().count;
      shifts.push_back({{shift[0], shift[1], shift[2]}, number});
      if (shifts.size() == device.most_pairs(order)) flush();
    }
    if (!shifts.empty()) flush();
  }
  batch.expansions.resize(batch.local_count * plan::densities * plan::harmonics(sources.order()));
  if (batch.local_count > 0) device.read(batch.expansions);
}

void FastPolyhedron::finish_batch(const FastPoints& points, const TaskBatch& batch, Monitor& monitor,
                                  PolyhedronValues& values) const {
  const FastBody& body = prepared_->body;
  const plan::PlaceTree& targets = *points.targets;
  const std::size_t numbers = plan::densities * plan::harmonics(body.sources.order()), rows = prepared_->near->rows();
  parallel_for(0, batch.tasks.size(), [&](std::size_t t, unsigned) {
    const FlushDenormals flush;
    check_stop(monitor);
    const TaskPairs& task = batch.tasks[t];
    plan::FarSums far(body.sources, body.translations);
    plan::LeafRoom room;
    far.begin(task);
    if (!prepared_->far) far.translate(targets, task);
    for (std::uint32_t cell = task.first; prepared_->far && cell < task.last; ++cell)
      if (const std::uint32_t local = batch.locals[t][cell - task.first]; local != no_local)
        std::copy_n(&batch.expansions[local * numbers], numbers, far.local(cell));
    far.pass_down(targets, task);
    std::size_t at = batch.first_group[t];
    for (std::uint32_t leaf = task.first; leaf < task.last; ++leaf) {
      const plan::TreeCell& cell = targets.cells[leaf];
      if (!cell.leaf()) continue;
      const plan::LeafColumns own = room.columns(points, cell, plan::tree_group, second() ? Rows::second : Rows::first);
      const double* sums = &batch.sums[at * rows * group_points];
      for (std::size_t i = 0; i < cell.count(); ++i) take_sums(sums + i, group_points, rows, own.sums + i, own.count);
      far.add_leaf(targets, task, leaf, own.points, own.count, second(), own.sums);
      plan::store_leaf(problem_, body, points, task, leaf, own, values);
      ++at;
    }
  });
}

} // namespace

std::unique_ptr<PreparedPolyhedron> fast_polyhedron(std::shared_ptr<engine::Gpu> gpu, const PolyhedronLayout& layout,
                                                    const PolyhedronProblem& problem) {
  return std::make_unique<FastPolyhedron>(std::move(gpu), layout, problem);
}

} // namespace cowgpu::gpu

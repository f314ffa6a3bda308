#include "host/gpu/polyhedron.hpp"

#include "engine/kernels/polyhedron.hpp"
#include "host/clock.hpp"
#include "host/gpu/errors.hpp"
#include "host/gpu/moments.hpp"
#include "host/gpu/polyhedron_fast.hpp"
#include "host/gpu/potential.hpp"
#include "host/plan/polyhedron_call.hpp"
#include "host/plan/polyhedron_fast.hpp"
#include "host/plan/polyhedron_strips.hpp"
#include "host/plan/potential.hpp"

#include <algorithm>
#include <mutex>
#include <numbers>
#include <optional>
#include <utility>

namespace cowgpu::gpu {
namespace {

constexpr std::size_t group = engine::polyhedron_points;
constexpr std::size_t batch_groups = 1024; // so that lists of faces and sums take little memory

using Rows = plan::PolyhedronRows;

// What a problem's calls share, made by the first.
struct Prepared {
  plan::PolyhedronSurface surface;
  plan::PolyhedronStrips strips; // without its steps, which are on the device
  std::unique_ptr<engine::Polyhedron> device;
  std::optional<Multipoles> moments;
};

class GpuPolyhedron final : public PreparedPolyhedron {
public:
  GpuPolyhedron(std::shared_ptr<engine::Gpu> gpu, const PolyhedronLayout& layout, const PolyhedronProblem& problem)
      : gpu_(std::move(gpu)), layout_(layout), problem_(problem) {}

  MemoryNeed memory(std::uint64_t points) const override {
    const std::uint64_t faces = problem_.faces.size(), patches = faces / plan::direct_patch + 1;
    MomentProblem moments;
    moments.vertices = problem_.vertices;
    moments.faces = problem_.faces;
    moments.lmax = plan::far_degree;
    const MemoryNeed far = gpu::moments(gpu_, layout_.moments, moments)->memory();
    const std::uint64_t groups = std::min<std::uint64_t>(points / group + 1, batch_groups);
    const std::uint64_t sums = engine::Polyhedron::sum_bytes(groups, groups * (patches + 2), second());
    const std::uint64_t steps = plan::PolyhedronStrips::bytes(faces);
    MemoryNeed need;
    need.device = std::max(far.device, engine::Polyhedron::step_bytes(3 * faces + 1) + sums);
    need.host = plan::polyhedron_call_bytes(problem_, points) + plan::PolyhedronPatches<double>::bytes(faces, patches) +
                2 * steps + 2 * sums + far.host + need.device +
                plan::potential_bytes(points, plan::far_degree, problem_.derivatives);
    return need;
  }

  PolyhedronValues at(std::span<const Vec3> points, Monitor& monitor, RunReport* report) const override {
    const std::scoped_lock only(mutex_);
    return watched(*gpu_, monitor, [&] { return found(points, monitor, report); });
  }

private:
  bool second() const { return problem_.derivatives == Derivatives::second; }

  void prepare() const {
    if (prepared_) return;
    Prepared made;
    made.surface = plan::polyhedron_surface(problem_, 0);
    const plan::PolyhedronPatches<double> patches(problem_.vertices, problem_.faces, made.surface.patches(),
                                                  made.surface.unit, 0);
    made.strips = plan::polyhedron_strips(patches);
    made.device = std::make_unique<engine::Polyhedron>(
        gpu_->device(), engine::PolyhedronInput{made.strips.steps, second(), made.surface.touching / made.surface.unit,
                                                layout_.iteration_budget});
    made.strips.steps = {};
    prepared_.emplace(std::move(made));
  }

  PolyhedronValues found(std::span<const Vec3> points, Monitor& monitor, RunReport* report) const {
    const auto start = Clock::now();
    prepare();
    const plan::PolyhedronPoints order = plan::polyhedron_points(prepared_->surface, points, 0);
    PolyhedronValues values = plan::polyhedron_values(problem_, points.size());
    const double setup = seconds_since(start);
    gpu_->take_profile();
    const std::span near(order.near);
    for (std::size_t first = 0; first < near.size() && prepared_->strips.faces > 0; first += batch_groups * group) {
      const auto batch = near.subspan(first, std::min(batch_groups * group, near.size() - first));
      sum(points, batch, values, [&](double part) {
        monitor.progress("polyhedron", (double(first) + part * double(batch.size())) / double(near.size()));
        return !monitor.stopped();
      });
    }
    if (!order.far.empty()) add_far(points, order.far, monitor, values);
    if (report) {
      *report = {};
      report->setup_seconds = setup;
      report->seconds = seconds_since(start);
      report->elements = double(near.size()) * double(problem_.faces.size());
      report->full_elements = double(points.size()) * double(problem_.faces.size());
      for (const auto& k : gpu_->take_profile()) report->kernels.push_back({k.kernel, k.dispatches, k.seconds});
    }
    return values;
  }

  void sum(std::span<const Vec3> points, std::span<const std::uint32_t> batch, PolyhedronValues& values,
           const engine::Hook& hook) const {
    const double unit = prepared_->surface.unit;
    const std::size_t groups = (batch.size() + group - 1) / group, rows = prepared_->device->rows();
    std::vector<Vec3> places;
    places.reserve(batch.size());
    for (const std::uint32_t i : batch) places.emplace_back(points[i] / unit);
    const plan::DirectLists lists = plan::direct_lists(prepared_->strips, places, group);
    std::vector<double> columns(3 * groups * group), sums(rows * groups * group);
    for (std::size_t i = 0; i < groups * group; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        columns[(i / group * 3 + k) * group + i % group] = places[std::min(i, places.size() - 1)][Eigen::Index(k)];
    std::vector<std::uint32_t> counts(groups, group);
    counts.back() = std::uint32_t(batch.size() - (groups - 1) * group);
    prepared_->device->sum(columns, counts, {lists.near.ranges, lists.near.starts},
                           {lists.far.ranges, lists.far.starts}, sums, hook);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      double own[Rows::second];
      take_sums(&sums[i / group * rows * group + i % group], group, rows, own, 1);
      plan::store_sums(problem_, unit, own, 1, batch[i], values);
    }
  }

  void add_far(std::span<const Vec3> points, std::span<const std::uint32_t> far, Monitor& monitor,
               PolyhedronValues& values) const {
    if (!prepared_->moments)
      prepared_->moments =
          gpu::moments(gpu_, layout_.moments, plan::far_moments(problem_, prepared_->surface))->run(monitor);
    const PotentialProblem series{*prepared_->moments, plan::far_degree, problem_.derivatives};
    const std::vector<Vec3> places = plan::far_places(prepared_->surface, points, far);
    plan::store_far(exterior_potential(gpu_, layout_.iteration_budget, series)->at(places, monitor), far, values);
  }

  std::shared_ptr<engine::Gpu> gpu_;
  PolyhedronLayout layout_;
  PolyhedronProblem problem_;
  mutable std::mutex mutex_;
  mutable std::optional<Prepared> prepared_;
};

} // namespace

void take_sums(const double* from, std::size_t from_stride, std::size_t rows, double* to, std::size_t to_stride) {
  for (std::size_t r = 0; r < rows; ++r) to[r * to_stride] = from[r * from_stride];
  to[Rows::value * to_stride] /= 2;
  for (std::size_t k = 0; k < 3; ++k) to[(Rows::gradient + k) * to_stride] *= -1;
  to[Rows::winding * to_stride] *= 0.25 * std::numbers::inv_pi;
}

std::unique_ptr<PreparedPolyhedron> polyhedron(std::shared_ptr<engine::Gpu> gpu, const PolyhedronLayout& layout,
                                               const PolyhedronProblem& problem) {
  auto direct = std::make_unique<GpuPolyhedron>(gpu, layout, problem);
  if (problem.tolerance == 0) return direct;
  // A GPU ends so many pairs in one dispatch before the host has made its trees; software devices are slower than the host.
  const double direct_pairs = gpu->facts().type == "software" ? 0 : 1e9;
  auto fast = fast_polyhedron(std::move(gpu), layout, problem);
  return plan::faster_polyhedron(problem, std::move(fast), std::move(direct), [=](std::uint64_t points) {
    return double(points) * double(problem.faces.size()) > direct_pairs && plan::fast_sum_pays(problem, points);
  });
}

} // namespace cowgpu::gpu

#include "host/gpu/potential.hpp"

#include "engine/kernels/potential.hpp"
#include "host/clock.hpp"
#include "host/gpu/errors.hpp"
#include "host/plan/potential.hpp"

#include <algorithm>
#include <utility>

namespace cowgpu::gpu {
namespace {

constexpr std::size_t per_lane = engine::potential_points_a_lane;
static_assert(plan::PotentialPoints::block % per_lane == 0);

// Lanes of a batch that begins with the plan's point `first`.
struct Batch {
  std::vector<double> points; // [lane][input][point]
  std::vector<std::uint32_t> tops;
};

Batch batch_of(const plan::PotentialPoints& points, std::size_t first, std::size_t lanes) {
  Batch batch;
  batch.points.reserve(lanes * 6 * per_lane);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const std::size_t at = first + lane * per_lane;
    for (const auto* values : {&points.x, &points.y, &points.z, &points.z_rest, &points.q, &points.start})
      batch.points.insert(batch.points.end(), values->begin() + std::ptrdiff_t(at),
                          values->begin() + std::ptrdiff_t(at + per_lane));
    batch.tops.push_back(std::uint32_t(points.tops[at / plan::PotentialPoints::block]));
  }
  return batch;
}

class GpuPotential final : public ExteriorPotential {
public:
  GpuPotential(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget, const PotentialProblem& problem)
      : gpu_(std::move(gpu)), iteration_budget_(iteration_budget), problem_(problem) {}

  MemoryNeed memory(std::uint64_t points) const override {
    const auto sets = std::uint32_t(plan::potential_sets(problem_.derivatives));
    const std::uint64_t lanes = std::min<std::uint64_t>(points / per_lane + plan::PotentialPoints::block, 1U << 15);
    MemoryNeed need;
    need.device =
        engine::Potential::device_bytes(std::uint32_t(problem_.lmax + int(problem_.derivatives)), sets, lanes);
    need.host = plan::potential_bytes(points, problem_.lmax, problem_.derivatives) + need.device +
                lanes * per_lane * 8 * (8 + 2 * sets);
    return need;
  }

  PotentialField at(std::span<const Vec3> points, Monitor& monitor, RunReport* report) const override {
    return watched(*gpu_, monitor, [&] { return found(points, monitor, report); });
  }

private:
  PotentialField found(std::span<const Vec3> points, Monitor& monitor, RunReport* report) const {
    const auto start = Clock::now();
    const plan::PotentialSeries series = plan::potential_series(problem_);
    const plan::PotentialPoints planned = plan::potential_points(problem_, series, points);
    const double setup = seconds_since(start);
    const std::size_t padded = planned.padded(), sets = series.sets;
    double elements = 0;
    for (const int top : planned.tops) elements += plan::PotentialPoints::entries(top) * plan::PotentialPoints::block;
    std::vector<double> sums(sets * padded);
    gpu_->take_profile();
    if (padded > 0) {
      engine::Potential kernel(gpu_->device(),
                               {std::uint32_t(series.top), std::uint32_t(sets), series.table, iteration_budget_});
      const std::size_t most = kernel.most_lanes() * per_lane;
      std::vector<double> found;
      for (std::size_t first = 0; first < padded; first += most) {
        check_stop(monitor);
        const std::size_t lanes = std::min(most, padded - first) / per_lane;
        const Batch batch = batch_of(planned, first, lanes);
        found.resize(lanes * sets * per_lane);
        kernel.sum(batch.points, batch.tops, found, [&](double part) {
          monitor.progress("potential",
                           std::min(1.0, (double(first) + part * double(lanes * per_lane)) / double(padded)));
          return !monitor.stopped();
        });
        for (std::size_t lane = 0; lane < lanes; ++lane)
          for (std::size_t set = 0; set < sets; ++set)
            std::copy_n(&found[(lane * sets + set) * per_lane], per_lane,
                        &sums[set * padded + first + lane * per_lane]);
      }
    }
    PotentialField field = plan::potential_field(problem_, planned, sums);
    if (report) {
      *report = {};
      report->setup_seconds = setup;
      report->seconds = seconds_since(start);
      report->elements = elements;
      report->full_elements = plan::PotentialPoints::entries(series.top) * double(planned.order.size());
      for (const auto& k : gpu_->take_profile()) report->kernels.push_back({k.kernel, k.dispatches, k.seconds});
    }
    return field;
  }

  std::shared_ptr<engine::Gpu> gpu_;
  std::uint32_t iteration_budget_;
  PotentialProblem problem_;
};

} // namespace

std::unique_ptr<ExteriorPotential> exterior_potential(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget,
                                                      const PotentialProblem& problem) {
  return std::make_unique<GpuPotential>(std::move(gpu), iteration_budget, problem);
}

} // namespace cowgpu::gpu

#include "host/gpu/moments.hpp"

#include "host/clock.hpp"
#include "host/gpu/errors.hpp"
#include "host/plan/moments.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace cowgpu::gpu {
namespace {

class GpuMoments final : public PreparedMoments {
public:
  GpuMoments(std::shared_ptr<engine::Gpu> gpu, const engine::MomentsShape& shape, const MomentProblem& problem)
      : gpu_(std::move(gpu)), shape_(shape), problem_(problem) {}

  // On the host the plan, 128 bytes a pair and 48 a coefficient.
  MemoryNeed memory() const override {
    const std::uint64_t groups = problem_.faces.size() / shape_.lanes + 1; // every face alone in its pair at worst
    MemoryNeed need;
    need.host = plan::bytes(problem_) + groups * shape_.lanes * 128 + 48 * Multipoles::count(problem_.lmax);
    need.device = engine::moments_device_bytes(shape_, gpu_->facts(), problem_.lmax, groups);
    return need;
  }

  Multipoles run(Monitor& monitor, RunReport* report) const override {
    return watched(*gpu_, monitor, [&] { return found(monitor, report); });
  }

private:
  Multipoles found(Monitor& monitor, RunReport* report) const {
    const auto start = Clock::now();
    const plan::Moments plan = plan::moments(problem_, int(shape_.lanes));

    std::vector<std::uint32_t> order(plan.groups());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return plan.last_degree[a] > plan.last_degree[b]; });
    std::vector<std::uint32_t> last_degrees;
    last_degrees.reserve(order.size());
    for (const std::uint32_t g : order) last_degrees.push_back(std::uint32_t(plan.last_degree[g]));
    const std::vector<double> pairs = plan::lane_inputs(plan, order);
    const double setup = seconds_since(start);

    std::vector<double> sums(2 * Multipoles::count(problem_.lmax), 0.0);
    sums[0] = std::ldexp(plan.sum_of_dets, plan.start_exponent);
    gpu_->take_profile();
    engine::moments(gpu_->device(), shape_,
                    {problem_.lmax, plan.column_scale, plan.start_exponent, pairs, last_degrees}, sums,
                    [&](double done) {
                      monitor.progress("moments", done);
                      return !monitor.stopped();
                    });
    Multipoles result = plan::finish(problem_, plan, sums);
    if (report) {
      *report = plan::report(plan, setup, seconds_since(start));
      for (const auto& k : gpu_->take_profile()) report->kernels.push_back({k.kernel, k.dispatches, k.seconds});
    }
    return result;
  }

  std::shared_ptr<engine::Gpu> gpu_;
  engine::MomentsShape shape_;
  MomentProblem problem_;
};

} // namespace

engine::MomentsShape shape_from(const GpuOptions& options) {
  engine::MomentsShape shape;
  shape.levels = options.levels;
  shape.workgroups = options.workgroups;
  shape.rows_in_buffer = options.rows_in_buffer;
  shape.state_budget = options.state_budget;
  shape.iteration_budget = options.iteration_budget;
  return shape;
}

std::unique_ptr<PreparedMoments> moments(std::shared_ptr<engine::Gpu> gpu, const engine::MomentsShape& shape,
                                         const MomentProblem& problem) {
  return std::make_unique<GpuMoments>(std::move(gpu), shape, problem);
}

} // namespace cowgpu::gpu

#include "host/gpu/moments.hpp"

#include "host/clock.hpp"
#include "host/plan/moments.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cowgpu::gpu {
engine::MomentsShape shape_from(const GpuOptions& options) {
  engine::MomentsShape shape;
  shape.levels = options.levels;
  shape.workgroups = options.workgroups;
  shape.rows_in_buffer = options.rows_in_buffer;
  shape.state_budget = options.state_budget;
  shape.iteration_budget = options.iteration_budget;
  return shape;
}

Multipoles moments(engine::Gpu& gpu, const engine::MomentsShape& shape, const MomentProblem& problem, Monitor& monitor,
                   RunReport* report) {
  const auto start = Clock::now();
  const plan::Moments plan = plan::moments(problem, int(shape.lanes));

  std::vector<std::uint32_t> order(plan.groups());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return plan.last_degree[a] > plan.last_degree[b]; });
  std::vector<std::uint32_t> last_degrees;
  last_degrees.reserve(order.size());
  for (const std::uint32_t g : order) last_degrees.push_back(std::uint32_t(plan.last_degree[g]));
  const std::vector<double> pairs = plan::lane_inputs(plan, order);
  const double setup = seconds_since(start);

  std::vector<double> sums(2 * Multipoles::count(problem.lmax), 0.0);
  sums[0] = std::ldexp(plan.sum_of_dets, plan.start_exponent);
  gpu.take_profile();
  engine::moments(gpu.device(), shape, {problem.lmax, plan.column_scale, plan.start_exponent, pairs, last_degrees},
                  sums, [&](double done) {
                    monitor.progress("moments", done);
                    return !monitor.stopped();
                  });
  Multipoles result = plan::finish(problem, plan, sums);
  if (report) {
    *report = plan::report(plan, setup, seconds_since(start));
    for (const auto& k : gpu.take_profile()) report->kernels.push_back({k.kernel, k.dispatches, k.seconds});
  }
  return result;
}

MemoryNeed moments_memory(const engine::GpuFacts& facts, const engine::MomentsShape& shape,
                          const MomentProblem& problem) {
  const std::uint64_t groups = problem.faces.size() / shape.lanes + 1; // every face alone in its pair at worst
  MemoryNeed need;
  need.host = plan::bytes(problem) + groups * shape.lanes * 128 + 48 * Multipoles::count(problem.lmax);
  need.device = engine::moments_device_bytes(shape, facts, problem.lmax, groups);
  return need;
}

} // namespace cowgpu::gpu

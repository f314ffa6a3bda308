#include "host/cpu/moments.hpp"

#include "host/cpu/moments_kernel.hpp"
#include "host/flush_denormals.hpp"
#include "host/parallel.hpp"
#include "host/plan/moments.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <new>
#include <numeric>

namespace cowgpu::cpu {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

using Partial = hwy::AlignedFreeUniquePtr<double[]>;

// How many partial sums share the groups. It depends on the problem alone, never on the threads, so that the order of
// every addition, and with it every bit, is the same on any number of cores.
std::size_t partials(const PartialLayout& layout) {
  constexpr std::size_t budget = std::size_t(16) << 20; // bytes that stay within a large cache
  return std::clamp<std::size_t>(budget / (8 * layout.size() + 1), 8, 64);
}

// Deals the groups out, the longest first, to the partial sum with the least work so far.
std::vector<std::vector<std::uint32_t>> deal(const plan::Moments& plan, std::size_t hands) {
  std::vector<std::uint32_t> order(plan.groups());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return plan.last_degree[a] > plan.last_degree[b]; });
  std::vector<std::vector<std::uint32_t>> hand(std::max<std::size_t>(1, std::min(hands, plan.groups())));
  std::vector<double> work(hand.size(), 0.0);
  for (const std::uint32_t group : order) {
    const auto least = std::size_t(std::min_element(work.begin(), work.end()) - work.begin());
    hand[least].push_back(group);
    work[least] += (plan.last_degree[group] + 8.0) * (plan.last_degree[group] + 16.0);
  }
  return hand;
}

// From the partial sums' columns to rows sorted by l, then m.
std::vector<double> gather(const plan::Moments& plan, const PartialLayout& layout,
                           const std::vector<Partial>& partial, unsigned threads) {
  std::vector<double> sums(2 * Coefficients::count(plan.lmax), 0.0);
  sums[0] = std::ldexp(plan.sum_of_dets, plan.start_exponent);
  parallel_for(threads, layout.sweeps(), [&](std::size_t n, unsigned) {
    for (const auto& part : partial) {
      const double* column = part.get() + layout.offset[n];
      for (int j = 0; j < degrees_per_sweep; ++j) {
        const int l = 1 + int(n) * degrees_per_sweep + j;
        if (l > plan.lmax) break;
        double* row = &sums[2 * Coefficients::index(l, 0)];
        for (int m = 0; m <= l; ++m) {
          const double* from = column + 2 * degrees_per_sweep * (m + j + degrees_per_sweep) + 2 * j;
          row[2 * m] += from[0];
          row[2 * m + 1] += from[1];
        }
      }
    }
  });
  return sums;
}

} // namespace

Coefficients moments(const MomentProblem& problem, unsigned threads, Monitor& monitor, RunReport* report) {
  const auto start = Clock::now();
  if (threads == 0) threads = all_threads();
  const plan::Moments plan = plan::moments(problem, moments_lanes());
  const double setup = seconds_since(start);

  const PartialLayout layout(plan.lmax);
  const auto hand = deal(plan, partials(layout));
  std::vector<Partial> partial(hand.size());
  std::vector<MomentsWorkspace> workspaces;
  for (unsigned t = 0; t < threads; ++t) workspaces.emplace_back(plan.lmax);
  std::atomic<double> done{0};
  std::mutex progress_mutex;
  parallel_for(threads, hand.size(), [&](std::size_t task, unsigned thread) {
    const FlushDenormals flush;
    partial[task] = hwy::AllocateAligned<double>(std::max<std::size_t>(layout.size(), 1)); // lmax 0 has none
    if (!partial[task]) throw std::bad_alloc();
    std::fill_n(partial[task].get(), layout.size(), 0.0);
    for (const std::uint32_t group : hand[task]) {
      check_stop(monitor);
      accumulate_group(plan, group, layout, workspaces[thread], partial[task].get());
      const double l = plan.last_degree[group];
      done = done + 0.5 * plan.lanes * (l + 1) * (l + 2);
      if (const std::unique_lock lock(progress_mutex, std::try_to_lock); lock)
        monitor.progress("moments", plan.elements > 0 ? std::min(1.0, done / plan.elements) : 1.0);
    }
  });
  Coefficients result = plan::finish(problem, plan, gather(plan, layout, partial, threads));
  if (report) {
    report->seconds = seconds_since(start);
    report->setup_seconds = setup;
    report->elements = plan.elements;
    report->full_elements = plan.full_elements;
    report->pairs = plan.pair_count;
    report->kernels.clear();
  }
  return result;
}

std::uint64_t moments_bytes(const MomentProblem& problem, unsigned threads) {
  const PartialLayout layout(problem.lmax);
  const std::uint64_t sums = 16 * Coefficients::count(problem.lmax);
  const std::uint64_t rows = std::uint64_t(threads) * 640 * (std::uint64_t(problem.lmax) + 48);
  return plan::bytes(problem) + partials(layout) * layout.size() * 8 + sums + rows;
}

} // namespace cowgpu::cpu

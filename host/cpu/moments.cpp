#include "host/cpu/moments.hpp"

#include "host/clock.hpp"
#include "host/cpu/moments_kernel.hpp"
#include "host/flush_denormals.hpp"
#include "host/parallel.hpp"
#include "host/plan/moments.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <new>
#include <numeric>

namespace cowgpu::cpu {
namespace {

using Partial = hwy::AlignedFreeUniquePtr<double[]>;

// How many partial sums share the groups. It depends on the problem alone, never on the threads, so that the order of
// every addition, and with it every bit, is the same on any number of cores.
std::size_t partials(const PartialLayout& layout) {
  constexpr std::size_t budget = std::size_t(16) << 20; // bytes that stay within a large cache
  return std::clamp<std::size_t>(budget / (8 * layout.size() + 1), 8, 64);
}

// How many of the partial sums exist at once: all of them while they are small, else one a thread.
std::size_t round_size(const PartialLayout& layout, unsigned threads, std::size_t hands) {
  constexpr std::size_t budget = std::size_t(64) << 20;
  return std::min(hands, std::max<std::size_t>(threads, budget / (8 * layout.size() + 1)));
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

// Adds partial sums, in their order, to rows sorted by l, then m, and clears them for the next ones.
void gather(const plan::Moments& plan, const PartialLayout& layout, std::span<const Partial> partial, unsigned threads,
            std::vector<double>& sums) {
  parallel_for(threads, layout.sweeps(), [&](std::size_t n, unsigned) {
    for (const auto& part : partial) {
      double* column = part.get() + layout.offset[n];
      for (int j = 0; j < degrees_per_sweep; ++j) {
        const int l = 1 + int(n) * degrees_per_sweep + j;
        if (l > plan.lmax) break;
        double* row = &sums[2 * Multipoles::by_degree(l, 0)];
        for (int m = 0; m <= l; ++m) {
          const double* from = column + std::ptrdiff_t{2} * (degrees_per_sweep * (m + j + degrees_per_sweep) + j);
          *row++ += from[0];
          *row++ += from[1];
        }
      }
      std::fill(column, part.get() + layout.offset[n + 1], 0.0);
    }
  });
}

} // namespace

Multipoles moments(const MomentProblem& problem, unsigned threads, Monitor& monitor, RunReport* report) {
  const auto start = Clock::now();
  if (threads == 0) threads = all_threads();
  const plan::Moments plan = plan::moments(problem, moments_lanes());
  const double setup = seconds_since(start);

  const PartialLayout layout(plan.lmax);
  const auto hand = deal(plan, partials(layout));
  // Where partial sums are large, hands are played in rounds, one to a thread, so that few of them exist at once.
  const std::size_t seats = round_size(layout, threads, hand.size());
  std::vector<Partial> partial;
  for (std::size_t seat = 0; seat < seats; ++seat) {
    partial.push_back(hwy::AllocateAligned<double>(std::max<std::size_t>(layout.size(), 1))); // lmax 0 has none
    if (!partial.back()) throw std::bad_alloc();
  }
  std::vector<MomentsWorkspace> workspaces;
  for (unsigned t = 0; t < threads; ++t) workspaces.emplace_back(plan.lmax);
  std::vector<double> sums(2 * Multipoles::count(plan.lmax), 0.0);
  sums[0] = std::ldexp(plan.sum_of_dets, plan.start_exponent);
  double done = 0;
  std::mutex done_mutex;
  for (std::size_t first = 0; first < hand.size(); first += seats) {
    const std::size_t round = std::min(seats, hand.size() - first);
    parallel_for(threads, round, [&](std::size_t seat, unsigned thread) {
      const FlushDenormals flush;
      if (first == 0) std::fill_n(partial[seat].get(), layout.size(), 0.0);
      double work = 0;
      for (const std::uint32_t group : hand[first + seat]) {
        check_stop(monitor);
        accumulate_group(plan, group, layout, workspaces[thread], partial[seat].get());
        const double l = plan.last_degree[group];
        work += 0.5 * plan.lanes * (l + 1) * (l + 2);
        if (work < plan.elements / 4096) continue;
        const std::lock_guard lock(done_mutex);
        done += work;
        work = 0;
        monitor.progress("moments", std::min(1.0, done / plan.elements));
      }
      const std::lock_guard lock(done_mutex);
      done += work;
    });
    gather(plan, layout, {partial.data(), round}, threads, sums);
  }
  Multipoles result = plan::finish(problem, plan, sums);
  if (report) *report = plan::report(plan, setup, seconds_since(start));
  return result;
}

std::uint64_t moments_bytes(const MomentProblem& problem, unsigned threads) {
  const PartialLayout layout(problem.lmax);
  return plan::bytes(problem) + round_size(layout, threads, partials(layout)) * 8 * layout.size() +
         640 * std::uint64_t(threads) * (std::uint64_t(problem.lmax) + 48) + 32 * Multipoles::count(problem.lmax);
}

} // namespace cowgpu::cpu

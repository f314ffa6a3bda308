#include "host/cpu/potential.hpp"

#include "host/clock.hpp"
#include "host/flush_denormals.hpp"
#include "host/parallel.hpp"

#include <algorithm>
#include <atomic>

namespace cowgpu::cpu {

PotentialField potential(const PotentialProblem& problem, unsigned threads, Monitor& monitor, RunReport* report) {
  const auto start = Clock::now();
  const plan::PotentialSeries series = plan::potential_series(problem);
  const plan::PotentialPoints points = plan::potential_points(problem, series);
  const double setup = seconds_since(start);

  constexpr std::size_t block = plan::PotentialPoints::block;
  double work = 0, full = plan::PotentialPoints::entries(series.top) * double(points.order.size());
  for (const int top : points.tops) work += plan::PotentialPoints::entries(top);
  std::vector<double> sums(series.sets * points.padded());
  std::atomic<double> done = 0;
  // The blocks nearest to the body take longest, and come first.
  parallel_for(threads, points.blocks(), [&](std::size_t task, unsigned thread) {
    const FlushDenormals flush;
    const std::size_t b = points.blocks() - 1 - task;
    for (std::size_t first = b * block; first < (b + 1) * block; first += potential_group) {
      check_stop(monitor);
      sum_potential(series, points, first, points.tops[b], sums.data());
    }
    const double entries = plan::PotentialPoints::entries(points.tops[b]);
    const double before = done.fetch_add(entries);
    if (thread == 0) monitor.progress("potential", std::min(1.0, (before + entries) / work));
  });
  PotentialField field = plan::potential_field(problem, points, sums);
  if (report) {
    *report = {};
    report->setup_seconds = setup;
    report->seconds = seconds_since(start);
    report->elements = work * double(block);
    report->full_elements = full;
  }
  return field;
}

std::uint64_t potential_bytes(std::uint64_t points, int lmax, Derivatives derivatives) {
  return plan::potential_bytes(points, lmax, derivatives);
}

} // namespace cowgpu::cpu

#include "host/cpu/potential.hpp"

#include "host/clock.hpp"
#include "host/flush_denormals.hpp"
#include "host/parallel.hpp"

#include <algorithm>
#include <atomic>

namespace cowgpu::cpu {

namespace {

class CpuPotential final : public ExteriorPotential {
public:
  CpuPotential(const PotentialProblem& problem, unsigned threads) : problem_(problem), threads_(threads) {}

  MemoryNeed memory(std::uint64_t points) const override {
    return {plan::potential_bytes(points, problem_.lmax, problem_.derivatives), 0};
  }

  PotentialField at(std::span<const Vec3> points, Monitor& monitor, RunReport* report) const override {
    const auto start = Clock::now();
    const plan::PotentialSeries series = plan::potential_series(problem_);
    const plan::PotentialPoints planned = plan::potential_points(problem_, series, points);
    const double setup = seconds_since(start);

    constexpr std::size_t block = plan::PotentialPoints::block;
    double work = 0, full = plan::PotentialPoints::entries(series.top) * double(planned.order.size());
    for (const int top : planned.tops) work += plan::PotentialPoints::entries(top);
    std::vector<double> sums(series.sets * planned.padded());
    std::atomic<double> done = 0;
    // The blocks nearest to the body take longest, and come first.
    parallel_for(threads_, planned.blocks(), [&](std::size_t task, unsigned thread) {
      const FlushDenormals flush;
      const std::size_t b = planned.blocks() - 1 - task;
      for (std::size_t first = b * block; first < (b + 1) * block; first += potential_group) {
        check_stop(monitor);
        sum_potential(series, planned, first, planned.tops[b], sums.data());
      }
      const double entries = plan::PotentialPoints::entries(planned.tops[b]);
      const double before = done.fetch_add(entries);
      if (thread == 0) monitor.progress("potential", std::min(1.0, (before + entries) / work));
    });
    PotentialField field = plan::potential_field(problem_, planned, sums);
    if (report) {
      *report = {};
      report->setup_seconds = setup;
      report->seconds = seconds_since(start);
      report->elements = work * double(block);
      report->full_elements = full;
    }
    return field;
  }

private:
  PotentialProblem problem_;
  unsigned threads_;
};

} // namespace

std::unique_ptr<ExteriorPotential> exterior_potential(const PotentialProblem& problem, unsigned threads) {
  return std::make_unique<CpuPotential>(problem, threads);
}

} // namespace cowgpu::cpu

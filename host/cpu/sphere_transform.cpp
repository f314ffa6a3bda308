#include "host/cpu/sphere_transform.hpp"

#include "host/clock.hpp"
#include "host/cpu/legendre.hpp"
#include "host/cpu/ring_fourier.hpp"
#include "host/parallel.hpp"
#include "host/plan/legendre.hpp"
#include "host/thread_pool.hpp"

#include <hwy/aligned_allocator.h>
#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <new>
#include <vector>

namespace cowgpu::cpu {
namespace {

constexpr int seed_segment = 8, seed_orders = 1;

// Fields of one call are transformed in groups, each of which runs the recurrence once.
struct FieldGroup {
  int first, count;
};
std::vector<FieldGroup> groups_of(int fields) {
  std::vector<FieldGroup> groups;
  for (int first = 0; first < fields; first += most_fields_together)
    groups.push_back({first, std::min(most_fields_together, fields - first)});
  return groups;
}

// Asks for large pages, because the stages walk through the memory between them in steps longer than a small one.
void prefer_large_pages(double* begin, std::size_t doubles) {
  constexpr std::uintptr_t page = 4096;
  const std::uintptr_t first = (reinterpret_cast<std::uintptr_t>(begin) + page - 1) / page * page;
  const std::uintptr_t last = reinterpret_cast<std::uintptr_t>(begin + doubles) / page * page;
  if (last > first) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
}

class Transform final : public SphereTransform {
public:
  Transform(const SphereGrid& from, int degree, unsigned threads)
      : SphereTransform(from, degree), threads_(threads ? threads : all_threads()) {}

  MemoryNeed memory(int fields) const override {
    const std::size_t orders = std::size_t(lmax()) + 1, rings = std::size_t(grid().rings);
    const std::size_t length = std::size_t(grid().ring_length);
    plan::Legendre shape; // as far as sizes depend on it
    shape.lmax = lmax();
    shape.blocks = (grid().rings / 2 + 1 + plan::block_pairs - 1) / plan::block_pairs;
    const std::size_t pairs = std::size_t(shape.blocks) * plan::block_pairs;
    std::size_t steps = 0;
    for (int m = 0; m <= lmax(); ++m) steps += std::size_t(shape.padded_steps(m));

    const std::size_t of_grid = rings * (2 * sizeof(long double) + 2 * sizeof(double));
    const std::size_t of_plan = pairs * (2 * sizeof(int) + 3 * sizeof(double) + sizeof(long double)) +
                                (4 * steps + 2 * steps + 2 * orders) * sizeof(double) + 2 * (orders + 1) * 8;
    const std::size_t of_seeds = orders * pairs * 2 * sizeof(double) + orders * std::size_t(shape.blocks) * 4;
    const std::size_t of_planning = threads_ * pairs * 2 * sizeof(long double);
    const std::size_t of_fourier = length * 3 * 2 * sizeof(double);
    const std::size_t a_thread = LegendreWork::bytes(shape) + RingWork::most_bytes(grid().ring_length);
    const std::size_t between = SpectrumLayout(shape, std::min(fields, most_fields_together)).size() * sizeof(double);
    constexpr std::size_t others = std::size_t(2) << 20; // a large page, small objects, alignment
    const std::size_t turned = grid().shift == 0 ? 0 : 16 * std::size_t(fields) * SphereCoefficients::count(lmax());
    return {of_grid + of_plan + of_seeds + of_planning + of_fourier + threads_ * a_thread + between + turned + others,
            0};
  }

  void prepare() override {
    if (!tables_) tables_ = std::make_unique<Tables>(grid(), lmax(), threads_);
  }

private:
  struct Tables {
    Tables(const SphereGrid& grid, int lmax, unsigned threads)
        : legendre(plan::legendre(grid, lmax, threads)),
          seeds(plan::seeds(legendre, seed_orders, seed_segment, threads)), fourier(grid.ring_length), pool(threads),
          steps(plan::active_steps(legendre, seeds)) {
      for (unsigned t = 0; t < pool.threads(); ++t) {
        legendre_work.emplace_back(legendre);
        ring_work.emplace_back(fourier);
      }
    }

    plan::Legendre legendre;
    plan::Seeds seeds;
    RingFourier fourier;
    ThreadPool pool;
    double steps;
    std::vector<LegendreWork> legendre_work;
    std::vector<RingWork> ring_work;
  };

  void to_grid(int fields, std::span<const std::complex<double>> coefficients, std::span<double> values,
               RingFactor factor, Monitor& monitor, TransformReport& report) override {
    const std::size_t count = SphereCoefficients::count(lmax()), points = grid().points();
    Progress progress(fields, monitor);
    for (const FieldGroup& group : groups_of(fields)) {
      const SpectrumLayout layout = provide(group.count);
      const auto first = std::size_t(group.first);
      auto start = Clock::now();
      tables_->pool.run(std::size_t(layout.orders), [&](std::size_t m, unsigned thread) {
        progress.task(thread, group, 0, m, std::size_t(layout.orders));
        const std::size_t at = first * count + SphereCoefficients::index(lmax(), int(m), int(m));
        legendre_synthesis(tables_->legendre, tables_->seeds, int(m), group.count, &coefficients[at], count,
                           tables_->legendre_work[thread], &spectrum_[m * layout.row]);
      });
      report.legendre_seconds += seconds_since(start);
      start = Clock::now();
      const std::size_t tasks = std::size_t(layout.blocks) * std::size_t(group.count);
      tables_->pool.run(tasks, [&](std::size_t task, unsigned thread) {
        progress.task(thread, group, 1, task, tasks);
        const int block = int(task) / group.count, field = int(task) % group.count;
        double* map = values.data() + (first + std::size_t(field)) * points;
        RingTargets rings;
        for (std::size_t i = 0; i < plan::block_pairs; ++i) {
          const std::size_t pair = std::size_t(block) * plan::block_pairs + i;
          rings.north[i] = ring(map, tables_->legendre.north[pair]);
          rings.south[i] = ring(map, tables_->legendre.south[pair]);
          rings.weight[i] = factor == RingFactor::weight ? tables_->legendre.weight[pair] : 1;
        }
        orders_to_rings(tables_->fourier, rings, lmax(), &spectrum_[layout.at(0, field, block)], layout.row,
                        tables_->ring_work[thread]);
      });
      report.fourier_seconds += seconds_since(start);
    }
    progress.finish();
    count_flops(fields, report);
  }

  void from_grid(int fields, std::span<const double> values, std::span<std::complex<double>> coefficients,
                 RingFactor factor, Monitor& monitor, TransformReport& report) override {
    const std::size_t count = SphereCoefficients::count(lmax()), points = grid().points();
    Progress progress(fields, monitor);
    for (const FieldGroup& group : groups_of(fields)) {
      const SpectrumLayout layout = provide(group.count);
      const auto first = std::size_t(group.first);
      auto start = Clock::now();
      const std::size_t tasks = std::size_t(layout.blocks) * std::size_t(group.count);
      tables_->pool.run(tasks, [&](std::size_t task, unsigned thread) {
        progress.task(thread, group, 0, task, tasks);
        const int block = int(task) / group.count, field = int(task) % group.count;
        const double* map = values.data() + (first + std::size_t(field)) * points;
        RingBlock rings;
        for (std::size_t i = 0; i < plan::block_pairs; ++i) {
          const std::size_t pair = std::size_t(block) * plan::block_pairs + i;
          rings.north[i] = ring(map, tables_->legendre.north[pair]);
          rings.south[i] = ring(map, tables_->legendre.south[pair]);
          rings.weight[i] = factor == RingFactor::weight ? tables_->legendre.weight[pair] : 1;
          rings.x[i] = tables_->legendre.x[pair];
        }
        rings_to_orders(tables_->fourier, rings, lmax(), &spectrum_[layout.at(0, field, block)], layout.row,
                        tables_->ring_work[thread]);
      });
      report.fourier_seconds += seconds_since(start);
      start = Clock::now();
      tables_->pool.run(std::size_t(layout.orders), [&](std::size_t m, unsigned thread) {
        progress.task(thread, group, 1, m, std::size_t(layout.orders));
        const std::size_t at = first * count + SphereCoefficients::index(lmax(), int(m), int(m));
        legendre_analysis(tables_->legendre, tables_->seeds, int(m), group.count, &spectrum_[m * layout.row],
                          tables_->legendre_work[thread], &coefficients[at], count);
      });
      report.legendre_seconds += seconds_since(start);
    }
    progress.finish();
    count_flops(fields, report);
  }

  // Says how far the two stages of all groups are, from the caller's thread, and asks on every thread whether to stop.
  class Progress {
  public:
    Progress(int fields, Monitor& monitor) : fields_(fields), monitor_(monitor) {}
    void task(unsigned thread, const FieldGroup& group, int stage, std::size_t task, std::size_t tasks) {
      check_stop(monitor_);
      if (thread != 0) return;
      const double part = (stage + double(task) / double(tasks)) / 2;
      const double fraction = (group.first + part * group.count) / fields_;
      if (fraction < said_ + 1.0 / 256) return;
      said_ = fraction;
      monitor_.progress("transform", fraction);
    }
    void finish() { monitor_.progress("transform", 1); }

  private:
    int fields_;
    Monitor& monitor_;
    double said_ = 0; // by the caller's thread alone
  };

  template <class Value>
  Value* ring(Value* map, int index) const {
    return index < 0 ? nullptr : map + std::size_t(index) * std::size_t(grid().ring_length);
  }

  // Room between the stages for so many fields; kept for the calls to come.
  SpectrumLayout provide(int fields) {
    const SpectrumLayout layout(tables_->legendre, fields);
    if (layout.size() > spectrum_size_) {
      spectrum_.reset();
      spectrum_size_ = 0;
      spectrum_ = hwy::AllocateAligned<double>(layout.size());
      if (!spectrum_) throw std::bad_alloc();
      spectrum_size_ = layout.size();
      prefer_large_pages(spectrum_.get(), spectrum_size_);
    }
    return layout;
  }

  void count_flops(int fields, TransformReport& report) const {
    for (const FieldGroup& group : groups_of(fields))
      report.legendre_flops += tables_->steps * 2 * (2 + 4 * group.count);
    const double n = grid().ring_length;
    report.fourier_flops += 5 * n * std::log2(n) * tables_->legendre.pairs * fields;
  }

  unsigned threads_;
  std::unique_ptr<Tables> tables_;
  hwy::AlignedFreeUniquePtr<double[]> spectrum_;
  std::size_t spectrum_size_ = 0;
};

} // namespace

std::unique_ptr<SphereTransform> sphere_transform(const SphereGrid& grid, int lmax, unsigned threads) {
  return std::make_unique<Transform>(grid, lmax, threads);
}

} // namespace cowgpu::cpu

#include "host/gpu/sphere_transform.hpp"

#include "host/gpu/errors.hpp"
#include "host/parallel.hpp"
#include "host/plan/legendre.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cowgpu::gpu {
namespace {

constexpr std::size_t rings_a_task = 64;

class GpuTransform final : public SphereTransform {
public:
  GpuTransform(std::shared_ptr<engine::Gpu> gpu, const engine::SphereTransformShape& shape, const SphereGrid& grid,
               int lmax)
      : SphereTransform(grid, lmax), gpu_(std::move(gpu)), shape_(shape) {}

  // On the host the plan with its start values, which are given up once they are on the device.
  MemoryNeed memory(int fields) const override {
    const std::uint64_t pairs =
        std::uint64_t(grid().rings / 2 + 1 + plan::block_pairs - 1) / plan::block_pairs * plan::block_pairs;
    const std::uint64_t orders = std::uint64_t(lmax()) + 1;
    const std::uint64_t steps = orders * (orders / 4 + plan::step_multiple + 1); // steps of all orders, with padding
    MemoryNeed need;
    if (grid().shift != 0) need.host += 16 * std::uint64_t(fields) * SphereCoefficients::count(lmax());
    need.host += 48 * steps + 48 * orders + 64 * pairs + orders * pairs * 17 + (std::uint64_t(1) << 20);
    need.device =
        engine::sphere_transform_device_bytes(shape_, gpu_->facts(), lmax(), int(pairs), grid().ring_length, fields);
    return need;
  }

  void prepare() override {
    if (!engine_) translated([&] { make_tables(); });
  }

private:
  void make_tables() {
    plan_ = plan::legendre(grid(), lmax());
    const plan::Seeds seeds = plan::seeds(plan_, int(shape_.legendre.lanes), int(shape_.legendre.steps));
    steps_ = plan::active_steps(plan_, seeds);
    engine::LegendreInput legendre;
    legendre.lmax = lmax();
    legendre.polar_pairs = plan_.polar_blocks * plan::block_pairs;
    legendre.t = plan_.t;
    legendre.offset = plan_.offset;
    legendre.a = plan_.a;
    legendre.b = plan_.b;
    legendre.b_polar = plan_.b_polar;
    legendre.start = seeds.start;
    legendre.seeds = seeds.values;
    engine_ = std::make_unique<engine::SphereTransform>(
        gpu_->device(), shape_, legendre,
        engine::RingFourierInput{grid().ring_length, lmax() + 1, plan_.x, plan_.weight});
    for (std::vector<double>* uploaded : {&plan_.a, &plan_.b, &plan_.b_polar}) *uploaded = {};
  }

  void to_grid(int fields, std::span<const std::complex<double>> coefficients, std::span<double> values,
               RingFactor factor, Monitor& monitor, TransformReport& report) override {
    const std::size_t points = grid().points();
    in_groups(fields, "synthesis", monitor, report, [&](std::size_t first, std::uint32_t n, const engine::Hook& hook) {
      engine_->to_values(
          n, factor == RingFactor::weight,
          [&](std::span<double> series) { fill_series(coefficients, first, n, series); },
          [&](engine::RingSlab slab, std::span<const double> rings) {
            const auto copy = [&](int ring, std::size_t f, const double* from) {
              double* to = &values[(first + f) * points + std::size_t(ring) * ring_length()];
              std::copy(from, from + ring_length(), to);
            };
            for_rings(slab, n, rings, copy);
          },
          hook);
    });
  }

  void from_grid(int fields, std::span<const double> values, std::span<std::complex<double>> coefficients,
                 RingFactor factor, Monitor& monitor, TransformReport& report) override {
    const std::size_t points = grid().points();
    in_groups(fields, "analysis", monitor, report, [&](std::size_t first, std::uint32_t n, const engine::Hook& hook) {
      engine_->to_series(
          n, factor == RingFactor::weight,
          [&](engine::RingSlab slab, std::span<double> rings) {
            const auto copy = [&](int ring, std::size_t f, double* to) {
              if (ring < 0) {
                std::fill(to, to + ring_length(), 0.0);
                return;
              }
              const double* from = &values[(first + f) * points + std::size_t(ring) * ring_length()];
              std::copy(from, from + ring_length(), to);
            };
            for_rings(slab, n, rings, copy);
          },
          [&](std::span<const double> series) { read_series(series, first, n, coefficients); }, hook);
    });
  }

  std::size_t ring_length() const { return std::size_t(grid().ring_length); }

  /// Calls work(first, n, hook) for groups of fields that go together, and fills the report.
  template <class GroupWork>
  void in_groups(int fields, const char* what, Monitor& monitor, TransformReport& report, const GroupWork& work) {
    const engine::StopScope stop(*gpu_, [&monitor] { return monitor.stopped(); });
    gpu_->take_profile();
    std::uint32_t done = 0;
    const auto all = std::uint32_t(fields);
    while (done < all) {
      const std::uint32_t n = engine_->together(all - done);
      translated([&] {
        work(std::size_t(done), n, [&](double fraction) {
          monitor.progress(what, (double(done) + double(n) * fraction) / double(all));
          return !monitor.stopped();
        });
      });
      done += n;
      report.legendre_flops += steps_ * (4 + 8 * double(n));
    }
    report.fourier_flops = 5 * double(ring_length()) * std::log2(double(ring_length())) * plan_.pairs * fields;
    for (const auto& k : gpu_->take_profile()) {
      report.kernels.push_back({k.kernel, k.dispatches, k.seconds});
      (k.kernel.starts_with("legendre") ? report.legendre_seconds : report.fourier_seconds) += k.seconds;
    }
  }

  /// Calls body(ring or -1, field, values) for both rings of the pairs of a slab.
  template <class Value, class Body>
  void for_rings(engine::RingSlab slab, std::size_t fields, std::span<Value> rings, const Body& body) const {
    const std::size_t rows = fields * 2 * slab.count;
    parallel_for(0, (rows + rings_a_task - 1) / rings_a_task, [&](std::size_t task, unsigned) {
      for (std::size_t row = task * rings_a_task; row < std::min(rows, (task + 1) * rings_a_task); ++row) {
        const std::size_t pair = slab.first + row % slab.count, side = row / slab.count % 2;
        const int ring = side == 0 ? plan_.north[pair] : plan_.south[pair];
        if constexpr (std::is_const_v<Value>)
          if (ring < 0) continue;
        body(ring, row / slab.count / 2, rings.data() + row * ring_length());
      }
    });
  }

  /// Calls body(m) for every order, neighbours on one thread.
  template <class Body>
  void for_orders(const Body& body) const {
    constexpr std::size_t orders_a_task = 16;
    parallel_for(0, std::size_t(lmax()) / orders_a_task + 1, [&](std::size_t task, unsigned) {
      for (int m = int(task * orders_a_task); m < std::min(lmax() + 1, int((task + 1) * orders_a_task)); ++m) body(m);
    });
  }

  std::size_t column(std::size_t field, int m) const {
    return field * SphereCoefficients::count(lmax()) + SphereCoefficients::index(lmax(), m, m);
  }

  void fill_series(std::span<const std::complex<double>> coefficients, std::size_t first, std::uint32_t n,
                   std::span<double> series) const {
    const std::size_t stride = engine_->series_stride(n);
    for_orders([&](int m) {
      for (std::uint32_t f = 0; f < n; ++f) {
        double* q = &series[engine_->series_index(m, f, n)];
        plan::prepare_synthesis(plan_, m, coefficients.subspan(column(first + f, m), std::size_t(lmax() - m) + 1), q,
                                stride);
        for (std::size_t k = std::size_t(plan_.padded_steps(m)); k < engine_->series_steps(m); ++k)
          std::fill_n(q + k * stride, 4, 0.0);
      }
    });
  }

  void read_series(std::span<const double> series, std::size_t first, std::uint32_t n,
                   std::span<std::complex<double>> coefficients) const {
    const std::size_t stride = engine_->series_stride(n);
    for_orders([&](int m) {
      for (std::uint32_t f = 0; f < n; ++f)
        plan::finish_analysis(plan_, m, &series[engine_->series_index(m, f, n)], stride,
                              coefficients.subspan(column(first + f, m), std::size_t(lmax() - m) + 1));
    });
  }

  std::shared_ptr<engine::Gpu> gpu_;
  engine::SphereTransformShape shape_;
  plan::Legendre plan_; // without what was uploaded
  double steps_ = 0;    // steps of the recurrence in one transform
  std::unique_ptr<engine::SphereTransform> engine_;
};

} // namespace

engine::SphereTransformShape transform_shape_from(const GpuOptions& options) {
  engine::SphereTransformShape shape;
  shape.legendre.steps = options.transform_steps;
  shape.legendre.analysis_rings.fill(options.transform_rings);
  shape.legendre.synthesis_rings.fill(options.transform_rings);
  shape.legendre.analysis_pairs = shape.legendre.synthesis_pairs = options.transform_pairs;
  shape.legendre.most_bytes = options.transform_binding;
  shape.legendre.iteration_budget = shape.fourier.iteration_budget = options.iteration_budget;
  shape.fourier.private_points = options.private_ring_points;
  return shape;
}

std::unique_ptr<SphereTransform> sphere_transform(std::shared_ptr<engine::Gpu> gpu,
                                                  const engine::SphereTransformShape& shape, const SphereGrid& grid,
                                                  int lmax) {
  return std::make_unique<GpuTransform>(std::move(gpu), shape, grid, lmax);
}

} // namespace cowgpu::gpu

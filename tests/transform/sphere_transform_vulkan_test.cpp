// The Vulkan path of the verbs `analyse` and `synthesise`: forced layouts, the budget of loop iterations, stops, reports.
// What both paths compute is held against the reference elsewhere.
#include "engine/device.hpp"
#include "engine/kernels/sphere_transform.hpp"
#include "host/error.hpp"
#include "host/plan/legendre.hpp"
#include "host/spectrum/roundtrip.hpp"
#include "host/sphere_transform.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/compare_transforms.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

/// What one transform gives in both directions for the same input.
struct Both {
  std::vector<double> values;
  std::vector<std::complex<double>> coefficients;
};

Both both(SphereTransform& transform, int fields) {
  Monitor monitor;
  const std::size_t points = std::size_t(fields) * transform.grid().points();
  const SphereCoefficients a = random_coefficients(transform.lmax(), fields, 1);
  Both result{std::vector<double>(points), std::vector<std::complex<double>>(a.values.size())};
  transform.synthesise(fields, a.values, result.values, monitor);
  transform.analyse(fields, random_values(points, 2), result.coefficients, monitor);
  return result;
}

Both both(Backend& backend, const SphereGrid& grid, int lmax, int fields) {
  return both(*backend.sphere_transform(grid, lmax), fields);
}

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

/// Largest difference over largest value.
template <class T>
double distance(const std::vector<T>& a, const std::vector<T>& b) {
  double most = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, std::abs(a[i] - b[i]));
    size = std::max(size, std::abs(b[i]));
  }
  return a.size() == b.size() ? most / size : 1;
}

/// Largest error of a round trip over the largest coefficient.
double round_trip(SphereTransform& transform, int fields) {
  Monitor monitor;
  const SphereCoefficients a = random_coefficients(transform.lmax(), fields, 1);
  SphereCoefficients back(a.lmax, fields);
  std::vector<double> values(std::size_t(fields) * transform.grid().points());
  transform.synthesise(fields, a.values, values, monitor);
  transform.analyse(fields, values, back.values, monitor);
  return distance(back.values, a.values);
}

GpuOptions with(void (*set)(GpuOptions&)) {
  GpuOptions options;
  set(options);
  return options;
}

class Listener : public Monitor {
public:
  explicit Listener(int stop_after = 1 << 30) : left_(stop_after) {}
  void progress(const char* what, double fraction) override {
    CHECK((std::string(what) == "synthesis" || std::string(what) == "analysis"));
    CHECK(fraction >= last);
    CHECK(fraction <= 1);
    last = fraction;
    --left_;
  }
  bool stopped() const override { return left_ <= 0; }
  double last = 0;

private:
  int left_;
};

} // namespace

namespace {

std::vector<GpuOptions> transform_layouts() {
  return {
      with([](GpuOptions& o) { o.transform_steps = 8; }),
      with([](GpuOptions& o) { o.transform_steps = 64, o.transform_rings = 2, o.transform_pairs = 2; }),
      with([](GpuOptions& o) { o.transform_rings = 8, o.transform_pairs = 24; }),
      with([](GpuOptions& o) { o.transform_rings = 4, o.transform_pairs = 4, o.transform_steps = 8; }),
      with([](GpuOptions& o) { o.transform_binding = 1 << 17; }),
      with([](GpuOptions& o) { o.transform_binding = 1 << 16, o.transform_pairs = 8, o.private_ring_points = 0; }),
      with([](GpuOptions& o) { o.private_ring_points = 0; }),
  };
}

void check_layouts(std::span<const GpuOptions> layouts, std::initializer_list<GridKind> grid_kinds,
                   std::initializer_list<int> field_counts) {
  const auto plain = gpu_backend();
  if (!plain) return skip_without_gpu();
  for (const GridKind kind : grid_kinds)
    for (const int fields : field_counts) {
      const SphereGrid grid = make_grid(kind, 100);
      const Both expected = both(*plain, grid, 97, fields);
      for (const GpuOptions& options : layouts) {
        const auto backend = gpu_backend(options);
        const Both found = both(*backend, grid, 97, fields);
        INFO("steps " << options.transform_steps << " rings " << options.transform_rings << " pairs "
                      << options.transform_pairs << " binding " << options.transform_binding << " ring points "
                      << options.private_ring_points << " fields " << fields);
        check_at_most(distance(found.values, expected.values), 4e-15, "synthesis");
        check_at_most(distance(found.coefficients, expected.coefficients), 4e-15, "analysis");
        CHECK(backend->validation_messages() == std::vector<std::string>{});
      }
    }
  CHECK(plain->validation_messages() == std::vector<std::string>{});
}

} // namespace

TEST_CASE("layouts of a transform that differ in everything give the same result", "[transform][vulkan]") {
  const auto layouts = transform_layouts();
  check_layouts(std::array{layouts[1], layouts[5]}, {GridKind::driscoll_healy}, {5});
}

TEST_CASE("every layout of a transform gives the same result", "[transform][vulkan][long]") {
  check_layouts(transform_layouts(), {GridKind::gauss_legendre, GridKind::driscoll_healy, GridKind::fejer}, {1, 5});
}

TEST_CASE("a synthesis keeps its bits however the rings are cut", "[transform][vulkan]") {
  const auto plain = gpu_backend();
  if (!plain) return skip_without_gpu();
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, 75);
  const Both expected = both(*plain, grid, 75, 2);
  for (const std::uint32_t pairs : {8U, 16U, 40U})
    for (const std::uint64_t binding : {std::uint64_t(0), std::uint64_t(1) << 16}) {
      GpuOptions options;
      options.transform_pairs = pairs;
      options.transform_binding = binding;
      const auto backend = gpu_backend(options);
      INFO("pairs " << pairs << " binding " << binding);
      CHECK(same(both(*backend, grid, 75, 2).values, expected.values));
    }
}

TEST_CASE("a transform gives the same bits again, whatever ran between", "[transform][vulkan]") {
  const auto backend = gpu_backend();
  if (!backend) return skip_without_gpu();
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 63), other_grid = make_grid(GridKind::driscoll_healy, 20);
  const auto transform = backend->sphere_transform(grid, 63), other = backend->sphere_transform(other_grid, 20);
  const Both one = both(*transform, 1), four = both(*transform, 4), third = both(*other, 3);
  for (int run = 0; run < 3; ++run) {
    const Both again_four = both(*transform, 4), again_third = both(*other, 3), again_one = both(*transform, 1);
    CHECK(same(again_one.values, one.values));
    CHECK(same(again_one.coefficients, one.coefficients));
    CHECK(same(again_four.values, four.values));
    CHECK(same(again_four.coefficients, four.coefficients));
    CHECK(same(again_third.values, third.values));
    CHECK(same(again_third.coefficients, third.coefficients));
  }
  const auto fresh = gpu_backend();
  CHECK(same(both(*fresh, grid, 63, 4).coefficients, four.coefficients));
  CHECK(backend->validation_messages() == std::vector<std::string>{});
}

namespace {

void check_ring_lengths(std::initializer_list<int> lengths) {
  const auto backend = gpu_backend();
  if (!backend) return skip_without_gpu();
  for (const int length : lengths) {
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, 21, length);
    const auto transform = backend->sphere_transform(grid, 20);
    INFO("ring length " << length);
    check_at_most(round_trip(*transform, 2), 2e-14, "round trip");
  }
  CHECK(backend->validation_messages() == std::vector<std::string>{});
}

} // namespace

TEST_CASE("rings of a prime, a square and a long length are transformed", "[transform][vulkan]") {
  check_ring_lengths({43, 121, 4096});
}

// Primes, squares and products of them, odd and even, beside the lengths that have butterflies of their own.
TEST_CASE("rings of any length are transformed", "[transform][vulkan][long]") {
  check_ring_lengths(
      {41, 43, 49, 54, 77, 97, 121, 125, 127, 128, 160, 243, 251, 257, 343, 1021, 2048, 2187, 4096, 4099, 6000, 8192});
}

TEST_CASE("a smaller budget of iterations cuts the rings finer, or is refused", "[transform][vulkan]") {
  const auto plain = gpu_backend();
  if (!plain) return skip_without_gpu();
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 120);
  const Both expected = both(*plain, grid, 120, 1);
  int ran = 0, refused = 0;
  for (const std::uint32_t budget : {5000U, 800U, 400U, 150U, 100U, 60U, 20U, 1U}) {
    GpuOptions options;
    options.iteration_budget = budget;
    const auto backend = gpu_backend(options);
    INFO("budget " << budget);
    try {
      const Both found = both(*backend, grid, 120, 1);
      // Rings go another way through the Fourier stage where the budget is too small for whole ones.
      check_at_most(distance(found.values, expected.values), 4e-15, "synthesis");
      check_at_most(distance(found.coefficients, expected.coefficients), 4e-15, "analysis");
      ++ran;
    } catch (const Error& error) {
      CHECK(error.fault() == Fault::too_large);
      CHECK(std::string(error.what()).find("iterations") != std::string::npos);
      ++refused;
    }
    CHECK(backend->validation_messages() == std::vector<std::string>{});
  }
  CHECK(ran >= 4);
  CHECK(refused >= 2);
}

TEST_CASE("a loop the device ends early is an error, not a wrong result", "[transform][vulkan]") {
  // Many rings and few degrees: llvmpipe of Mesa 22.3.6 ends the analysis' loops after 65535 of 74000 iterations.
  SphereGrid grid;
  grid.lmax = 255;
  grid.rings = 16384;
  grid.ring_length = 512;
  for (int i = 0; i < grid.rings; ++i) {
    const long double theta = std::numbers::pi_v<long double> * (i + 0.5L) / grid.rings;
    grid.theta.push_back(double(theta));
    grid.cosine.push_back(std::cos(theta));
    grid.sine.push_back(std::sin(theta));
    grid.weights.push_back(2.0 / grid.rings);
  }
  GpuOptions careless;
  careless.transform_steps = 8;
  careless.transform_rings = 2;
  careless.transform_pairs = 8192;
  careless.iteration_budget = 1000000;
  const auto backend = gpu_backend(careless), careful = gpu_backend();
  if (!backend) return skip_without_gpu();
  const auto analysis = [&](Backend& on) {
    Monitor monitor;
    std::vector<std::complex<double>> coefficients(SphereCoefficients::count(grid.lmax));
    on.sphere_transform(grid, grid.lmax)->analyse(1, random_values(grid.points(), 3), coefficients, monitor);
    return coefficients;
  };
  const auto expected = analysis(*careful);
  try {
    check_at_most(distance(analysis(*backend), expected), 1e-13, "analysis");
  } catch (const Error& error) {
    CHECK(error.fault() == Fault::device_failed);
    CHECK(std::string(error.what()).find("ended a loop early") != std::string::npos);
  }
}

TEST_CASE("transforms on memory that the host does not share give the same bits", "[transform][vulkan]") {
  if (!gpu_backend()) return skip_without_gpu();
  const auto instance = engine::Instance::create(true);
  const auto devices = instance->devices();
  engine::PhysicalDevice physical = engine::choose_device(devices, "auto");
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 40);
  const plan::Legendre plan = plan::legendre(grid, 40);
  engine::GpuFacts facts;
  facts.type = "discrete"; // the layout of one
  facts.subgroup_size = physical.subgroup_size;
  facts.largest_range = 1 << 16; // several slabs
  facts.largest_texels = 1 << 16;
  const engine::SphereTransformShape shape = engine::sphere_transform_shape(facts);
  const plan::Seeds seeds = plan::seeds(plan, int(shape.legendre.lanes), int(shape.legendre.steps));
  const engine::LegendreInput legendre = {plan.lmax,    plan.polar_blocks * plan::block_pairs,
                                          plan.t,       plan.offset,
                                          plan.a,       plan.b,
                                          plan.b_polar, seeds.start,
                                          seeds.values};
  const engine::RingFourierInput fourier = {grid.ring_length, plan.lmax + 1, plan.x, plan.weight};
  constexpr std::uint32_t fields = 2;
  const auto go_on = [](double) { return true; };
  const auto run = [&] {
    engine::Device device(instance, physical);
    engine::SphereTransform transform(device, shape, legendre, fourier);
    std::vector<double> result;
    std::size_t slabs = 0;
    const auto fill = [&](std::span<double> to) {
      const auto values = random_values(to.size(), unsigned(++slabs));
      std::copy(values.begin(), values.end(), to.begin());
    };
    const auto keep = [&](std::span<const double> from, std::size_t count) {
      result.insert(result.end(), from.begin(), from.begin() + std::ptrdiff_t(count));
    };
    const std::size_t row = fields * 2 * std::size_t(grid.ring_length);
    transform.to_values(
        fields, false, fill, [&](engine::RingSlab slab, std::span<const double> v) { keep(v, row * slab.count); },
        go_on);
    slabs = 0;
    transform.to_series(
        fields, true, [&](engine::RingSlab, std::span<double> v) { fill(v); },
        [&](std::span<const double> s) { keep(s, transform.series_index(40, 1, fields)); }, go_on);
    CHECK(slabs > 1);
    return result;
  };
  const std::vector<double> shared = run();
  // Memory that is not cached for the host does not count as shared with it.
  for (std::uint32_t t = 0; t < physical.memory.memoryTypeCount; ++t)
    physical.memory.memoryTypes[t].propertyFlags &= ~VkMemoryPropertyFlags(VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
  const std::vector<double> apart = run();
  CHECK(same(shared, apart));
  CHECK(std::all_of(shared.begin(), shared.end(), [](double v) { return std::isfinite(v); }));
  CHECK(instance->log().messages == std::vector<std::string>{});
}

TEST_CASE("a stop between batches leaves a transform usable", "[transform][vulkan]") {
  GpuOptions options;
  options.transform_binding = 1 << 17; // several slabs of rings
  const auto backend = gpu_backend(options);
  if (!backend) return skip_without_gpu();
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 127);
  const auto transform = backend->sphere_transform(grid, 127);
  const Both before = both(*transform, 2);
  const SphereCoefficients a = random_coefficients(127, 2, 1);
  std::vector<double> values(2 * grid.points());
  std::vector<std::complex<double>> coefficients(a.values.size());
  for (const int after : {0, 1, 2}) {
    Listener first(after), second(after);
    CHECK_THROWS_AS(transform->synthesise(2, a.values, values, first), Error);
    CHECK(first.last < 1);
    CHECK_THROWS_AS(transform->analyse(2, values, coefficients, second), Error);
    CHECK(second.last < 1);
    const Both again = both(*transform, 2);
    CHECK(same(again.values, before.values));
    CHECK(same(again.coefficients, before.coefficients));
  }
  Listener whole;
  transform->synthesise(2, a.values, values, whole);
  CHECK(whole.last == 1);
  CHECK(backend->validation_messages() == std::vector<std::string>{});
}

TEST_CASE("the report of a transform names its kernels and adds up", "[transform][vulkan]") {
  const auto backend = gpu_backend();
  if (!backend) return skip_without_gpu();
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 63);
  const auto transform = backend->sphere_transform(grid, 63);
  const SphereCoefficients a = random_coefficients(63, 4, 1);
  std::vector<double> values(4 * grid.points());
  Monitor monitor;
  TransformReport one, four;
  transform->synthesise(1, a.field(0), std::span(values).first(grid.points()), monitor, &one);
  transform->synthesise(4, a.values, values, monitor, &four);
  for (const TransformReport* report : {&one, &four}) {
    REQUIRE(report->kernels.size() == 2);
    CHECK(report->kernels[0].kernel == "legendre_synthesis");
    CHECK(report->kernels[1].kernel == "ring_fourier");
    CHECK(report->legendre_seconds == report->kernels[0].seconds);
    CHECK(report->fourier_seconds == report->kernels[1].seconds);
    CHECK(report->legendre_seconds > 0);
    CHECK(report->fourier_seconds > 0);
    CHECK(report->seconds >= report->legendre_seconds + report->fourier_seconds);
  }
  CHECK(one.fourier_flops == Approx(5 * 128 * 7 * 32));
  CHECK(four.fourier_flops == Approx(4 * one.fourier_flops));
  // Twelve flops a step with one field; three fields share a recurrence, the fourth has one of its own.
  CHECK(four.legendre_flops == Approx(one.legendre_flops / 12 * (28 + 12)));
  // At most a step for every k, order and pair of rings, padded to segments of 8.
  CHECK(one.legendre_flops <= 12.0 * 64 * 32 * 32);
  CHECK(one.legendre_flops >= 12.0 * 64 * 32 * 12);
}

TEST_CASE("the memory of a transform is of order lmax^2 and points", "[transform][vulkan]") {
  const auto backend = gpu_backend();
  if (!backend) return skip_without_gpu();
  for (const int lmax : {64, 255, 1023, 4095, 8191}) {
    SphereGrid grid; // nothing but its size is read
    grid.lmax = lmax;
    grid.rings = lmax + 1;
    grid.ring_length = 2 * lmax + 2;
    const auto transform = backend->sphere_transform(grid, lmax);
    const MemoryNeed one = transform->memory(1);
    const MemoryNeed three = transform->memory(3);
    const MemoryNeed many = transform->memory(most_fields);
    INFO("lmax " << lmax << ": " << one.host << " and " << one.device << " bytes");
    const double square = double(lmax + 1) * (lmax + 1);
    CHECK(double(one.host) < 30 * square + (4 << 20));
    CHECK(double(one.device) < 120 * square + (4 << 20));
    CHECK(double(one.device) > 16 * square);
    CHECK(three.device > one.device);
    CHECK(many.device == three.device);
  }
}

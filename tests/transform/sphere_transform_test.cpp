#include "host/error.hpp"
#include "host/spectrum/roundtrip.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/compare_transforms.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

const std::vector<GridKind> kinds = {GridKind::gauss_legendre, GridKind::clenshaw_curtis, GridKind::driscoll_healy,
                                     GridKind::driscoll_healy_square, GridKind::fejer};

// sum over m = -l ... l of conj(a) b.
double inner(const SphereCoefficients& a, const SphereCoefficients& b) {
  long double sum = 0;
  for (int f = 0; f < a.fields; ++f)
    for (int m = 0; m <= a.lmax; ++m)
      for (int l = m; l <= a.lmax; ++l) sum += (m == 0 ? 1 : 2) * (std::conj(a.at(f, l, m)) * b.at(f, l, m)).real();
  return double(sum);
}
double inner(const std::vector<double>& f, const std::vector<double>& g) {
  long double sum = 0;
  for (std::size_t i = 0; i < f.size(); ++i) sum += (long double)f[i] * g[i];
  return double(sum);
}

double round_trip(Backend& backend, int lmax, int fields, GridKind kind = GridKind::gauss_legendre) {
  const auto transform = backend.sphere_transform(make_grid(kind, lmax), lmax);
  const SphereCoefficients a = random_coefficients(lmax, fields, 1);
  const SphereCoefficients b = analyse(*transform, fields, synthesise(*transform, a));
  return relative_error(b.values, a.values);
}

} // namespace

TEST_CASE("every path of the transforms agrees with the reference", "[transform]") {
  Paths paths;
  for (const GridKind kind : kinds)
    paths.each([&](Backend& b) { compare_transform(b, make_grid(kind, 7), 7, 3, 2e-14); });
  for (const int fields : {1, 2, 4})
    paths.each([&](Backend& b) { compare_transform(b, make_grid(GridKind::gauss_legendre, 31), 31, fields, 2e-14); });
  paths.each([&](Backend& b) { compare_transform(b, make_grid(GridKind::driscoll_healy, 100), 100, 1, 4e-14); });
}

TEST_CASE("every path of the transforms agrees with the reference at odd sizes", "[transform][long]") {
  Paths paths;
  for (const GridKind kind : kinds)
    for (const int lmax : {0, 1, 2, 7, 31})
      for (const int fields : {1, 2, 3, 4})
        paths.each([&](Backend& b) { compare_transform(b, make_grid(kind, lmax), lmax, fields, 2e-14); });
  for (const GridKind kind : kinds)
    paths.each([&](Backend& b) { compare_transform(b, make_grid(kind, 100), 100, 1, 4e-14); });
  paths.each([&](Backend& b) { compare_transform(b, make_grid(GridKind::gauss_legendre, 257), 257, 1, 2e-13); });
}

TEST_CASE("every path agrees with the reference on grids finer than the degree and on rings of any length",
          "[transform]") {
  Paths paths;
  struct Shape {
    GridKind kind;
    int rings, ring_length, lmax;
  };
  for (const Shape& s : {Shape{GridKind::gauss_legendre, 20, 64, 7}, Shape{GridKind::gauss_legendre, 33, 67, 32},
                         Shape{GridKind::gauss_legendre, 9, 101, 8}, Shape{GridKind::clenshaw_curtis, 24, 25, 11},
                         Shape{GridKind::clenshaw_curtis, 91, 77, 38}, Shape{GridKind::driscoll_healy, 46, 92, 22},
                         Shape{GridKind::driscoll_healy_square, 62, 62, 30}, Shape{GridKind::gauss_legendre, 70, 1, 0}})
    for (const int fields : {1, 3})
      paths.each(
          [&](Backend& b) { compare_transform(b, make_grid(s.kind, s.rings, s.ring_length), s.lmax, fields, 2e-14); });
}

TEST_CASE("random coefficients come back from every grid", "[transform]") {
  Paths paths;
  paths.each([&](Backend& backend) {
    INFO(backend.facts().name);
    for (const GridKind kind : kinds)
      check_at_most(round_trip(backend, 64, 1, kind), 1e-13, std::string(name(kind)) + " 64");
    check_at_most(round_trip(backend, 64, 3), 1e-13, "64, three fields");
    check_at_most(round_trip(backend, 511, 1), 5e-13, "511");
    check_at_most(round_trip(backend, 512, 1), 5e-13, "512");
    check_at_most(round_trip(backend, 512, 5), 5e-13, "512, five fields");
  });
}

TEST_CASE("random coefficients come back at degrees 1024 and 2048", "[transform][long]") {
  Paths paths;
  paths.each([&](Backend& backend) {
    INFO(backend.facts().name);
    check_at_most(round_trip(backend, 1024, 1), 1e-12, "1024");
    check_at_most(round_trip(backend, 1024, 2, GridKind::clenshaw_curtis), 1e-12, "1024, cc, two fields");
    check_at_most(round_trip(backend, 2048, 1), 3e-12, "2048");
  });
}

TEST_CASE("random coefficients come back at degree 4096", "[transform][long]") {
  check_at_most(round_trip(*make_cpu_backend(), 4096, 1), 1e-11, "4096");
}

namespace {

void check_adjoints(std::initializer_list<int> degrees) {
  Paths paths;
  paths.each([&](Backend& backend) {
    INFO(backend.facts().name);
    for (const GridKind kind : kinds)
      for (const int lmax : degrees)
        for (const int fields : {1, 3}) {
          const SphereGrid grid = make_grid(kind, lmax);
          const auto transform = backend.sphere_transform(grid, lmax);
          const SphereCoefficients a = random_coefficients(lmax, fields, 1);
          const auto g = random_values(std::size_t(fields) * grid.points());
          const auto s = synthesise(*transform, a), wa = analyse_adjoint(*transform, a);
          const auto c = synthesise_adjoint(*transform, fields, g), b = analyse(*transform, fields, g);
          const double scale = std::sqrt(inner(s, s) * inner(g, g)), scale_a = std::sqrt(inner(a, a) * inner(b, b));
          check_at_most(std::fabs(inner(s, g) - inner(a, c)) / scale, 1e-14, "<S a, g> - <a, S* g>");
          check_at_most(std::fabs(inner(b, a) - inner(g, wa)) / scale_a, 1e-13, "<A g, a> - <g, A* a>");
        }
  });
}

} // namespace

TEST_CASE("adjoints are adjoint", "[transform]") {
  check_adjoints({40});
}

TEST_CASE("adjoints are adjoint at degrees 3 and 300", "[transform][long]") {
  check_adjoints({3, 300});
}

TEST_CASE("nothing above lmax leaks into the degrees below", "[transform]") {
  Paths paths;
  paths.each([&](Backend& backend) {
    INFO(backend.facts().name);
    for (const GridKind kind : kinds) {
      const int high = 100, low = 60;
      const SphereGrid grid = make_grid(kind, high);
      SphereCoefficients a = random_coefficients(high, 1, 1);
      for (int m = 0; m <= low; ++m)
        for (int l = m; l <= low; ++l) a.at(0, l, m) = 0;
      const auto f = synthesise(*backend.sphere_transform(grid, high), a);
      const auto b = analyse(*backend.sphere_transform(grid, low), 1, f);
      double leaked = 0;
      for (const auto& v : b.values) leaked = std::max(leaked, std::abs(v));
      check_at_most(leaked / std::sqrt(inner(a, a)), 2e-15,
                    std::string(name(kind)) + ": coefficients to 60 over the norm of a field of degrees 61 to 100");
    }
  });
}

TEST_CASE("fields in closed form have the coefficients they should", "[transform]") {
  constexpr double pi = std::numbers::pi;
  Paths paths;
  paths.each([&](Backend& backend) {
    for (const GridKind kind : kinds) {
      INFO(name(kind) << " " << backend.facts().name);
      const SphereGrid grid = make_grid(kind, 5);
      // 1 + z + x and y + 3 z^2 - 1
      std::vector<double> values;
      for (const int field : {0, 1})
        for (int i = 0; i < grid.rings; ++i)
          for (int j = 0; j < grid.ring_length; ++j) {
            const double z = double(grid.cosine[std::size_t(i)]), s = double(grid.sine[std::size_t(i)]);
            const double x = s * std::cos(grid.phi(j)), y = s * std::sin(grid.phi(j));
            values.push_back(field == 0 ? 1 + z + x : y + 3 * z * z - 1);
          }
      SphereCoefficients exact(5, 2);
      exact.at(0, 0, 0) = std::sqrt(4 * pi);
      exact.at(0, 1, 0) = std::sqrt(4 * pi / 3);
      exact.at(0, 1, 1) = -std::sqrt(2 * pi / 3);
      exact.at(1, 1, 1) = std::complex<double>(0, std::sqrt(2 * pi / 3));
      exact.at(1, 2, 0) = std::sqrt(16 * pi / 5);
      const auto found = analyse(*backend.sphere_transform(grid, 5), 2, values);
      check_at_most(relative_error(found.values, exact.values), 1e-15, "coefficients");
    }
  });
}

TEST_CASE("power is kept: Parseval's theorem", "[transform]") {
  Paths paths;
  paths.each([&](Backend& backend) {
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, 120);
    const SphereCoefficients a = random_coefficients(60, 1, 1);
    const auto f = synthesise(*backend.sphere_transform(grid, 60), a); // f^2 has degree 120
    long double integral = 0;
    for (int i = 0; i < grid.rings; ++i)
      for (int j = 0; j < grid.ring_length; ++j) {
        const double v = f[std::size_t(i) * std::size_t(grid.ring_length) + std::size_t(j)];
        integral += grid.weights[std::size_t(i)] * 2 * std::numbers::pi / grid.ring_length * v * v;
      }
    check_at_most(std::fabs(double(integral) / inner(a, a) - 1), 1e-14,
                  "integral of f^2 over the sum of |a|^2, less 1");
  });
}

TEST_CASE("a field does not depend on the fields beside it, nor on imaginary parts at m = 0", "[transform]") {
  Paths paths;
  paths.each([&](Backend& backend) {
    INFO(backend.facts().name);
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, 45);
    const auto transform = backend.sphere_transform(grid, 45);
    const SphereCoefficients all = random_coefficients(45, 7, 1);
    const auto together = synthesise(*transform, all);
    for (int f = 0; f < 7; ++f) {
      SphereCoefficients one(45, 1);
      std::copy(all.field(f).begin(), all.field(f).end(), one.values.begin());
      for (int l = 0; l <= 45; ++l) one.at(0, l, 0) += std::complex<double>(0, 3);
      const auto alone = synthesise(*transform, one);
      check_at_most(relative_error(std::span(together).subspan(std::size_t(f) * grid.points(), grid.points()), alone),
                    1e-15, "field " + std::to_string(f));
    }
  });
}

TEST_CASE("transforms repeat bit for bit, and on any number of threads", "[transform]") {
  const auto run = [](Backend& backend) {
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, 130);
    const auto transform = backend.sphere_transform(grid, 130);
    const auto f = synthesise(*transform, random_coefficients(130, 3, 1));
    const auto again = synthesise(*transform, random_coefficients(130, 3, 1));
    CHECK(std::memcmp(f.data(), again.data(), f.size() * sizeof(double)) == 0);
    const auto a = analyse(*transform, 3, f);
    return std::pair(f, a.values);
  };
  Paths paths;
  paths.each([&](Backend& backend) {
    const auto first = run(backend), second = run(backend);
    CHECK(std::memcmp(first.first.data(), second.first.data(), first.first.size() * sizeof(double)) == 0);
    CHECK(std::memcmp(first.second.data(), second.second.data(), first.second.size() * 16) == 0);
  });
  const auto one = run(*make_cpu_backend(1)), three = run(*make_cpu_backend(3));
  CHECK(std::memcmp(one.first.data(), three.first.data(), one.first.size() * sizeof(double)) == 0);
  CHECK(std::memcmp(one.second.data(), three.second.data(), one.second.size() * 16) == 0);
}

TEST_CASE("what does not fit a transform is refused", "[transform]") {
  Paths paths;
  paths.each([&](Backend& backend) {
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, 8);
    CHECK_THROWS_AS(backend.sphere_transform(grid, 9), Error);
    CHECK_THROWS_AS(backend.sphere_transform(grid, -1), Error);
    const auto transform = backend.sphere_transform(grid, 8);
    Monitor silent;
    std::vector<double> values(grid.points());
    std::vector<std::complex<double>> a(SphereCoefficients::count(8));
    CHECK_NOTHROW(transform->synthesise(1, a, values, silent));
    CHECK_THROWS_AS(transform->synthesise(2, a, values, silent), Error);
    CHECK_THROWS_AS(transform->synthesise(-1, a, values, silent), Error);
    CHECK_THROWS_AS(transform->analyse(1, std::span(values).first(values.size() - 1), a, silent), Error);
    CHECK_THROWS_AS(transform->analyse_adjoint(1, std::span(a).first(3), values, silent), Error);
    CHECK_NOTHROW(transform->analyse(0, {}, {}, silent));
    std::vector<double> many(65 * grid.points());
    std::vector<std::complex<double>> many_a(65 * a.size());
    CHECK_THROWS_AS(transform->synthesise(65, many_a, many, silent), Error);
    CHECK_NOTHROW(transform->synthesise(64, std::span(many_a).first(64 * a.size()),
                                        std::span(many).first(64 * grid.points()), silent));
  });
}

TEST_CASE("a transform outlives its backend", "[transform]") {
  const SphereGrid grid = make_grid(GridKind::driscoll_healy, 90);
  for (const bool gpu : {false, true}) {
    auto backend = gpu ? gpu_backend() : make_cpu_backend();
    if (!backend) continue;
    const auto transform = backend->sphere_transform(grid, 8);
    backend.reset();
    const SphereCoefficients a = random_coefficients(8, 1, 1);
    check_at_most(relative_error(analyse(*transform, 1, synthesise(*transform, a)).values, a.values), 1e-14,
                  gpu ? "Vulkan" : "CPU");
  }
}

TEST_CASE("a transform stops when asked to", "[transform]") {
  struct Stop final : Monitor {
    bool stopped() const override { return true; }
  } stop;
  Paths paths;
  paths.each([&](Backend& backend) {
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, 200);
    const auto transform = backend.sphere_transform(grid, 200);
    const SphereCoefficients a = random_coefficients(200, 1, 1);
    std::vector<double> values(grid.points());
    Fault fault = Fault::bad_argument;
    try {
      transform->synthesise(1, a.values, values, stop);
    } catch (const Error& error) {
      fault = error.fault();
    }
    CHECK(fault == Fault::interrupted);
    // and goes on afterwards
    const auto f = synthesise(*transform, a);
    check_at_most(relative_error(analyse(*transform, 1, f).values, a.values), 1e-12, "round trip after a stop");
  });
}

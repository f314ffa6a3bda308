#include "host/sphere_transform.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace cowgpu {

namespace {

// Coefficients times exp(i m delta), delta = sign 2 pi shift / ring_length: what a grid whose rings begin beside longitude 0 has
// instead of them.
void turn(const SphereGrid& grid, int lmax, int fields, int sign, std::span<std::complex<double>> coefficients) {
  const std::size_t count = SphereCoefficients::count(lmax);
  for (int m = 1; m <= lmax; ++m) {
    const long double steps =
        std::fmod(static_cast<long double>(m) * static_cast<long double>(grid.shift), grid.ring_length);
    const long double angle = 2 * std::numbers::pi_v<long double> * steps / grid.ring_length;
    const std::complex<double> factor(double(std::cos(angle)), sign * double(std::sin(angle)));
    for (std::size_t f = 0; f < std::size_t(fields); ++f) {
      std::complex<double>* const at = coefficients.data() + f * count + SphereCoefficients::index(lmax, m, m);
      for (int i = 0; i <= lmax - m; ++i) {
        const double re = at[i].real(), im = at[i].imag();
        at[i] = {re * factor.real() - im * factor.imag(), re * factor.imag() + im * factor.real()};
      }
    }
  }
}

} // namespace

SphereTransform::SphereTransform(SphereGrid grid, int lmax) : grid_(std::move(grid)), lmax_(lmax) {
  if (lmax < 0 || lmax > grid_.lmax)
    throw Error(Fault::bad_argument,
                fmt::format("a transform of degree {} on a grid of {} rings of {} points, which is exact to degree {} "
                            "only: take a finer grid or a lower degree",
                            lmax, grid_.rings, grid_.ring_length, grid_.lmax));
}

void SphereTransform::check(int fields, std::size_t coefficients, std::size_t values) const {
  if (fields < 0 || fields > most_fields)
    throw Error(Fault::bad_argument,
                fmt::format("one transform cannot take {} fields: 0 to {} are possible", fields, most_fields));
  const std::size_t n = std::size_t(fields);
  if (coefficients != n * SphereCoefficients::count(lmax_) || values != n * grid_.points())
    throw Error(Fault::bad_argument,
                fmt::format("a transform of {} fields to degree {} on {} points takes {} coefficients and {} values, "
                            "not {} and {}",
                            fields, lmax_, grid_.points(), n * SphereCoefficients::count(lmax_), n * grid_.points(),
                            coefficients, values));
}

template <class Work>
void SphereTransform::timed(int fields, std::size_t coefficients, std::size_t values, TransformReport* report,
                            const Work& work) {
  check(fields, coefficients, values);
  prepare();
  const auto start = Clock::now();
  TransformReport own;
  if (fields > 0) work(own);
  own.seconds = seconds_since(start);
  if (report) *report = std::move(own);
}

void SphereTransform::to_rings(int fields, std::span<const std::complex<double>> coefficients, std::span<double> values,
                               RingFactor factor, Monitor& monitor, TransformReport& report) {
  if (grid_.shift == 0) return to_grid(fields, coefficients, values, factor, monitor, report);
  std::vector<std::complex<double>> turned(coefficients.begin(), coefficients.end());
  turn(grid_, lmax_, fields, 1, turned);
  to_grid(fields, turned, values, factor, monitor, report);
}

void SphereTransform::from_rings(int fields, std::span<const double> values,
                                 std::span<std::complex<double>> coefficients, RingFactor factor, Monitor& monitor,
                                 TransformReport& report) {
  from_grid(fields, values, coefficients, factor, monitor, report);
  if (grid_.shift != 0) turn(grid_, lmax_, fields, -1, coefficients);
}

void SphereTransform::synthesise(int fields, std::span<const std::complex<double>> coefficients,
                                 std::span<double> values, Monitor& monitor, TransformReport* report) {
  timed(fields, coefficients.size(), values.size(), report,
        [&](TransformReport& own) { to_rings(fields, coefficients, values, RingFactor::one, monitor, own); });
}

void SphereTransform::analyse(int fields, std::span<const double> values, std::span<std::complex<double>> coefficients,
                              Monitor& monitor, TransformReport* report) {
  timed(fields, coefficients.size(), values.size(), report,
        [&](TransformReport& own) { from_rings(fields, values, coefficients, RingFactor::weight, monitor, own); });
}

void SphereTransform::synthesise_adjoint(int fields, std::span<const double> values,
                                         std::span<std::complex<double>> coefficients, Monitor& monitor,
                                         TransformReport* report) {
  timed(fields, coefficients.size(), values.size(), report,
        [&](TransformReport& own) { from_rings(fields, values, coefficients, RingFactor::one, monitor, own); });
}

void SphereTransform::analyse_adjoint(int fields, std::span<const std::complex<double>> coefficients,
                                      std::span<double> values, Monitor& monitor, TransformReport* report) {
  timed(fields, coefficients.size(), values.size(), report,
        [&](TransformReport& own) { to_rings(fields, coefficients, values, RingFactor::weight, monitor, own); });
}

} // namespace cowgpu

#include "host/sphere_transform.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"

#include <fmt/format.h>

#include <utility>

namespace cowgpu {

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
                fmt::format("{} fields in one transform: 0 to {} are possible", fields, most_fields));
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
  const auto start = Clock::now();
  TransformReport own;
  if (fields > 0) work(own);
  own.seconds = seconds_since(start);
  if (report) *report = std::move(own);
}

void SphereTransform::synthesise(int fields, std::span<const std::complex<double>> coefficients,
                                 std::span<double> values, Monitor& monitor, TransformReport* report) {
  timed(fields, coefficients.size(), values.size(), report,
        [&](TransformReport& own) { to_grid(fields, coefficients, values, RingFactor::one, monitor, own); });
}

void SphereTransform::analyse(int fields, std::span<const double> values, std::span<std::complex<double>> coefficients,
                              Monitor& monitor, TransformReport* report) {
  timed(fields, coefficients.size(), values.size(), report,
        [&](TransformReport& own) { from_grid(fields, values, coefficients, RingFactor::weight, monitor, own); });
}

void SphereTransform::synthesise_adjoint(int fields, std::span<const double> values,
                                         std::span<std::complex<double>> coefficients, Monitor& monitor,
                                         TransformReport* report) {
  timed(fields, coefficients.size(), values.size(), report,
        [&](TransformReport& own) { from_grid(fields, values, coefficients, RingFactor::one, monitor, own); });
}

void SphereTransform::analyse_adjoint(int fields, std::span<const std::complex<double>> coefficients,
                                      std::span<double> values, Monitor& monitor, TransformReport* report) {
  timed(fields, coefficients.size(), values.size(), report,
        [&](TransformReport& own) { to_grid(fields, coefficients, values, RingFactor::weight, monitor, own); });
}

} // namespace cowgpu

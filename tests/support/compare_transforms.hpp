// One call that runs every path of the sphere transforms and holds each against the reference.
#pragma once

#include "host/backend.hpp"

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::test {

/// Values uniform in [-0.5, 0.5].
std::vector<double> random_values(std::size_t size, std::uint32_t seed = 2);

/// Calls without anybody watching; results in fresh storage.
std::vector<double> synthesise(SphereTransform& transform, const SphereCoefficients& coefficients);
SphereCoefficients analyse(SphereTransform& transform, int fields, std::span<const double> values);
std::vector<double> analyse_adjoint(SphereTransform& transform, const SphereCoefficients& coefficients);
SphereCoefficients synthesise_adjoint(SphereTransform& transform, int fields, std::span<const double> values);

/// Largest |a - b| over largest |b|.
double relative_error(std::span<const double> a, std::span<const double> b);
double relative_error(std::span<const std::complex<double>> a, std::span<const std::complex<double>> b);

/// Asks that synthesis, analysis and both adjoints of `fields` random fields agree with the reference in 80-bit
/// arithmetic to `figure` of the largest value of each field.
void compare_transform(Backend& backend, const SphereGrid& grid, int lmax, int fields, double figure);

} // namespace cowgpu::test

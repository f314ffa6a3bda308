#include "host/physics/potential.hpp"

#include "host/error.hpp"
#include "host/physics/rigid_body.hpp"
#include "host/spectrum/convert.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu::physics {

Multipoles mass_moments(const CoefficientSet& set, int lmax) {
  check_mass_multipoles(set);
  ConversionTarget target;
  target.kind = CoefficientKind::multipoles;
  target.lmax = std::min(lmax, set.lmax);
  const CoefficientSet low = converted(set, target);
  if (!low.reference_radius || !(*low.reference_radius > 0))
    throw Error(Fault::file_format, "these coefficients do not say their reference radius");
  Multipoles moments(low.lmax);
  moments.origin = set.origin.value_or(Vec3::Zero());
  moments.reference_radius = *low.reference_radius;
  moments.density = set.density.value_or(1);
  moments.values = orthonormal(low).values;
  return set.brillouin_radius ? over_radius(std::move(moments), *set.brillouin_radius) : moments;
}

Multipoles over_radius(Multipoles moments, double radius) {
  if (!(radius > 0) || !std::isfinite(radius))
    throw Error(Fault::bad_argument, fmt::format("the radius of the moments is {}: it must be above 0", radius));
  if (radius == moments.reference_radius) return moments;
  const long double ratio = (long double)(moments.reference_radius) / radius;
  for (int l = 0; l <= moments.lmax; ++l) {
    const long double factor = std::pow(ratio, (long double)(l));
    for (int m = 0; m <= l; ++m) {
      std::complex<double>& q = moments(l, m);
      const auto times = [&](double part) { return part == 0 ? 0 : double(factor * part); };
      q = {times(q.real()), times(q.imag())};
      if (!std::isfinite(q.real()) || !std::isfinite(q.imag()))
        throw Error(Fault::bad_argument,
                    fmt::format("over a radius of {:.6g} the moments of degree {} exceed doubles, and their reference "
                                "radius is {:.6g}: that is too far inside; lower the degree, or move farther out",
                                radius, l, moments.reference_radius));
    }
  }
  moments.reference_radius = radius;
  return moments;
}

std::vector<double> degree_sizes(const Multipoles& moments, double radius) {
  std::vector<double> sizes;
  const long double ratio = (long double)(moments.reference_radius) / radius;
  for (int l = 0; l <= moments.lmax; ++l) {
    double sum = std::norm(moments(l, 0));
    for (int m = 1; m <= l; ++m) sum += 2 * std::norm(moments(l, m));
    const long double factor = std::pow(ratio, (long double)(l));
    sizes.push_back(double(std::sqrt(4 * std::numbers::pi * sum) / (2 * l + 1) * factor));
  }
  return sizes;
}

double term_growth(const Multipoles& moments, int lmax, double radius) {
  const std::vector<double> sizes = degree_sizes(moments, radius);
  const auto half = sizes.begin() + lmax / 2 + 1, end = sizes.begin() + lmax + 1;
  const double low = *std::max_element(sizes.begin(), half), high = half < end ? *std::max_element(half, end) : 0;
  return high == 0 ? 0 : high / low;
}

Multipoles in_si(Multipoles moments, double metres, double kilograms) {
  moments.origin *= metres;
  moments.reference_radius *= metres;
  for (auto& q : moments.values) q *= kilograms;
  return moments;
}

} // namespace cowgpu::physics

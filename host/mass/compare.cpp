#include "host/mass/compare.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cowgpu {
namespace {

template <class Value>
DegreeErrors compare_with(const Multipoles& a, std::span<const double> estimate, const Value& b) {
  DegreeErrors errors;
  // What is beyond the range of doubles beside the largest degree is no error.
  const double nothing = 1e-250 * *std::max_element(estimate.begin(), estimate.end());
  for (int l = 0; l <= a.lmax; ++l) {
    long double difference = 0, square = 0;
    for (int m = 0; m <= l; ++m) {
      const std::size_t i = Multipoles::index(a.lmax, l, m);
      const auto [re, im] = b(i);
      const long double weight = m == 0 ? 1 : 2;
      const long double dre = (long double)(a.values[i].real()) - re, dim = (long double)(a.values[i].imag()) - im;
      difference += weight * (dre * dre + dim * dim);
      square += weight * (re * re + im * im);
    }
    errors.difference.push_back(double(std::sqrt(difference)));
    errors.norm.push_back(double(std::sqrt(square)));
    const double apart = errors.difference.back();
    const double ratio = apart <= nothing ? 0 : apart / estimate[std::size_t(l)];
    if (!std::isnan(errors.ratio) && !(ratio <= errors.ratio)) {
      errors.ratio = ratio;
      errors.degree = l;
    }
  }
  return errors;
}

} // namespace

double DegreeErrors::relative() const {
  const std::size_t l = std::size_t(degree);
  return difference[l] == 0 ? 0 : difference[l] / norm[l];
}

DegreeErrors compare(const Multipoles& a, const Multipoles& b, std::span<const double> estimate) {
  return compare_with(a, estimate, [&](std::size_t i) {
    return std::pair<long double, long double>(b.values[i].real(), b.values[i].imag());
  });
}

DegreeErrors compare(const Multipoles& a, std::span<const long double> b, std::span<const double> estimate) {
  return compare_with(a, estimate, [&](std::size_t i) { return std::pair(b[2 * i], b[2 * i + 1]); });
}

} // namespace cowgpu

#include "host/spectrum/compare.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cowgpu {
namespace {

template <class Value>
DegreeErrors compare_with(const Coefficients& a, std::span<const double> bound, const Value& b) {
  DegreeErrors errors;
  for (int l = 0; l <= a.lmax; ++l) {
    long double difference = 0, square = 0;
    for (int m = 0; m <= l; ++m) {
      const std::size_t i = Coefficients::index(l, m);
      const auto [re, im] = b(i);
      const long double weight = m == 0 ? 1 : 2;
      const long double dre = (long double)(a.values[i].real()) - re, dim = (long double)(a.values[i].imag()) - im;
      difference += weight * (dre * dre + dim * dim);
      square += weight * (re * re + im * im);
    }
    const double limit = bound[std::size_t(l)];
    double scale = double(std::sqrt(square));
    if (l == 1 || scale < 1e-3 * limit) scale = limit;
    // What is beyond the range of doubles beside the largest bound is no error.
    const bool vanishes = difference == 0 || double(std::sqrt(difference)) <= 1e-280 * bound[0];
    const double error = vanishes ? 0.0 : double(std::sqrt(difference)) / scale;
    errors.relative.push_back(error);
    const double weighed = vanishes ? 0.0 : error / std::max(1.0, limit / (15 * scale));
    if (!std::isnan(errors.weighed) && !(weighed <= errors.weighed)) errors.weighed = weighed;
    if (!std::isnan(errors.worst) && !(error <= errors.worst)) {
      errors.worst = error;
      errors.worst_degree = l;
    }
  }
  return errors;
}

} // namespace

DegreeErrors compare(const Coefficients& a, const Coefficients& b, std::span<const double> bound) {
  return compare_with(a, bound, [&](std::size_t i) {
    return std::pair<long double, long double>(b.values[i].real(), b.values[i].imag());
  });
}

DegreeErrors compare(const Coefficients& a, std::span<const long double> b, std::span<const double> bound) {
  return compare_with(a, bound, [&](std::size_t i) { return std::pair(b[2 * i], b[2 * i + 1]); });
}

double expected_error(int lmax) {
  return 3e-14 * std::max(1.0, lmax / 512.0);
}

} // namespace cowgpu

#include "host/physics/potential_terms.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu::physics {

PotentialTerms::PotentialTerms(const Multipoles& moments) : lmax_(moments.lmax) {
  const int top = lmax_ + 1;
  for (auto& set : sets_) set.assign(SphereCoefficients::count(top), 0);
  for (int m = 0; m <= top; ++m)
    for (int l = m; l <= top; ++l) {
      const double a = std::sqrt(double(2 * l + 1) * double(2 * l + 3) / (double(l + 1 - m) * double(l + 1 + m)));
      recursion_.push_back(
          {a, l == m ? 0 : a * std::sqrt(double(l - m) * double(l + m) / (double(2 * l - 1) * double(2 * l + 1)))});
    }
  const auto of_value = [&](int l, int m) -> Complex {
    if (l < 0 || l > lmax_ || std::abs(m) > l) return 0;
    const Complex a = 4 * std::numbers::pi / double(2 * l + 1) * std::conj(moments(l, std::abs(m)));
    return m >= 0 ? a : m % 2 ? -std::conj(a) : std::conj(a);
  };
  for (int l = 0; l <= top; ++l)
    for (int m = 0; m <= l; ++m) {
      const std::size_t i = SphereCoefficients::index(top, l, m);
      sets_[0][i] = of_value(l, m);
      if (l == 0) continue;
      const double k = double(2 * l - 1) / double(2 * l + 1);
      const Complex raised = std::sqrt(k * double(l + m - 1) * double(l + m)) * of_value(l - 1, m - 1);
      const Complex lowered = -std::sqrt(k * double(std::max(l - m - 1, 0)) * double(l - m)) * of_value(l - 1, m + 1);
      sets_[1][i] = (raised + lowered) * 0.5;
      sets_[2][i] = (raised - lowered) * Complex(0, -0.5);
      sets_[3][i] = -std::sqrt(k * double(l - m) * double(l + m)) * of_value(l - 1, m);
    }
}

void PotentialTerms::at(std::span<const Vec3> points, int lmax, std::vector<DegreeTerm>& terms) const {
  using Lanes = std::array<double, group>;
  const int top = lmax + 1;
  Lanes x{}, y{}, z{}, q{}, start_re{}, start_im{};
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double r2 = points[p].squaredNorm();
    x[p] = points[p].x() / r2;
    y[p] = points[p].y() / r2;
    z[p] = points[p].z() / r2;
    q[p] = 1 / r2;
    start_re[p] = std::sqrt(q[p] / (4 * std::numbers::pi));
  }
  std::vector<std::array<Lanes, 4>> sums(std::size_t(top) + 1);
  for (int m = 0; m <= top; ++m) {
    Lanes re = start_re, im = start_im, last_re{}, last_im{};
    const double weight = m == 0 ? 1 : 2; // for -m
    for (int l = m; l <= top; ++l) {
      for (std::size_t s = 0; s < 4; ++s) {
        const Complex c = weight * coefficient(s, l, m);
        const double a = c.real(), b = -c.imag();
        Lanes& sum = sums[std::size_t(l)][s];
        for (std::size_t p = 0; p < group; ++p) sum[p] += a * re[p] + b * im[p];
      }
      const auto [a, b] = recursion_[SphereCoefficients::index(lmax_ + 1, l, m)];
      for (std::size_t p = 0; p < group; ++p) {
        const double next_re = a * z[p] * re[p] - b * q[p] * last_re[p];
        const double next_im = a * z[p] * im[p] - b * q[p] * last_im[p];
        last_re[p] = re[p];
        last_im[p] = im[p];
        re[p] = next_re;
        im[p] = next_im;
      }
    }
    const double factor = -std::sqrt(double(2 * m + 3) / double(2 * m + 2));
    for (std::size_t p = 0; p < group; ++p) {
      const double turned = factor * (x[p] * start_re[p] - y[p] * start_im[p]);
      start_im[p] = factor * (y[p] * start_re[p] + x[p] * start_im[p]);
      start_re[p] = turned;
    }
  }
  terms.assign(std::size_t(lmax + 1) * group, {});
  for (int l = 0; l <= lmax; ++l)
    for (std::size_t p = 0; p < points.size(); ++p) {
      const auto& next = sums[std::size_t(l) + 1];
      terms[std::size_t(l) * group + p] = {sums[std::size_t(l)][0][p], Vec3(next[1][p], next[2][p], next[3][p])};
    }
}

SphereCoefficients PotentialTerms::on_sphere(double d, int least, int most) const {
  SphereCoefficients fields(most + 1, 4);
  for (std::size_t s = 0; s < 4; ++s) {
    const int first = least + (s > 0 ? 1 : 0), last = most + (s > 0 ? 1 : 0);
    for (int m = 0; m <= last; ++m)
      for (int l = std::max(first, m); l <= last; ++l)
        fields.at(int(s), l, m) = coefficient(s, l, m) * std::pow(d, -(l + 1));
  }
  return fields;
}

} // namespace cowgpu::physics

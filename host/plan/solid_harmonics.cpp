#include "host/plan/solid_harmonics.hpp"

#include <cmath>

namespace cowgpu::plan {
namespace {

using Real = long double;

// d/dz of f(z, y, x) is (d/dx f)(z, y, x), and d/dz, d/dx lower the degree by one: each degree's exchange follows from the one
// below. Only harmonics with m = l have no derivative along z; their entries follow by symmetry, and the last one is known:
// (z + i y)^l holds 2^(1-l) of (x + i y)^l, or nothing.
void exchange(HarmonicFactors& factors) {
  std::vector<Real> low_cosines, low_sines;
  for (int l = 0; l <= largest_expansion_order; ++l) {
    const int width = l + 1;
    std::vector<Real> cosines(std::size_t(width * width)), sines(std::size_t(width * width));
    const auto low = [&](const std::vector<Real>& of, int m, int k) {
      return k < 0 || k >= l ? Real(0) : of[std::size_t(m * l + k)];
    };
    for (int m = 0; m < l; ++m) {
      const Real along = std::sqrt(Real(l * l - m * m));
      for (int k = 0; k <= l; ++k) {
        // The factors of HarmonicFactors::down and up, to all digits.
        const Real down = k == 0 ? 0 : std::sqrt(Real((l + k) * (l + k - 1)) * (k == 1 ? 2 : 1)) / 2;
        const Real up = k == 0 ? std::sqrt(Real(l * (l - 1)) / 2) : std::sqrt(Real((l - k) * (l - k - 1))) / 2;
        const auto at = std::size_t(m * width + k);
        if ((l + m + k) % 2 == 0)
          cosines[at] = (down * low(low_cosines, m, k - 1) - up * low(low_cosines, m, k + 1)) / along;
        else if (m > 0 && k > 0)
          sines[at] = ((k > 1 ? down * low(low_sines, m, k - 1) : 0) - up * low(low_sines, m, k + 1)) / along;
      }
    }
    for (int k = 0; k < l; ++k) {
      cosines[std::size_t(l * width + k)] = cosines[std::size_t(k * width + l)];
      sines[std::size_t(l * width + k)] = sines[std::size_t(k * width + l)];
    }
    const Real last = l == 0 ? 1 : std::ldexp(Real(1), 1 - l);
    (l % 2 == 0 ? cosines : sines).back() = last;
    factors.cosines[std::size_t(l)].assign(cosines.begin(), cosines.end());
    factors.sines[std::size_t(l)].assign(sines.begin(), sines.end());
    low_cosines = std::move(cosines);
    low_sines = std::move(sines);
  }
}

HarmonicFactors make() {
  HarmonicFactors f{};
  const auto root = [](int square) { return std::sqrt(double(square)); };
  for (int l = 0; l <= largest_expansion_order + 1; ++l) {
    const auto row = std::size_t(l);
    f.diagonal[row] = l <= 1 ? 1 : std::sqrt((2. * l - 1) / (2. * l));
    Real norm = std::tgamma(Real(l + 1)); // sqrt((l-m)! (l+m)!)
    for (int m = 0; m <= l; ++m) {
      const auto column = std::size_t(m);
      if (m > 0) norm *= std::sqrt(Real(l + m) / Real(l - m + 1));
      f.norm[row][column] = double(m > 0 ? norm * std::sqrt(Real(2)) : norm);
      f.along[row][column] = root(l * l - m * m);
      f.down[row][column] = m == 0 ? 0 : m == 1 ? root(2 * (l + 1) * l) / 2 : root((l + m) * (l + m - 1)) / 2;
      f.up[row][column] = m == 0 ? std::sqrt(l * (l - 1) / 2.) : m == l ? 0 : root((l - m) * (l - m - 1)) / 2;
      if (m == l) continue;
      f.rise[row][column] = (2 * l - 1) / root(l * l - m * m);
      f.fall[row][column] = l == m + 1 ? 0 : root((l - 1) * (l - 1) - m * m) / root(l * l - m * m);
    }
  }
  exchange(f);
  return f;
}

} // namespace

const HarmonicFactors& harmonic_factors() {
  static const HarmonicFactors factors = make();
  return factors;
}

} // namespace cowgpu::plan

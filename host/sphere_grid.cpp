#include "host/sphere_grid.hpp"

#include "host/error.hpp"
#include "host/parallel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cowgpu {
namespace {

using Real = long double;
constexpr Real pi = std::numbers::pi_v<Real>;

int smooth_at_least(int n) {
  for (;; ++n) {
    int rest = n;
    for (const int p : {2, 3, 5})
      while (rest % p == 0) rest /= p;
    if (rest == 1) return n;
  }
}

struct LegendreValue {
  Real value, previous; // P_n, P_{n-1}
};

// k/(k+1) and (2k+1)/(k+1).
struct LegendreFactors {
  explicit LegendreFactors(int n) : older(std::size_t(n)), newer(std::size_t(n)) {
    for (int k = 0; k < n; ++k) {
      older[std::size_t(k)] = Real(k) / Real(k + 1);
      newer[std::size_t(k)] = Real(2 * k + 1) / Real(k + 1);
    }
  }
  std::vector<Real> older, newer;
};

// P_n(z) by the recurrence in z.
LegendreValue legendre(const LegendreFactors& f, Real z) {
  Real previous = 0, value = 1;
  for (std::size_t k = 0; k < f.older.size(); ++k) {
    const Real next = f.newer[k] * z * value - f.older[k] * previous;
    previous = value;
    value = next;
  }
  return {value, previous};
}

// P_n(1 - u) by its differences, which keeps the digits of a small u.
LegendreValue legendre_near_pole(const LegendreFactors& f, Real u) {
  Real difference = 0, value = 1, previous = 0;
  for (std::size_t k = 0; k < f.older.size(); ++k) {
    difference = f.older[k] * difference - f.newer[k] * u * value;
    previous = value;
    value += difference;
  }
  return {value, previous};
}

struct Node {
  Real cosine, sine;
  double weight;
};

// Zero i of P_n counted from the north pole, by Newton's iteration in z, or in u = 1 - z near the pole.
Node gauss_node(const LegendreFactors& f, int i) {
  const int n = int(f.older.size());
  Real theta = pi * (i + 0.75L) / (n + 0.5L);
  theta += 1 / (8 * Real(n + 0.5L) * Real(n + 0.5L) * std::tan(theta));
  const bool polar = theta < pi / 3;
  Real u = 2 * std::pow(std::sin(theta / 2), 2.0L), z = std::cos(theta);
  Real slope = 0;
  // The step after one below 1e-10 of the value is exact; its slope is taken at the exact place.
  for (int pass = 0, left = 1; pass < 20 && left >= 0; ++pass) {
    const LegendreValue p = polar ? legendre_near_pole(f, u) : legendre(f, z);
    const Real sine2 = polar ? u * (2 - u) : (1 - z) * (1 + z);
    slope = Real(n) * (p.previous - (polar ? 1 - u : z) * p.value) / sine2;
    const Real step = p.value / slope;
    if (left < 1) break;
    (polar ? u : z) += polar ? step : -step;
    if (std::fabs(step) <= 1e-10L * (polar ? u : std::fabs(z) + 1.0L / n)) left = 0;
  }
  const Real sine2 = polar ? u * (2 - u) : (1 - z) * (1 + z);
  return {polar ? 1 - u : z, std::sqrt(sine2), double(2 / (sine2 * slope * slope))};
}

void set_ring(SphereGrid& grid, int i, Real cosine, Real sine) {
  const auto at = std::size_t(i);
  grid.cosine[at] = cosine;
  grid.sine[at] = sine;
  grid.theta[at] = double(std::atan2(sine, cosine));
}

void gauss_legendre(SphereGrid& grid) {
  const int n = grid.rings;
  const LegendreFactors factors(n);
  const auto half = std::size_t(n / 2);
  constexpr std::size_t chunk = 16;
  parallel_for(0, (half + chunk - 1) / chunk, [&](std::size_t task, unsigned) {
    for (std::size_t i = task * chunk; i < std::min(half, (task + 1) * chunk); ++i) {
      const Node node = gauss_node(factors, int(i));
      const std::size_t mirror = std::size_t(n) - 1 - i;
      set_ring(grid, int(i), node.cosine, node.sine);
      set_ring(grid, int(mirror), -node.cosine, node.sine);
      grid.weights[i] = grid.weights[mirror] = node.weight;
    }
  });
  if (n % 2) {
    set_ring(grid, n / 2, 0, 1);
    const Real previous = legendre(factors, 0).previous;
    grid.weights[half] = double(2 / (Real(n) * Real(n) * previous * previous));
  }
}

// cos and sin of pi i / n for i = 0 ... n.
std::vector<Real> cosines(int n) {
  std::vector<Real> c(std::size_t(n) + 1);
  for (int i = 0; i <= n; ++i) // from the nearest of pole and equator, so that zeros are zeros and signs are symmetric
    c[std::size_t(i)] = 4 * i <= n      ? std::cos(pi * i / n)
                        : 4 * i < 3 * n ? std::sin(pi * (n - 2 * i) / (2 * n))
                                        : -std::cos(pi * (n - i) / n);
  return c;
}

Real sine_of(int i, int n) {
  const int j = std::min(i, n - i);
  return 4 * j <= n ? std::sin(pi * j / n) : std::cos(pi * (n - 2 * j) / (2 * n));
}

// Weights of theta_i = pi i / n, i = 0 ... n: c_i / n (1 - sum_k b_k cos(2 k theta_i) / (4 k^2 - 1)).
void clenshaw_curtis(SphereGrid& grid) {
  const int n = grid.rings - 1;
  const std::vector<Real> c = cosines(n);
  for (int i = 0; i <= n; ++i) set_ring(grid, i, c[std::size_t(i)], sine_of(i, n));
  parallel_for(0, std::size_t(n / 2 + 1), [&](std::size_t i, unsigned) {
    Real sum = 0;
    std::size_t at = 0; // 2 k i modulo 2 n, folded
    for (int k = n / 2; k >= 1; --k) {
      at = std::size_t(2) * std::size_t(k) * i % std::size_t(2 * n);
      if (at > std::size_t(n)) at = std::size_t(2 * n) - at;
      sum += (2 * k == n ? 1 : 2) * c[at] / (4 * Real(k) * Real(k) - 1);
    }
    const Real weight = (i == 0 ? 1 : 2) * (1 - sum) / n;
    grid.weights[i] = grid.weights[std::size_t(n) - i] = double(weight);
  });
}

// Weights of theta_i = pi i / n, i = 0 ... n-1, n even: 4/n sin(theta_i) sum_{k < n/2} sin((2k+1) theta_i) / (2k+1).
void driscoll_healy(SphereGrid& grid) {
  const int n = grid.rings;
  const std::vector<Real> c = cosines(n);
  std::vector<Real> s(std::size_t(2 * n));
  for (int i = 0; i < 2 * n; ++i) s[std::size_t(i)] = i <= n ? sine_of(i, n) : -sine_of(i - n, n);
  for (int i = 0; i < n; ++i) set_ring(grid, i, c[std::size_t(i)], s[std::size_t(i)]);
  parallel_for(0, std::size_t(n / 2 + 1), [&](std::size_t i, unsigned) {
    Real sum = 0;
    for (int k = n / 2 - 1; k >= 0; --k) sum += s[std::size_t(2 * k + 1) * i % std::size_t(2 * n)] / Real(2 * k + 1);
    const double weight = double(4 * s[i] * sum / n);
    grid.weights[i] = weight;
    if (i > 0) grid.weights[std::size_t(n) - i] = weight;
  });
}

// Weights of theta_i = pi (i + 1/2) / n, i = 0 ... n-1: 2/n (1 - 2 sum_k cos(2 k theta_i) / (4 k^2 - 1)), k = 1 ... n/2; they
// integrate polynomials in cos theta of degree n - 1, and are symmetric.
void fejer(SphereGrid& grid) {
  const int n = grid.rings;
  const std::vector<Real> c = cosines(2 * n); // cosines of pi i / 2n
  for (int i = 0; i < n; ++i) set_ring(grid, i, c[std::size_t(2 * i + 1)], sine_of(2 * i + 1, 2 * n));
  const auto period = std::size_t(4) * std::size_t(n);
  parallel_for(0, std::size_t((n + 1) / 2), [&](std::size_t i, unsigned) {
    Real sum = 0;
    for (int k = n / 2; k >= 1; --k) {
      std::size_t at =
          std::size_t(2) * std::size_t(k) * (2 * i + 1) % period; // 2 k theta_i in steps of pi / 2n, folded
      if (at > period / 2) at = period - at;
      sum += 2 * c[at] / (4 * Real(k) * Real(k) - 1);
    }
    grid.weights[i] = grid.weights[std::size_t(n) - 1 - i] = double(2 * (1 - sum) / n);
  });
}

SphereGrid filled(GridKind kind, int lmax, int rings, int ring_length) {
  SphereGrid grid;
  grid.kind = kind;
  grid.lmax = lmax;
  grid.rings = rings;
  grid.ring_length = ring_length;
  const auto n = std::size_t(rings);
  grid.cosine.resize(n);
  grid.sine.resize(n);
  grid.theta.resize(n);
  grid.weights.resize(n);
  switch (kind) {
  case GridKind::gauss_legendre: gauss_legendre(grid); break;
  case GridKind::clenshaw_curtis: clenshaw_curtis(grid); break;
  case GridKind::driscoll_healy:
  case GridKind::driscoll_healy_square: driscoll_healy(grid); break;
  case GridKind::fejer:
    fejer(grid);
    grid.shift = 0.5;
    break;
  }
  return grid;
}

} // namespace

std::string_view name(GridKind kind) {
  switch (kind) {
  case GridKind::gauss_legendre: return "gl";
  case GridKind::clenshaw_curtis: return "cc";
  case GridKind::driscoll_healy: return "dh";
  case GridKind::driscoll_healy_square: return "dh1";
  case GridKind::fejer: return "f1";
  }
  return "unknown";
}

double SphereGrid::phi(int j) const {
  return double(2 * pi * (j + Real(shift)) / ring_length);
}
double SphereGrid::latitude_degrees(int i) const {
  const auto at = std::size_t(i);
  return double(std::atan2(cosine[at], sine[at]) * 180 / pi);
}
double SphereGrid::longitude_degrees(int j) const {
  return double(360.0L * (j + Real(shift)) / ring_length);
}

SphereGrid make_grid(GridKind kind, int lmax) {
  if (lmax < 0 || lmax > largest_grid_degree)
    throw Error(Fault::bad_argument, fmt::format("a grid of degree {} cannot be made: degrees 0 to {} are possible",
                                                 lmax, largest_grid_degree));
  const int longitudes = smooth_at_least(2 * lmax + 1);
  switch (kind) {
  case GridKind::gauss_legendre: return filled(kind, lmax, lmax + 1, longitudes);
  case GridKind::clenshaw_curtis: return filled(kind, lmax, std::max(2, 2 * lmax + 1), longitudes);
  case GridKind::driscoll_healy: return filled(kind, lmax, 2 * lmax + 2, 4 * lmax + 4);
  case GridKind::driscoll_healy_square: return filled(kind, lmax, 2 * lmax + 2, 2 * lmax + 2);
  case GridKind::fejer: return filled(kind, lmax, 2 * lmax + 2, 4 * lmax + 4);
  }
  throw Error(Fault::bad_argument, "the grid is of no known kind");
}

SphereGrid make_grid(GridKind kind, int rings, int ring_length) {
  const auto refuse = [&](const char* why) {
    throw Error(Fault::bad_argument,
                fmt::format("no {} grid has {} rings of {} points: {}", name(kind), rings, ring_length, why));
  };
  if (rings < 1 || ring_length < 1) refuse("both must be positive");
  if (rings > 2 * largest_grid_degree + 2 || ring_length > 8 * largest_grid_degree)
    refuse("that is beyond this program");
  const int by_ring = (ring_length - 1) / 2;
  int lmax = 0;
  switch (kind) {
  case GridKind::gauss_legendre: lmax = std::min(rings - 1, by_ring); break;
  case GridKind::clenshaw_curtis:
    if (rings < 2) refuse("it has both poles");
    lmax = std::min((rings - 1) / 2, by_ring);
    break;
  case GridKind::fejer: lmax = std::min((rings - 1) / 2, by_ring); break;
  case GridKind::driscoll_healy:
  case GridKind::driscoll_healy_square: {
    const int per_ring = kind == GridKind::driscoll_healy ? 2 * rings : rings;
    if (rings % 2) refuse("the number of rings is even");
    if (ring_length != per_ring)
      refuse(kind == GridKind::driscoll_healy ? "a ring has twice as many points as there are rings"
                                              : "a ring has as many points as there are rings");
    lmax = std::min(rings / 2 - 1, by_ring);
    break;
  }
  }
  return filled(kind, std::min(lmax, largest_grid_degree), rings, ring_length);
}

} // namespace cowgpu

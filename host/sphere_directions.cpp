#include "host/sphere_directions.hpp"

#include <cmath>
#include <numbers>

namespace cowgpu {
namespace {

// cos(2 pi j / n) of 8 j <= n, or by the symmetries of the circle, so that equal values are equal bits.
double cosine_of_turn(long long j, long long n) {
  constexpr long double pi = std::numbers::pi_v<long double>;
  j = std::min(j, n - j);                                  // cos is even
  if (4 * j > n) return -cosine_of_turn(n - 2 * j, 2 * n); // cos(pi - x) = -cos x
  if (8 * j <= n) return double(std::cos(2 * pi * (long double)j / (long double)n));
  return double(std::sin(2 * pi * (long double)(n - 4 * j) / (long double)(4 * n)));
}

} // namespace

SphereDirections::SphereDirections(const SphereGrid& grid)
    : sine(grid.sine.begin(), grid.sine.end()), cosine(grid.cosine.begin(), grid.cosine.end()) {
  const long long n = grid.ring_length;
  cosine_phi.reserve(std::size_t(n));
  sine_phi.reserve(std::size_t(n));
  for (long long j = 0; j < n && grid.shift != 0; ++j) {
    if (grid.shift == 0.5) {
      cosine_phi.push_back(cosine_of_turn(2 * j + 1, 2 * n));
      sine_phi.push_back(cosine_of_turn((8 * j + 4 + 6 * n) % (8 * n), 8 * n));
    } else {
      const long double phi = 2 * std::numbers::pi_v<long double> * (j + (long double)grid.shift) / n;
      cosine_phi.push_back(double(std::cos(phi)));
      sine_phi.push_back(double(std::sin(phi)));
    }
  }
  for (long long j = 0; j < n && grid.shift == 0; ++j) {
    cosine_phi.push_back(cosine_of_turn(j, n));
    // sin x = cos(x - 90 degrees)
    sine_phi.push_back(cosine_of_turn((4 * j + 3 * n) % (4 * n), 4 * n));
  }
}

} // namespace cowgpu

#include "host/cpu/ring_fourier.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

using namespace cowgpu::cpu;

namespace {

constexpr std::size_t pairs = pairs_of_block;
constexpr int lengths[] = {1,  2,  3,  4,   5,   6,   7,   8,   9,   13,  15,   16,   21,  32,
                           49, 60, 64, 101, 121, 128, 202, 256, 404, 625, 1024, 1125, 2048};
// Errors are relative to the norm of a ring and grow with the square root of its length at most, in double's roundings.
// Measured: 0.9 for all these lengths.
constexpr double tolerance = 4 * 0x1p-53;

using Extended = std::complex<long double>;

Extended turn(std::size_t j, std::size_t n) {
  const long double angle = 2 * std::numbers::pi_v<long double> * (long double)(j % n) / (long double)(n);
  return {std::cos(angle), std::sin(angle)};
}

std::vector<double> random_values(std::size_t count, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> values(count);
  for (double& v : values) v = uniform(generator);
  return values;
}

hwy::AlignedFreeUniquePtr<double[]> aligned(const std::vector<double>& values) {
  auto copy = hwy::AllocateAligned<double>(values.size());
  std::copy(values.begin(), values.end(), copy.get());
  return copy;
}

// Largest order that a ring of so many points takes.
int largest_order(int length) {
  return (length - 1) / 2;
}

// Eight pairs of rings of which some are not there: no southern ring in pair 5, none at all in pair 7.
bool has_north(std::size_t pair) {
  return pair != 7;
}
bool has_south(std::size_t pair) {
  return pair != 5 && pair != 7;
}

} // namespace

TEST_CASE("rings of any length have the Fourier coefficients of plain sums", "[ring_fourier]") {
  constexpr std::size_t stride = 40;
  double worst = 0;
  for (const int length : lengths) {
    const std::size_t n = std::size_t(length);
    const auto values = random_values(2 * pairs * n, unsigned(length));
    RingBlock block;
    for (std::size_t i = 0; i < pairs; ++i) {
      block.north[i] = has_north(i) ? &values[i * n] : nullptr;
      block.south[i] = has_south(i) ? &values[(pairs + i) * n] : nullptr;
      block.weight[i] = 1 + 0.25 * double(i);
      block.x[i] = 1 - 0.1 * double(i);
    }
    const RingFourier fourier(length);
    RingWork work(fourier);
    for (const int lmax : {largest_order(length), largest_order(length) / 3}) {
      const auto orders = std::size_t(lmax) + 1;
      auto cells = aligned(std::vector<double>(orders * stride, std::nan("")));
      rings_to_orders(fourier, block, lmax, cells.get(), stride, work);
      for (std::size_t m = 0; m < orders; m += std::max<std::size_t>(1, orders / 37))
        for (std::size_t i = 0; i < pairs; ++i) {
          Extended north = 0, south = 0;
          long double norm = 0;
          for (std::size_t j = 0; j < n; ++j) {
            const Extended factor = std::conj(turn(m * j, n));
            const double f = has_north(i) ? block.north[i][j] : 0, g = has_south(i) ? block.south[i][j] : 0;
            north += (long double)(f)*factor;
            south += (long double)(g)*factor;
            norm += f * f + g * g;
          }
          const long double w = block.weight[i], wx = w * block.x[i];
          const Extended even = w * (north + south), odd = wx * (north - south);
          const double* cell = &cells[m * stride + i];
          const double scale = block.weight[i] * std::sqrt(double(norm) * double(n)) + 1e-300;
          for (const long double error :
               {cell[0] - even.real(), cell[8] - even.imag(), cell[16] - odd.real(), cell[24] - odd.imag()}) {
            INFO("length " << length << ", order " << m << ", pair " << i);
            CHECK(std::fabs(double(error)) <= tolerance * scale);
            worst = std::max(worst, std::fabs(double(error)) / scale);
          }
        }
    }
  }
  INFO("worst in roundings: " << worst * 0x1p53);
  CHECK(worst > 0);
}

TEST_CASE("rings of any length are the Fourier sums of their coefficients", "[ring_fourier]") {
  constexpr std::size_t stride = 40;
  double worst = 0;
  for (const int length : lengths) {
    const std::size_t n = std::size_t(length);
    const RingFourier fourier(length);
    RingWork work(fourier);
    for (const int lmax : {largest_order(length), largest_order(length) / 3}) {
      const auto orders = std::size_t(lmax) + 1;
      const auto cells = aligned(random_values(orders * stride, unsigned(length + lmax)));
      std::vector<double> values(2 * pairs * n, 12345.0);
      RingTargets block;
      for (std::size_t i = 0; i < pairs; ++i) {
        block.north[i] = has_north(i) ? &values[i * n] : nullptr;
        block.south[i] = has_south(i) ? &values[(pairs + i) * n] : nullptr;
        block.weight[i] = 1 + 0.25 * double(i);
      }
      orders_to_rings(fourier, block, lmax, cells.get(), stride, work);
      for (std::size_t i = 0; i < pairs; ++i) {
        std::vector<Extended> north(orders), south(orders);
        long double norm = 0;
        for (std::size_t m = 0; m < orders; ++m) {
          const double* cell = &cells[m * stride + i];
          // The imaginary part of order 0 does not count.
          const Extended even(cell[0], m == 0 ? 0 : cell[8]), odd(cell[16], m == 0 ? 0 : cell[24]);
          const long double times = m == 0 ? 1 : 2;
          north[m] = times * (even + odd);
          south[m] = times * (even - odd);
          norm += std::norm(north[m]) + std::norm(south[m]);
        }
        const double scale = block.weight[i] * std::sqrt(double(norm) * double(n));
        for (std::size_t j = 0; j < n; j += std::max<std::size_t>(1, n / 37)) {
          Extended sum_north = 0, sum_south = 0;
          for (std::size_t m = 0; m < orders; ++m) {
            sum_north += north[m] * turn(m * j, n);
            sum_south += south[m] * turn(m * j, n);
          }
          INFO("length " << length << ", point " << j << ", pair " << i);
          const auto check = [&](bool there, double value, const Extended& sum) {
            if (!there) {
              CHECK(value == 12345.0); // rings that are not there are not written
              return;
            }
            const double error = std::fabs(double(value - (long double)(block.weight[i]) * sum.real()));
            CHECK(error <= tolerance * scale);
            worst = std::max(worst, error / scale);
          };
          check(has_north(i), values[i * n + j], sum_north);
          check(has_south(i), values[(pairs + i) * n + j], sum_south);
        }
      }
    }
  }
  INFO("worst in roundings: " << worst * 0x1p53);
  CHECK(worst > 0);
}

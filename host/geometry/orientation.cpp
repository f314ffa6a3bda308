#include "host/geometry/orientation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace cowgpu {

namespace {

// A double as an integer of at most 53 bits times 2^exponent.
struct Scaled {
  std::int64_t integer;
  int exponent;
};

Scaled scaled(double x) {
  int exponent = 0;
  const double fraction = std::frexp(x, &exponent);
  return {std::int64_t(std::ldexp(fraction, 53)), exponent - 53};
}

// A product of three doubles: sign * (digits in base 2^32, least first) * 2^exponent. 159 bits.
struct Product {
  int sign = 0, exponent = 0;
  std::array<std::uint32_t, 5> digits{};
};

Product product(const Scaled& x, const Scaled& y, const Scaled& z, int sign) {
  Product p;
  if (x.integer == 0 || y.integer == 0 || z.integer == 0) return p;
  p.sign = ((x.integer < 0) != (y.integer < 0)) != (z.integer < 0) ? -sign : sign;
  p.exponent = x.exponent + y.exponent + z.exponent;
  const auto magnitude = [](const Scaled& s) { return std::uint64_t(s.integer < 0 ? -s.integer : s.integer); };
  __extension__ using Wide = unsigned __int128;
  const Wide xy = Wide(magnitude(x)) * magnitude(y); // 106 bits
  const Wide low = Wide(std::uint64_t(xy)) * magnitude(z);
  const Wide high = Wide(std::uint64_t(xy >> 64)) * magnitude(z) + (low >> 64);
  p.digits = {std::uint32_t(low), std::uint32_t(low >> 32), std::uint32_t(high), std::uint32_t(high >> 32),
              std::uint32_t(high >> 64)};
  return p;
}

// The sign of a sum of at most 24 products.
int sign_of_sum(std::span<const Product> products) {
  int lowest = std::numeric_limits<int>::max(), highest = std::numeric_limits<int>::min();
  for (const Product& p : products)
    if (p.sign != 0) lowest = std::min(lowest, p.exponent), highest = std::max(highest, p.exponent);
  if (lowest > highest) return 0;

  // Digit d of the sum has the weight 2^(lowest + 32 d). A digit gathers at most 48 terms below 2^32.
  std::vector<std::int64_t> sum(std::size_t(highest - lowest) / 32 + 7, 0);
  for (const Product& p : products) {
    if (p.sign == 0) continue;
    const auto shift = unsigned(p.exponent - lowest);
    for (std::size_t d = 0; d < p.digits.size(); ++d) {
      const std::uint64_t term = std::uint64_t(p.digits[d]) << (shift % 32);
      sum[shift / 32 + d] += p.sign * std::int64_t(term & 0xffffffffu);
      sum[shift / 32 + d + 1] += p.sign * std::int64_t(term >> 32);
    }
  }
  // Carries leave every digit but the last in [0, 2^32), so the last one that is not zero has the sum's sign.
  for (std::size_t d = 0; d + 1 < sum.size(); ++d) {
    sum[d + 1] += sum[d] >> 32;
    sum[d] &= 0xffffffff;
  }
  if (sum.back() < 0) return -1;
  return std::any_of(sum.begin(), sum.end(), [](std::int64_t digit) { return digit != 0; }) ? 1 : 0;
}

// The six products of sign * det(a, b, c).
void add_determinant(const Vec3& a, const Vec3& b, const Vec3& c, int sign, Product* products) {
  Scaled x[3], y[3], z[3];
  for (int i = 0; i < 3; ++i) x[i] = scaled(a[i]), y[i] = scaled(b[i]), z[i] = scaled(c[i]);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    products[2 * i] = product(x[i], y[j], z[k], sign);
    products[2 * i + 1] = product(x[i], y[k], z[j], -sign);
  }
}

// The sign of the doubled area of the triangle (a, b, p) seen from above, p moved by an infinitesimal along x and by its
// square along y: 0 only where a and b lie above each other.
int perturbed_side(const Vec3& a, const Vec3& b, const Vec3& p) {
  const int side = orientation_along(2, a, b, p);
  if (side != 0) return side;
  if (a.y() != b.y()) return a.y() > b.y() ? 1 : -1;
  return (b.x() > a.x()) - (b.x() < a.x());
}

} // namespace

int orientation_exact(const Vec3& a, const Vec3& b, const Vec3& c) {
  Product products[6];
  add_determinant(a, b, c, 1, products);
  return sign_of_sum(products);
}

int orientation(const Vec3& a, const Vec3& b, const Vec3& c) {
  double determinant = 0, permanent = 0, size = 1;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double p = b[j] * c[k], q = b[k] * c[j];
    determinant += a[i] * (p - q);
    permanent += std::abs(a[i]) * (std::abs(p) + std::abs(q));
    size += std::abs(a[i]);
  }
  // At most five roundings of 2^-53 reach a term, and as many its part of the permanent; underflow adds at most 2^-1074
  // to a product, times |a|. What overflows compares false.
  const double bound = 0x1p-50 * permanent + 0x1p-1060 * size;
  if (determinant > bound) return 1;
  if (-determinant > bound) return -1;
  return orientation_exact(a, b, c);
}

int side_of_plane_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  // Along the column of ones of the determinant of (a, 1), (b, 1), (c, 1), (p, 1).
  Product products[24];
  add_determinant(a, b, c, 1, products);
  add_determinant(p, b, c, -1, products + 6);
  add_determinant(p, c, a, -1, products + 12);
  add_determinant(p, a, b, -1, products + 18);
  return sign_of_sum(products);
}

int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 x = a - p, y = b - p, z = c - p;
  double determinant = 0, permanent = 0, size = 1;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double u = y[j] * z[k], v = y[k] * z[j];
    determinant += x[i] * (u - v);
    permanent += std::abs(x[i]) * (std::abs(u) + std::abs(v));
    size += std::abs(x[i]);
  }
  // As in orientation(), and three more roundings of a term: those of its differences.
  const double bound = 0x1p-49 * permanent + 0x1p-1060 * size;
  if (determinant > bound) return 1;
  if (-determinant > bound) return -1;
  return side_of_plane_exact(a, b, c, p);
}

int orientation_along(int axis, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  return orientation(Vec3(a[i], a[j], 1), Vec3(b[i], b[j], 1), Vec3(c[i], c[j], 1));
}

int vertical_crossing(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, bool up) {
  const int side = perturbed_side(a, b, p);
  if (side == 0 || perturbed_side(b, c, p) != side || perturbed_side(c, a, p) != side) return 0;
  // The face looks up if side is 1; it is above p if p is on the other side of it.
  return side_of_plane(a, b, c, p) == (up ? side : -side) ? (up ? side : -side) : 0;
}

} // namespace cowgpu

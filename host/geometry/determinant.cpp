#include "host/geometry/determinant.hpp"

#include <cmath>

namespace cowgpu {
namespace {

constexpr long double lost_bits = 0x1p-6L;

long double square(const Vec3& p, const Vec3& q) {
  long double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const long double d = static_cast<long double>(p[k]) - q[k];
    sum += d * d;
  }
  return sum;
}

} // namespace

long double determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& o) {
  const auto det = determinant_in<long double>(a, b, c, o);
  if (det * det >= lost_bits * lost_bits * square(a, o) * square(b, a) * square(c, a)) return det;
  return static_cast<long double>(determinant_in<Quad>(a, b, c, o));
}

long double sum_of_determinants(std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& o) {
  long double sum = 0, sizes = 0;
  for (const Face& f : faces) {
    const long double det = determinant(vertices[f[0]], vertices[f[1]], vertices[f[2]], o);
    sum += det;
    sizes += std::abs(det);
  }
  if (!(std::abs(sum) < lost_bits * sizes)) return sum;
  Quad exact = 0;
  for (const Face& f : faces) exact += determinant_in<Quad>(vertices[f[0]], vertices[f[1]], vertices[f[2]], o);
  return static_cast<long double>(exact);
}

} // namespace cowgpu

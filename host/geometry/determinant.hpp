// Determinants of three corners, exact enough where their terms cancel.
#pragma once

#include "host/types.hpp"

#include <limits>
#include <span>

namespace cowgpu {

/// Of at least 106 bits: the compiler's 113-bit type where long double has fewer.
#if __LDBL_MANT_DIG__ >= 106
using Quad = long double;
#else
__extension__ using Quad = __float128;
#endif

/// det(a - o, b - o, c - o) = (a - o) . (b - a) x (c - a) in `Real`, six times the signed volume of the tetrahedron
/// (o, a, b, c). Its error is a few units in the last place of |a - o| |b - a| |c - a|.
template <class Real>
Real determinant_in(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& o) {
  const Real x = Real(a[0]) - Real(o[0]), y = Real(a[1]) - Real(o[1]), z = Real(a[2]) - Real(o[2]);
  const Real ux = Real(b[0]) - Real(a[0]), uy = Real(b[1]) - Real(a[1]), uz = Real(b[2]) - Real(a[2]);
  const Real vx = Real(c[0]) - Real(a[0]), vy = Real(c[1]) - Real(a[1]), vz = Real(c[2]) - Real(a[2]);
  return x * (uy * vz - uz * vy) + y * (uz * vx - ux * vz) + z * (ux * vy - uy * vx);
}

/// The same to a relative error of 2^-57 where |det| > 2^-54 |a - o| |b - a| |c - a|, and of 2^-110 of that product below:
/// in long double, and again in Quad where that has lost more than six bits. Bodies that are thin beside the distance of
/// their corners from o have such triangles. Coordinates must be finite.
long double determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& o);

/// The sum of determinant() over the faces to a relative error of 2^-56, or of 2^-100 of the sum of their sizes where they
/// cancel by more than 2^44: in Quad where they cancel by more than 2^6. NaN for coordinates that are not finite.
long double sum_of_determinants(std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& o);

} // namespace cowgpu

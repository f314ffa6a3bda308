// The exact gravity of polyhedra of uniform density, inside and outside.
#pragma once

#include "host/mesh/body.hpp"
#include "host/monitor.hpp"
#include "host/potential.hpp"
#include "host/reference/polyhedron.hpp"
#include "host/types.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::physics {

using LongVec3 = Eigen::Matrix<long double, 3, 1>;
using LongMatrix3 = Eigen::Matrix<long double, 3, 3>;

using PolyhedronAt = reference::PolyhedronAt<long double>;
/// Of V, of its gradient (a norm) and of its second derivatives.
using FieldError = reference::FieldError<long double>;
/// In 80-bit arithmetic, since its sums cancel like (distance/size)^2.
using Polyhedron = reference::Polyhedron<long double>;

/// A body's field at many points.
struct ExactField {
  PotentialField field;        ///< V = integral of density/|x - p| and what else was asked for
  std::vector<double> density; ///< that the body has at each point: -(trace of dd V)/4 pi; on a face the mean
  /// 1 where the series of FarField has the smaller error, and was taken: far away, and beside very thin bodies.
  std::vector<std::uint8_t> by_series;
  /// Largest estimated error, of V by |V| and of the gradient by the larger of its norm and |V| over the distance from the
  /// body's middle; at least the rounding of the doubles it is given in.
  double error = 0;
};

/// At points in mesh coordinates, the body's parts added with their densities, on `threads` threads (0: all); each point by
/// the closed form or by the series, whichever is estimated to be nearer to the truth. What is smaller than doubles hold is
/// 0. Throws Error(point_singular) where second derivatives are asked for on an edge, bad_argument for points that are not finite,
/// interrupted.
ExactField exact_field(const Body& body, std::span<const Vec3> points, Derivatives derivatives, unsigned threads,
                       Monitor& monitor);

/// Upper bound of the bytes exact_field() allocates, its result included.
std::uint64_t exact_field_bytes(const Body& body, std::uint64_t points, unsigned threads);

} // namespace cowgpu::physics

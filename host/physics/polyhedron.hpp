// The closed form of polyhedra in 80-bit arithmetic, as the physics takes it.
#pragma once

#include "host/reference/polyhedron.hpp"

#include <Eigen/Core>

namespace cowgpu::physics {

using LongVec3 = Eigen::Matrix<long double, 3, 1>;
using LongMatrix3 = Eigen::Matrix<long double, 3, 3>;

using PolyhedronAt = reference::PolyhedronAt<long double>;
/// Of V, of its gradient (a norm) and of its second derivatives.
using FieldError = reference::FieldError<long double>;
/// In 80-bit arithmetic, since its sums cancel like (distance/size)^2.
using Polyhedron = reference::Polyhedron<long double>;

} // namespace cowgpu::physics

// Sums of solid harmonics at points, lanes are points.
#pragma once

#include "host/plan/solid_harmonics.hpp"

#include <cstddef>

namespace cowgpu::plan {

/// sums[s][count] = sum over harmonics h of coefficients[h][sets] R_h(x), x = points[3][count]; `sets` 4, 5 or 10, `count` a
/// multiple of 8, points aligned to 64 bytes.
void sum_harmonics(int order, std::size_t sets, const double* coefficients, const double* points, std::size_t count,
                   double* sums);

} // namespace cowgpu::plan

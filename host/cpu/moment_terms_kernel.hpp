// The SIMD kernel of moment_terms(), compiled once per instruction set.
#pragma once

#include <cstddef>

namespace cowgpu::cpu {

/// Doubles of a row's column: real and imaginary part of v, e and q (host/reference/moments.hpp), `lanes` of each.
std::size_t term_column_doubles();
/// Triangles worked on together: 8, 4, 2 or 1.
std::size_t term_lanes();

/// Orders that are worked on together; rows are padded to a multiple of them.
inline constexpr int term_orders = 4;

/// One degree's factors of the gradient, of each order; zero for orders above the degree.
struct TermFactors {
  const double *same, *above, *below;
};

/// Takes one block of triangles from degree l-1 to l >= 1: `corners` holds x, y, z of A, B, C over l, lanes of each; `rows`
/// the columns m = 0 ... l + term_orders, zero beyond l-1. Adds the lanes' q, real and imaginary part, to `sums`, and returns
/// the sum over lanes and all orders, negative ones too, of |q|^2.
double raise_terms(int l, const TermFactors& factors, const double* corners, double* rows, double* sums);

} // namespace cowgpu::cpu

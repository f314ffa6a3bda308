#include "host/coefficients.hpp"

#include <cmath>

namespace cowgpu {

double degree_norm(const Coefficients& coefficients, int l) {
  double sum = 0;
  for (int m = 0; m <= l; ++m) sum += (m == 0 ? 1 : 2) * std::norm(coefficients(l, m));
  return std::sqrt(sum);
}

} // namespace cowgpu

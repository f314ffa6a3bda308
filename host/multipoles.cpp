#include "host/multipoles.hpp"

#include <cmath>

namespace cowgpu {

double degree_norm(const Multipoles& moments, int l) {
  double sum = 0;
  for (int m = 0; m <= l; ++m) sum += (m == 0 ? 1 : 2) * std::norm(moments(l, m));
  return std::sqrt(sum);
}

std::vector<double> degree_norms(const Multipoles& moments) {
  std::vector<double> norms;
  for (int l = 0; l <= moments.lmax; ++l) norms.push_back(degree_norm(moments, l));
  return norms;
}

} // namespace cowgpu

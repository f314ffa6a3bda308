#include "tests/support/libsharp.hpp"

#include <libsharp/sharp.h>
#include <libsharp/sharp_almhelpers.h>

#include <cstddef>
#include <numbers>
#include <vector>

namespace cowgpu::support {

struct Libsharp::Handles {
  sharp_geom_info* rings = nullptr;
  sharp_alm_info* orders = nullptr;
};

Libsharp::Libsharp(const SphereGrid& grid, int lmax) : handles_(std::make_unique<Handles>()) {
  const auto n = std::size_t(grid.rings);
  std::vector<int> length(n, grid.ring_length), stride(n, 1);
  std::vector<std::ptrdiff_t> offset(n);
  std::vector<double> phi(n, 0.0), weight(n);
  for (std::size_t i = 0; i < n; ++i) {
    offset[i] = std::ptrdiff_t(i) * grid.ring_length;
    weight[i] = grid.weights[i] * 2 * std::numbers::pi / grid.ring_length;
  }
  sharp_make_geom_info(grid.rings, length.data(), offset.data(), stride.data(), phi.data(), grid.theta.data(),
                       weight.data(), &handles_->rings);
  sharp_make_triangular_alm_info(lmax, lmax, 1, &handles_->orders);
}

Libsharp::~Libsharp() {
  sharp_destroy_geom_info(handles_->rings);
  sharp_destroy_alm_info(handles_->orders);
}

// libsharp takes what it only reads by pointers to non-const.
void Libsharp::synthesise(const std::complex<double>* coefficients, double* values) const {
  void* alm = const_cast<std::complex<double>*>(coefficients);
  void* map = values;
  sharp_execute(SHARP_Y, 0, &alm, &map, handles_->rings, handles_->orders, SHARP_DP, nullptr, nullptr);
}

void Libsharp::analyse(const double* values, std::complex<double>* coefficients) const {
  void* alm = coefficients;
  void* map = const_cast<double*>(values);
  sharp_execute(SHARP_YtW, 0, &alm, &map, handles_->rings, handles_->orders, SHARP_DP, nullptr, nullptr);
}

} // namespace cowgpu::support

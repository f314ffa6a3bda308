// libsharp's transforms (M. Reinecke and D. S. Seljebotn, Astron. Astrophys. 554 (2013) A112), for comparison. It is
// under the GPL: tests and benchmarks alone use it.
#pragma once

#include "host/sphere_grid.hpp"

#include <complex>
#include <memory>

namespace cowgpu::support {

/// One real field at a time on a grid, in the layouts of SphereTransform; on all threads of OpenMP.
class Libsharp {
public:
  Libsharp(const SphereGrid& grid, int lmax);
  ~Libsharp();
  Libsharp(const Libsharp&) = delete;
  Libsharp& operator=(const Libsharp&) = delete;

  void synthesise(const std::complex<double>* coefficients, double* values) const;
  void analyse(const double* values, std::complex<double>* coefficients) const;

private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

} // namespace cowgpu::support

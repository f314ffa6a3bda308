#include "host/cpu/sphere_transform.hpp"

#include "host/reference/sphere_transform.hpp"

#include <utility>

namespace cowgpu::cpu {
namespace {

class Transform final : public SphereTransform {
public:
  Transform(const SphereGrid& grid, int lmax) : SphereTransform(grid, lmax) {}

private:
  void to_grid(int fields, std::span<const std::complex<double>> coefficients, std::span<double> values,
               RingFactor factor, Monitor&, TransformReport&) override {
    const std::size_t count = SphereCoefficients::count(lmax()), points = grid().points();
    for (std::size_t f = 0; f < std::size_t(fields); ++f) {
      std::vector<reference::Pair<double>> a(count);
      for (std::size_t i = 0; i < count; ++i)
        a[i] = {coefficients[f * count + i].real(), coefficients[f * count + i].imag()};
      const auto v = reference::synthesise<double>(grid(), lmax(), a, factor == RingFactor::weight);
      std::copy(v.begin(), v.end(), values.begin() + std::ptrdiff_t(f * points));
    }
  }
  void from_grid(int fields, std::span<const double> values, std::span<std::complex<double>> coefficients,
                 RingFactor factor, Monitor&, TransformReport&) override {
    const std::size_t count = SphereCoefficients::count(lmax()), points = grid().points();
    for (std::size_t f = 0; f < std::size_t(fields); ++f) {
      const auto a =
          reference::analyse<double>(grid(), lmax(), values.subspan(f * points, points), factor == RingFactor::weight);
      for (std::size_t i = 0; i < count; ++i) coefficients[f * count + i] = {a[i].re, a[i].im};
    }
  }
};

} // namespace

std::unique_ptr<SphereTransform> sphere_transform(const SphereGrid& grid, int lmax, unsigned) {
  return std::make_unique<Transform>(grid, lmax);
}

MemoryNeed sphere_transform_memory(const SphereGrid&, int, int, unsigned) {
  return {};
}

} // namespace cowgpu::cpu

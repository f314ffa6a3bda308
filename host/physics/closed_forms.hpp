// The closed forms of a body's polyhedra, added with their densities: what BodyField sums by.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/body.hpp"
#include "host/monitor.hpp"
#include "host/physics/body_field.hpp"
#include "host/physics/polyhedron.hpp"
#include "host/run_report.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace cowgpu::physics {

/// A surface of a body with its density: all of them by body_surfaces().
struct DenseSurface {
  const ClosedSurface* surface;
  double density, volume;
};
std::vector<DenseSurface> body_surfaces(const Body& body);

class ClosedForms {
public:
  virtual ~ClosedForms() = default;

  /// Estimated absolute errors of the sums at points no farther than `reach` from each vertex, of rounding alone.
  virtual FieldError rounding(long double reach) const = 0;

  /// What the sums may leave out beside rounding, of V and of its gradient.
  virtual FieldError left_out() const { return {}; }

  /// Takes the sum at point i, and the bound of what is left out of its gradient, on a thread.
  using Put = std::function<void(std::size_t i, const PolyhedronAt& at, double bound, unsigned thread)>;

  /// At the points whose indices are `which`. Second derivatives are infinite where on_edge.
  virtual void at(std::span<const Vec3> points, std::span<const std::uint32_t> which, const Put& put, Monitor& monitor,
                  RunReport* report) const = 0;

  /// Upper bound of what at() allocates for so many points.
  virtual MemoryNeed memory(std::uint64_t points) const = 0;
};

/// In 80-bit arithmetic. Polyhedra are prepared when they are first asked for anything.
std::unique_ptr<const ClosedForms> extended_forms(const Body& body, unsigned threads);

/// By Backend::polyhedron. Throws Error(bad_argument) for a tolerance out of range.
std::unique_ptr<const ClosedForms> device_forms(const Body& body, const BodyFieldProblem& problem,
                                                const Backend& backend);

} // namespace cowgpu::physics

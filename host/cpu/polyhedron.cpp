#include "host/cpu/polyhedron.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/parallel.hpp"
#include "host/reference/polyhedron.hpp"

#include <algorithm>
#include <atomic>
#include <numbers>

namespace cowgpu::cpu {
namespace {

using Reference = reference::Polyhedron<long double>;

class CpuPolyhedron final : public PreparedPolyhedron {
public:
  CpuPolyhedron(const PolyhedronProblem& problem, unsigned threads) : problem_(problem), threads_(threads) {}

  MemoryNeed memory(std::uint64_t points) const override {
    return {problem_.vertices.size() * 48 * (2 + threads_) + problem_.faces.size() * 1800 + points * 96, 0};
  }

  PolyhedronValues at(std::span<const Vec3> points, Monitor& monitor, RunReport* report) const override {
    const auto start = Clock::now();
    for (const Vec3& p : points)
      if (!p.allFinite()) throw Error(Fault::bad_argument, "a point is not finite");
    const Reference polyhedron(problem_.vertices, problem_.faces);
    const std::size_t count = points.size();
    PolyhedronValues found;
    found.field.value.resize(count);
    found.winding.resize(count);
    if (problem_.derivatives != Derivatives::none) found.field.gradient.resize(count);
    if (problem_.derivatives == Derivatives::second) {
      found.field.hessian.resize(count);
      found.on_edge.resize(count);
    }
    if (problem_.guarantee) found.bound.resize(count);
    std::vector<Reference::Scratch> scratch(threads_);
    std::atomic<std::size_t> done = 0;
    parallel_for(threads_, count, [&](std::size_t i, unsigned thread) {
      check_stop(monitor);
      const auto at = polyhedron.at(points[i].cast<long double>(), scratch[thread]);
      found.field.value[i] = double(at.value);
      found.winding[i] = double(at.winding);
      if (problem_.derivatives != Derivatives::none) found.field.gradient[i] = at.gradient.cast<double>();
      if (problem_.derivatives == Derivatives::second) {
        const auto& h = at.hessian;
        found.field.hessian[i] = {double(h(0, 0)), double(h(0, 1)), double(h(0, 2)),
                                  double(h(1, 1)), double(h(1, 2)), double(h(2, 2))};
        found.on_edge[i] = at.on_edge ? 1 : 0;
      }
      const std::size_t now = ++done;
      if (thread == 0) monitor.progress("polyhedron", double(now) / double(count));
    });
    if (report) {
      *report = {};
      report->seconds = seconds_since(start);
      report->elements = report->full_elements = double(count) * double(problem_.faces.size());
    }
    return found;
  }

private:
  PolyhedronProblem problem_;
  unsigned threads_;
};

} // namespace

std::unique_ptr<PreparedPolyhedron> polyhedron(const PolyhedronProblem& problem, unsigned threads) {
  return std::make_unique<CpuPolyhedron>(problem, threads);
}

} // namespace cowgpu::cpu

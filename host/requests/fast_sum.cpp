#include "host/requests/fast_sum.hpp"

#include "host/plan/polyhedron_settings.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {

std::unique_ptr<Backend> fast_sum_backend(const Body& body, double tolerance, Derivatives derivatives,
                                          std::uint64_t points, const Backend& asked, unsigned threads) {
  if (tolerance == 0 || asked.facts().type == "cpu") return nullptr;
  const auto pays = [&](const ClosedSurface& surface) {
    PolyhedronProblem problem{surface.vertices(), surface.faces()};
    problem.derivatives = derivatives;
    problem.tolerance = tolerance;
    return plan::fast_sum_pays(problem, points);
  };
  const bool one = pays(body.surface) || std::any_of(body.parts.begin(), body.parts.end(),
                                                     [&](const Part& part) { return pays(part.surface); });
  return one ? make_cpu_backend(threads) : nullptr;
}

std::string fast_sum_note(const Backend& asked) {
  return fmt::format("faces far away are summed by their multipoles, which the CPU does, and not the device {}",
                     asked.facts().name);
}

} // namespace cowgpu

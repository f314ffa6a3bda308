#include "host/mass/mass_moments.hpp"

#include "host/mass/translate.hpp"

#include <optional>
#include <utility>

namespace cowgpu {

std::vector<MomentProblem> mass_problems(const Body& body, int lmax, double cut_off) {
  std::vector<MomentProblem> problems;
  const auto add = [&](const ClosedSurface& surface, double density) {
    MomentProblem problem;
    problem.vertices = surface.vertices();
    problem.faces = surface.faces();
    problem.origin = body.origin;
    problem.reference_radius = body.brillouin_radius;
    problem.density = density;
    problem.lmax = lmax;
    problem.cut_off = cut_off;
    problems.push_back(problem);
  };
  add(body.surface, body.density);
  for (const Part& part : body.parts) add(part.surface, part.density);
  return problems;
}

Multipoles mass_moments(std::span<const MomentProblem> problems, Backend& backend, Monitor& monitor, RunReport* report,
                        std::vector<std::vector<double>>* norms) {
  Multipoles sum;
  RunReport all;
  if (norms) norms->clear();
  for (const MomentProblem& problem : problems) {
    RunReport run;
    const std::optional<MomentProblem> near = near_problem(problem);
    Multipoles q = backend.moments(near ? *near : problem)->run(monitor, &run);
    if (norms) norms->push_back(degree_norms(q));
    if (near) q = translated(problem, *near, q);
    if (&problem == problems.data())
      sum = std::move(q);
    else
      for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += q.values[i];
    all.seconds += run.seconds;
    all.setup_seconds += run.setup_seconds;
    all.elements += run.elements;
    all.full_elements += run.full_elements;
    all.pairs += run.pairs;
    all.kernels.insert(all.kernels.end(), run.kernels.begin(), run.kernels.end());
  }
  if (report) *report = std::move(all);
  return sum;
}

} // namespace cowgpu

#include "host/requests/expand.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/mass/translate.hpp"
#include "host/plan/moments.hpp"
#include "host/report/document_parts.hpp"
#include "host/requests/limits.hpp"
#include "host/requests/memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace cowgpu {
namespace {

std::vector<MomentProblem> problems_of(const ExpandRequest& request, const Body& body) {
  return mass_problems(body, request.expansions.lmax, request.cut_off);
}

void check(const ExpandRequest& request) {
  check_expansions(request.expansions);
  require_range("the degree is", request.expansions.lmax, 0, largest_degree);
  require_range("the cut-off is", request.cut_off, 0.0, largest_cut_off);
  require_member("the check of the moments is", request.verify, Verify::full);
}

// The result, and either the computation or its check.
MemoryNeed memory_need(const ExpandRequest& request, std::span<const MomentProblem> problems, const Backend& backend) {
  const ExpansionChoice& choice = request.expansions;
  MemoryNeed need = surfaces_memory(choice, problems.front().vertices, problems.front().faces, backend);
  if (!choice.mass) return need;
  const std::uint64_t result = 16 * Multipoles::count(choice.lmax);
  if (need.host) need.host += result;
  for (const MomentProblem& problem : problems) { // one after the other, beside the sum of those before
    const MemoryNeed one = backend.moments(problem)->memory();
    const std::uint64_t before = &problem == problems.data() ? 0 : result;
    const std::uint64_t check = result + one.host + verify_bytes(problem, request.verify);
    need.host = std::max({need.host, one.host + before, check});
    need.device = std::max(need.device, one.device);
  }
  return need;
}

MemoryNeed affordable(const ExpandRequest& request, std::span<const MomentProblem> problems, const Backend& backend) {
  const MemoryNeed need = memory_need(request, problems, backend);
  check_memory(need, backend, "lower --lmax or take a mesh with fewer triangles");
  return need;
}

class Stopwatch {
public:
  double lap() {
    const double seconds = seconds_since(last_);
    last_ = Clock::now();
    return seconds;
  }

private:
  Clock::time_point last_ = Clock::now();
};

} // namespace

ExpansionChoice all_expansions(int lmax) {
  ExpansionChoice choice;
  choice.mass = true;
  choice.maps.assign(made_maps.begin(), made_maps.end());
  choice.lmax = lmax;
  return choice;
}

ExpandPlan plan_expand(const ExpandRequest& request, const Body& body, const Backend& backend) {
  check(request);
  const std::vector<MomentProblem> problems = problems_of(request, body);
  ExpandPlan all;
  all.memory = affordable(request, problems, backend);
  if (!request.expansions.mass) return all;
  for (const MomentProblem& problem : problems) {
    const plan::Moments plan = plan::moments(problem, int(backend.facts().subgroup));
    all.pairs += plan.pair_count;
    all.elements += plan.elements;
    all.full_elements += plan.full_elements;
  }
  return all;
}

std::uint64_t json_bytes(const ExpansionChoice& choice) {
  return (choice.mass ? json_bytes(choice.lmax) : 0) + choice.maps.size() * surface_json_bytes(choice.lmax);
}

ExpandResult expand(const ExpandRequest& request, Body body, Backend& backend, Monitor& monitor,
                    std::vector<std::string> notes) {
  check(request);
  const std::vector<MomentProblem> problems = problems_of(request, body);
  affordable(request, problems, backend);
  Stopwatch watch;
  Timings timings;
  RunReport run;
  Multipoles mass;
  Accuracy accuracy;
  std::vector<SurfaceResult> surfaces =
      expand_surfaces(request.expansions, request.estimate_aliasing, body, backend, monitor);
  timings.surfaces = watch.lap();
  if (request.expansions.mass) {
    std::vector<std::vector<double>> norms;
    mass = mass_moments(problems, backend, monitor, &run, &norms);
    if (std::any_of(problems.begin(), problems.end(),
                    [](const MomentProblem& p) { return near_problem(p).has_value(); }))
      notes.push_back("the origin is more than 16 radii away from the body or a part of it, whose moments are computed "
                      "about the middle of its box and moved to the origin");
    timings.moments = watch.lap();
    accuracy = verify_all(problems, mass, norms, backend, request.verify, request.seed, monitor);
    if (accuracy.how != Verify::none)
      accuracy.agreements.push_back(compare_with_tensors(body, mass, accuracy.estimate.error));
    timings.verify = watch.lap();
  }
  const Tensors second = tensors(body);
  ExpandResult result{{},
                      utc_now(),
                      std::move(body),
                      backend.facts(),
                      request.cut_off,
                      std::move(mass),
                      second,
                      std::move(run),
                      timings,
                      std::move(accuracy),
                      std::move(notes),
                      request.expansions.mass,
                      std::move(surfaces)};
  return result;
}

void require_sound(const ExpandResult& result) {
  check_surfaces(result.surfaces);
  if (result.accuracy.how == Verify::none || result.accuracy.passed()) return;
  const Agreement& worst = *result.accuracy.worst();
  throw Error(
      Fault::check_failed,
      fmt::format("{} against {} is off by {:.1e} times what rounding explains (degree {}; {:.0f} are allowed): do not "
                  "trust these numbers; try --device cpu and `cowgpu validate`",
                  worst.path, worst.against, worst.errors.ratio, worst.errors.degree, Accuracy::bound));
}

} // namespace cowgpu

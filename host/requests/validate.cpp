#include "host/requests/validate.hpp"

#include "host/mass/translate.hpp"
#include "host/mass/verify.hpp"
#include "host/moment_terms.hpp"
#include "host/plan/moments.hpp"
#include "host/reference/moments.hpp"
#include "host/requests/limits.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace cowgpu {
namespace {

// Far below what an extended-precision sum can resolve.
constexpr double reference_tolerance = 1e-22;

Check against(const std::string& what, const DegreeErrors& errors, std::span<const double> estimate, double bound) {
  Check check = {what, errors.ratio, bound, errors.degree, errors.ratio <= bound}; // NaN fails
  for (std::size_t l = 0; l < estimate.size(); ++l)
    if (estimate[l] < errors.norm[l] / 2)
      check.relative = std::max(check.relative, errors.difference[l] / errors.norm[l]);
  return check;
}

Check same_bits(const std::string& what, const Multipoles& a, const Multipoles& b) {
  const bool same = a.values == b.values;
  return {what, same ? 0.0 : 1.0, 0.0, -1, same};
}

} // namespace

Validation validate_moments(const Body& body, int lmax, double cut_off, Backend* gpu, unsigned threads,
                            Monitor& monitor) {
  require_range("the degree is", lmax, 0, largest_degree);
  require_range("the cut-off is", cut_off, 0.0, largest_cut_off);
  const MomentProblem problem = mass_problems(body, lmax, cut_off).front(); // bodies here have no parts
  const std::optional<MomentProblem> near = near_problem(problem);
  const MomentProblem& computed = near ? *near : problem;
  Validation result;
  std::vector<Check>& checks = result.checks;
  auto reference = reference::moments<long double>(computed, reference_tolerance, monitor);
  if (near) reference = translated(problem, *near, reference);

  std::vector<std::vector<double>> norms;
  const auto on = [&](Backend& backend) { return mass_moments({&problem, 1}, backend, monitor, nullptr, &norms); };
  const Multipoles q = on(*make_cpu_backend(threads));
  MomentProblem fine = computed; // a coarse cut-off is to be seen, not to be allowed for
  fine.cut_off = std::min(cut_off, default_cut_off);
  plan::DegreeSums sums = plan::degree_sums(fine);
  const RoundingTerms rounding = {moment_terms(computed, threads, monitor).root, norms.front(), sums.bound,
                                  sums.left_out, double(problem.faces.size())};
  const std::vector<double> estimate = problem_error(problem, rounding);
  // What is printed is of the moments as they were computed, with what their cut-off leaves out.
  RoundingTerms all = rounding;
  if (cut_off > default_cut_off) all.left_out = plan::degree_sums(computed).left_out;
  result.estimate = {problem_error(problem, all), degree_norms(q), near ? plan::degree_bound(problem) : sums.bound};
  checks.push_back(
      against("CPU path against the reference in extended precision", compare(q, reference, estimate), estimate, 1));
  checks.push_back(same_bits("CPU path on one thread: other bits than on all", on(*make_cpu_backend(1)), q));
  if (gpu) {
    const Multipoles g = on(*gpu);
    checks.push_back(against("Vulkan path against the reference in extended precision", compare(g, reference, estimate),
                             estimate, 1));
    checks.push_back(same_bits("Vulkan path run twice: other bits", on(*gpu), g));
    checks.push_back(against("Vulkan path against CPU path", compare(g, q, estimate), estimate, 2));
  }

  if (lmax >= 1 && body.origin_kind == "centre of mass") {
    // The centre itself is rounded to doubles.
    const double rounding_of_centre =
        0x1p-52 * std::abs(body.mass()) * (body.centre_of_mass.norm() + body.brillouin_radius) / body.brillouin_radius;
    const double dipole = degree_norm(q, 1), allowed = estimate[1] + rounding_of_centre;
    checks.push_back({"dipole about the centre of mass", dipole / allowed, 1, 1, dipole <= allowed});
  }
  const Agreement low = compare_with_tensors(body, q, estimate);
  checks.push_back(against("mass and quadrupole tensor against degrees 0 and 2", low.errors,
                           std::span(estimate).first(low.errors.norm.size()), 1));
  return result;
}

} // namespace cowgpu

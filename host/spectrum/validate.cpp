#include "host/spectrum/validate.hpp"

#include "host/plan/moments.hpp"
#include "host/reference/moments.hpp"
#include "host/spectrum/verify.hpp"

#include <algorithm>

namespace cowgpu {
namespace {

// Far below what an extended-precision sum can resolve.
constexpr double reference_tolerance = 1e-22;

Check against(const std::string& what, const Coefficients& q, std::span<const long double> reference,
              std::span<const double> bound, double allowed) {
  const DegreeErrors errors = compare(q, reference, bound);
  return {what + " against the reference in extended precision", errors.worst, allowed, errors.worst_degree,
          errors.weighed <= allowed};
}

Check within(const std::string& what, double value, double bound, int degree) {
  return {what, value, bound, degree, value <= bound}; // NaN fails
}

Check same_bits(const std::string& what, const Coefficients& a, const Coefficients& b) {
  const bool same = a.values == b.values;
  return {what, same ? 0.0 : 1.0, 0.0, -1, same};
}

} // namespace

std::vector<Check> validate_moments(const Body& body, int lmax, double cut_off, Backend* gpu, unsigned threads,
                                    Monitor& monitor) {
  const MomentProblem problem = mass_problems(body, lmax, cut_off).front(); // bodies here have no parts
  const double allowed = expected_error(lmax);
  const std::vector<double> bound = plan::degree_bound(problem);
  std::vector<Check> checks;
  const auto reference = reference::moments<long double>(problem, reference_tolerance, monitor);

  const Coefficients q = make_cpu_backend(threads)->moments(problem, monitor);
  checks.push_back(against("CPU path", q, reference, bound, allowed));
  checks.push_back(
      same_bits("CPU path on one thread: other bits than on all", make_cpu_backend(1)->moments(problem, monitor), q));
  if (gpu) {
    const Coefficients g = gpu->moments(problem, monitor);
    checks.push_back(against("Vulkan path", g, reference, bound, allowed));
    checks.push_back(same_bits("Vulkan path run twice: other bits", gpu->moments(problem, monitor), g));
    const DegreeErrors paths = compare(g, q, bound);
    checks.push_back(
        {"Vulkan path against CPU path", paths.worst, allowed, paths.worst_degree, paths.weighed <= allowed});
  }

  // Far from the coordinates' origin the centre of mass itself is rounded.
  const double rounding = 4 * 2.2e-16 * body.centre_of_mass.norm() / body.brillouin_radius;
  if (lmax >= 1 && body.origin_kind == "centre of mass")
    checks.push_back(
        within("dipole about the centre of mass, over its bound", degree_norm(q, 1) / bound[1], 1e-14 + rounding, 1));
  const DegreeErrors low = compare_with_tensors(body, q).errors;
  checks.push_back(
      {"mass and quadrupole tensor against degrees 0 and 2", low.worst, 1e-14, low.worst_degree, low.weighed <= 1e-14});
  return checks;
}

} // namespace cowgpu

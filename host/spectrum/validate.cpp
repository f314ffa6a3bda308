#include "host/spectrum/validate.hpp"

#include "host/mesh/tensors.hpp"
#include "host/plan/moments.hpp"
#include "host/reference/moments.hpp"
#include "host/spectrum/verify.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

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

// Q_2m from the traceless tensor T_ij = integral of density (3 x_i x_j - r^2 delta_ij).
std::vector<std::complex<double>> quadrupole_from(const Eigen::Matrix3d& t) {
  const double pi = std::numbers::pi;
  return {0.25 * std::sqrt(5 / pi) * t(2, 2), -std::sqrt(15 / (8 * pi)) / 3 * std::complex(t(0, 2), t(1, 2)),
          std::sqrt(15 / (32 * pi)) / 3 * std::complex(t(0, 0) - t(1, 1), 2 * t(0, 1))};
}

} // namespace

std::vector<Check> validate_moments(const Body& body, int lmax, double cut_off, Backend* gpu, unsigned threads,
                                    Monitor& monitor) {
  const MomentProblem problem = mass_problem(body, lmax, cut_off);
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

  const double q00 = body.mass() / std::sqrt(4 * std::numbers::pi);
  checks.push_back(within("Q_00 against mass / sqrt(4 pi)", std::abs(q(0, 0).real() - q00) / std::abs(q00), 1e-14, 0));
  if (lmax >= 1 && body.origin_kind == "centre of mass")
    checks.push_back(within("dipole about the centre of mass, over its bound", degree_norm(q, 1) / bound[1], 1e-14, 1));
  if (lmax >= 2) {
    const auto expected = quadrupole_from(tensors(body).quadrupole);
    double worst = 0;
    for (int m = 0; m <= 2; ++m)
      worst = std::max(worst, std::abs(q(2, m) * q.reference_radius * q.reference_radius - expected[std::size_t(m)]));
    checks.push_back(within("Q_2m against the Cartesian quadrupole tensor, over the bound",
                            worst / (bound[2] * q.reference_radius * q.reference_radius), 1e-14, 2));
  }
  return checks;
}

} // namespace cowgpu

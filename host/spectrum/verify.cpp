#include "host/spectrum/verify.hpp"

#include "host/mesh/tensors.hpp"
#include "host/plan/moments.hpp"
#include "host/reference/moments.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <random>

namespace cowgpu {
namespace {

constexpr std::size_t sample_size = 256;

// The reference leaves out what is this small beside the bound of a degree: far below its own rounding.
constexpr double reference_tolerance = 1e-18;

std::vector<Face> sample_of(std::span<const Face> faces, std::uint64_t seed) {
  std::vector<Face> sample;
  std::mt19937_64 random(seed);
  std::sample(faces.begin(), faces.end(), std::back_inserter(sample), sample_size, random);
  return sample;
}

} // namespace

const Agreement* Accuracy::worst() const {
  const Agreement* worst = nullptr;
  for (const Agreement& a : agreements)
    if (!worst || (!std::isnan(worst->errors.weighed) && !(a.errors.weighed <= worst->errors.weighed))) worst = &a;
  return worst;
}

bool Accuracy::passed() const {
  return worst() && worst()->errors.weighed <= bound;
}

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

std::vector<double> degree_bound(std::span<const MomentProblem> problems) {
  std::vector<double> sum;
  for (const MomentProblem& problem : problems) {
    const std::vector<double> bound = plan::degree_bound(problem);
    sum.resize(bound.size());
    for (std::size_t l = 0; l < bound.size(); ++l) sum[l] += bound[l];
  }
  return sum;
}

Coefficients mass_moments(std::span<const MomentProblem> problems, Backend& backend, Monitor& monitor,
                          RunReport* report) {
  Coefficients sum;
  RunReport runs;
  for (const MomentProblem& problem : problems) {
    RunReport run;
    Coefficients q = backend.moments(problem, monitor, &run);
    if (&problem == problems.data())
      sum = std::move(q);
    else
      for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += q.values[i];
    runs.seconds += run.seconds;
    runs.setup_seconds += run.setup_seconds;
    runs.elements += run.elements;
    runs.full_elements += run.full_elements;
    runs.pairs += run.pairs;
    runs.kernels.insert(runs.kernels.end(), run.kernels.begin(), run.kernels.end());
  }
  if (report) *report = std::move(runs);
  return sum;
}

Agreement compare_with_tensors(const Body& body, const Coefficients& q) {
  Coefficients ours = q;
  ours.lmax = std::min(q.lmax, 2);
  ours.values.resize(Coefficients::count(ours.lmax));
  Coefficients expected = ours; // degree 1 is compared with itself: the centre of mass is a rounded number
  constexpr double pi = std::numbers::pi;
  expected.values[0] = body.mass() / std::sqrt(4 * pi);
  if (ours.lmax == 2) {
    const Eigen::Matrix3d t = tensors(body).quadrupole / (q.reference_radius * q.reference_radius);
    expected.values[Coefficients::index(2, 0)] = std::sqrt(5 / pi) / 4 * t(2, 2);
    expected.values[Coefficients::index(2, 1)] = -std::sqrt(5 / (24 * pi)) * std::complex(t(0, 2), t(1, 2));
    expected.values[Coefficients::index(2, 2)] =
        std::sqrt(5 / (96 * pi)) * std::complex(t(0, 0) - t(1, 1), 2 * t(0, 1));
  }
  return {"degrees 0 and 2", "mass and quadrupole tensor",
          compare(ours, expected, degree_bound(mass_problems(body, ours.lmax, 0)))};
}

std::uint64_t verify_bytes(const MomentProblem& problem, const Backend& backend, Verify how) {
  if (how == Verify::none) return 0;
  const std::uint64_t count = Coefficients::count(problem.lmax);
  if (backend.facts().type != "cpu") return 32 * count + make_cpu_backend()->moments_memory(problem).host;
  // One partial sum a thread and the total, and rows of 16 triangles a thread.
  const std::uint64_t threads = std::min(8U, all_threads());
  return 16 * count + sizeof(long double) * 2 * count * (threads + 1) +
         threads * 16 * 3 * sizeof(reference::ComplexOf<long double>) * (std::uint64_t(problem.lmax) + 1) +
         std::min<std::uint64_t>(problem.faces.size(), how == Verify::full ? problem.faces.size() : sample_size) * 256;
}

Accuracy verify_moments(const MomentProblem& problem, Backend& backend, Verify how, std::uint64_t seed,
                        Monitor& monitor) {
  Accuracy accuracy;
  accuracy.how = how;
  if (how == Verify::none) return accuracy;
  std::vector<Face> sample;
  MomentProblem part = problem;
  if (how == Verify::sample && problem.faces.size() > sample_size) {
    sample = sample_of(problem.faces, seed);
    part.faces = sample;
    const double own = brillouin_radius(part.vertices, part.faces, part.origin);
    if (own > 0) part.reference_radius = own; // all of the sample may lie in the origin
  }
  accuracy.triangles = part.faces.size();
  accuracy.seed = seed;
  accuracy.bound = expected_error(problem.lmax);
  const std::vector<double> bound = plan::degree_bound(part);
  const Coefficients done = backend.moments(part, monitor);
  if (backend.facts().type != "cpu") {
    const Coefficients other = make_cpu_backend()->moments(part, monitor);
    accuracy.agreements.push_back({"Vulkan", "CPU path", compare(done, other, bound)});
  } else {
    const auto other = reference::moments<long double>(part, reference_tolerance, monitor);
    accuracy.agreements.push_back({"CPU path", "reference in extended precision", compare(done, other, bound)});
  }
  return accuracy;
}

Accuracy verify_all(std::span<const MomentProblem> problems, Backend& backend, Verify how, std::uint64_t seed,
                    Monitor& monitor) {
  Accuracy all;
  for (const MomentProblem& problem : problems) {
    Accuracy one = verify_moments(problem, backend, how, seed, monitor);
    if (&problem == problems.data()) {
      all = std::move(one);
      continue;
    }
    all.triangles += one.triangles;
    // Of the same paths each time, in the same order.
    for (std::size_t i = 0; i < one.agreements.size(); ++i)
      if (!(one.agreements[i].errors.weighed <= all.agreements[i].errors.weighed))
        all.agreements[i] = one.agreements[i];
  }
  return all;
}

} // namespace cowgpu

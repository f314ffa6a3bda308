#include "host/mass/verify.hpp"

#include "host/mass/translate.hpp"
#include "host/mesh/tensors.hpp"
#include "host/moment_terms.hpp"
#include "host/plan/moments.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <random>

namespace cowgpu {
namespace {

constexpr std::size_t sample_size = 128;

std::vector<Face> sample_of(std::span<const Face> faces, std::uint64_t seed) {
  std::vector<Face> sample;
  std::mt19937_64 random(seed);
  std::sample(faces.begin(), faces.end(), std::back_inserter(sample), sample_size, random);
  return sample;
}

unsigned threads_of(const Backend& backend) {
  return backend.facts().type == "cpu" ? backend.facts().threads : 0;
}

void add(std::vector<double>& sum, const std::vector<double>& more) {
  sum.resize(more.size());
  for (std::size_t i = 0; i < more.size(); ++i) sum[i] += more[i];
}

} // namespace

const Agreement* Accuracy::worst() const {
  const Agreement* worst = nullptr;
  for (const Agreement& a : agreements)
    if (!worst || (!std::isnan(worst->errors.ratio) && !(a.errors.ratio <= worst->errors.ratio))) worst = &a;
  return worst;
}

bool Accuracy::passed() const {
  return worst() && worst()->errors.ratio <= bound;
}

Agreement compare_with_tensors(const Body& body, const Multipoles& q, std::span<const double> estimate) {
  Multipoles ours(std::min(q.lmax, 2));
  for (int l = 0; l <= ours.lmax; ++l)
    for (int m = 0; m <= l; ++m) ours(l, m) = q(l, m);
  Multipoles expected = ours; // degree 1 is compared with itself: the centre of mass is a rounded number
  constexpr double pi = std::numbers::pi;
  expected(0, 0) = body.mass() / std::sqrt(4 * pi);
  if (ours.lmax == 2) {
    const Eigen::Matrix3d t = tensors(body).quadrupole / (q.reference_radius * q.reference_radius);
    expected(2, 0) = std::sqrt(5 / pi) / 4 * t(2, 2);
    expected(2, 1) = -std::sqrt(5 / (24 * pi)) * std::complex(t(0, 2), t(1, 2));
    expected(2, 2) = std::sqrt(5 / (96 * pi)) * std::complex(t(0, 0) - t(1, 1), 2 * t(0, 1));
  }
  return {"degrees 0 and 2", "mass and quadrupole tensor",
          compare(ours, expected, estimate.first(std::size_t(ours.lmax) + 1))};
}

std::uint64_t verify_bytes(const MomentProblem& problem, Verify how) {
  if (how == Verify::none) return 0;
  MomentProblem part = problem;
  if (how == Verify::sample) part.faces = part.faces.first(std::min(part.faces.size(), sample_size));
  return 16 * Multipoles::count(problem.lmax) + moment_terms_bytes(part);
}

std::vector<double> problem_error(const MomentProblem& problem, const RoundingTerms& rounding) {
  const std::vector<double> error = error_estimate(rounding);
  const std::optional<MomentProblem> near = near_problem(problem);
  return near ? translated_error(problem, *near, error, rounding.bound[0]) : error;
}

Accuracy verify_moments(const MomentProblem& problem, Backend& backend, Verify how, std::uint64_t seed,
                        Monitor& monitor, RoundingTerms* rounding) {
  Accuracy accuracy;
  accuracy.how = how;
  if (how == Verify::none) return accuracy;
  std::vector<Face> sample;
  MomentProblem part = problem;
  const bool all = how == Verify::full || problem.faces.size() <= sample_size;
  if (!all) {
    sample = sample_of(problem.faces, seed);
    part.faces = sample;
    const double own = brillouin_radius(part.vertices, part.faces, part.origin);
    if (own > 0) part.reference_radius = own; // all of the sample may lie in the origin
  }
  accuracy.triangles = part.faces.size();
  accuracy.seed = seed;
  const Multipoles done = backend.moments(part)->run(monitor);
  const MomentTerms terms = moment_terms(part, threads_of(backend), monitor);
  plan::DegreeSums sums = plan::degree_sums(part);
  // The norms are the second recursion's: the backend's may be wrong.
  const RoundingTerms sampled = {terms.root, degree_norms(terms.sum), sums.bound, sums.left_out,
                                 double(part.faces.size())};
  accuracy.agreements.push_back({backend.facts().type == "cpu" ? "CPU path" : "Vulkan", "second recursion",
                                 compare(done, terms.sum, error_estimate(sampled))});
  if (!rounding) return accuracy;
  rounding->root = terms.root;
  if (!all) {
    const std::vector<double> sample_bound = std::move(sums.root);
    sums = plan::degree_sums(problem);
    rounding->root = root_by_sample(terms.root, sample_bound, sums.root);
  }
  rounding->bound = std::move(sums.bound);
  rounding->left_out = std::move(sums.left_out);
  rounding->triangles = double(problem.faces.size());
  return accuracy;
}

Accuracy verify_all(std::span<const MomentProblem> problems, const Multipoles& mass,
                    std::span<const std::vector<double>> norms, Backend& backend, Verify how, std::uint64_t seed,
                    Monitor& monitor) {
  Accuracy all;
  std::vector<double> squares(std::size_t(mass.lmax) + 1);
  for (std::size_t p = 0; p < problems.size(); ++p) {
    const std::optional<MomentProblem> near = near_problem(problems[p]);
    RoundingTerms rounding;
    Accuracy one = verify_moments(near ? *near : problems[p], backend, how, seed, monitor, &rounding);
    if (how == Verify::none) return one;
    rounding.norm = norms[p];
    const std::vector<double> error = problem_error(problems[p], rounding);
    for (std::size_t l = 0; l < squares.size(); ++l) squares[l] += error[l] * error[l];
    add(one.estimate.bound, near ? plan::degree_bound(problems[p]) : rounding.bound);
    if (p == 0) {
      all = std::move(one);
      continue;
    }
    all.triangles += one.triangles;
    add(all.estimate.bound, one.estimate.bound);
    // The same paths each time, in the same order.
    for (std::size_t i = 0; i < one.agreements.size(); ++i)
      if (!(one.agreements[i].errors.ratio <= all.agreements[i].errors.ratio)) all.agreements[i] = one.agreements[i];
  }
  for (const double s : squares) all.estimate.error.push_back(std::sqrt(s));
  all.estimate.norm = degree_norms(mass);
  return all;
}

} // namespace cowgpu

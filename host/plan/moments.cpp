#include "host/plan/moments.hpp"

#include "host/error.hpp"
#include "host/geometry/determinant.hpp"
#include "host/plan/pairing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace cowgpu::plan {
namespace {

using Extended = long double;
using ExtendedVec3 = Eigen::Matrix<Extended, 3, 1>;

// Even without a cut-off, groups that would underflow are left out.
constexpr double smallest_cut_off = 1e-150;

// Column scale 1 is cheaper, but its rows fall like 2^-l at m = l.
constexpr int largest_degree_unscaled = 1024;

ExtendedVec3 reduced(const MomentProblem& problem, std::uint32_t vertex) {
  const ExtendedVec3 x = problem.vertices[vertex].cast<Extended>() - problem.origin.cast<Extended>();
  return x / Extended(problem.reference_radius);
}

struct Triangle {
  double weight = 0; // |det|/2
  double radius = 0;
};

Triangle measure(const MomentProblem& problem, const Face& face, Extended& determinant) {
  const std::array<ExtendedVec3, 3> x = {reduced(problem, face[0]), reduced(problem, face[1]),
                                         reduced(problem, face[2])};
  const Extended r = problem.reference_radius;
  determinant = cowgpu::determinant(problem.vertices[face[0]], problem.vertices[face[1]], problem.vertices[face[2]],
                                    problem.origin) /
                r / r / r;
  const Extended largest = std::max({x[0].squaredNorm(), x[1].squaredNorm(), x[2].squaredNorm()});
  return {double(std::abs(determinant) / 2), double(std::sqrt(largest))};
}

// Calls to(l, triangles) with the terms |det|/2 r^l as weights, and their sum, for every degree. A triangle is dropped
// from the list once it cannot change the sum any more, which also keeps its power from becoming denormal.
template <class To>
void for_each_degree(std::vector<Triangle> triangles, int lmax, const To& to) {
  for (int l = 0; l <= lmax; ++l) {
    double sum = 0;
    for (const Triangle& t : triangles) sum += t.weight;
    to(triangles, sum);
    for (Triangle& t : triangles) t.weight *= t.radius;
    if (l % 16 == 0)
      std::erase_if(triangles, [&](const Triangle& t) { return t.weight < 1e-40 * sum / double(triangles.size()); });
  }
}

std::vector<double> radial_sums(std::vector<Triangle> triangles, int lmax) {
  std::vector<double> sums;
  for_each_degree(std::move(triangles), lmax, [&](const std::vector<Triangle>&, double sum) { sums.push_back(sum); });
  return sums;
}

std::vector<Triangle> measure_all(const MomentProblem& problem) {
  std::vector<Triangle> triangles;
  triangles.reserve(problem.faces.size());
  Extended unused = 0;
  for (const Face& face : problem.faces) triangles.push_back(measure(problem, face, unused));
  return triangles;
}

// The last degree at which each group has to be kept: at every degree the smallest terms |det|/2 r^l are left out while
// their sum stays below `allowed` of that degree. Terms are put in bins by their binary exponent, and a bin is left out
// whole or not at all.
std::vector<int> last_degrees(std::vector<Triangle> groups, const std::vector<double>& allowed) {
  std::vector<int> last(groups.size(), 0);
  constexpr int bins = 1024;
  std::vector<double> bin(bins);
  const auto bin_of = [](double term, double limit) {
    // Bin 0 holds what is at or above the limit; every further bin half as much; the last one all the rest.
    return term >= limit ? 0 : std::clamp(1 + std::ilogb(limit) - std::ilogb(term), 1, bins - 1);
  };
  for (std::size_t l = 0; l < allowed.size(); ++l) {
    std::fill(bin.begin(), bin.end(), 0.0);
    for (const Triangle& g : groups)
      if (g.weight > 0) bin[std::size_t(bin_of(g.weight, allowed[l]))] += g.weight;
    int kept = bins; // first bin that may go, counted from the smallest terms
    double sum = 0;
    while (kept > 1 && sum + bin[std::size_t(kept - 1)] <= allowed[l]) sum += bin[std::size_t(--kept)];
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (groups[g].weight > 0 && bin_of(groups[g].weight, allowed[l]) < kept) last[g] = int(l);
      groups[g].weight *= groups[g].radius;
      if (groups[g].weight < 1e-290) groups[g].weight = 0;
    }
  }
  return last;
}

// |density| R^3 sqrt((2l+1)/4pi)/(l+3) times sums over |det|/2 r^l.
std::vector<double> in_units_of_moments(std::vector<double> sums, const MomentProblem& problem) {
  const double unit = std::abs(problem.density) * std::pow(problem.reference_radius, 3);
  for (std::size_t l = 0; l < sums.size(); ++l)
    sums[l] *= unit * std::sqrt((2 * double(l) + 1) / (4 * std::numbers::pi)) / (double(l) + 3);
  return sums;
}

TrianglePair make_pair(const MomentProblem& problem, std::uint32_t first, std::uint32_t second, Extended& dets,
                       std::vector<Triangle>& triangles) {
  const Face& f = problem.faces[first];
  Extended det_f = 0, det_g = 0;
  triangles.push_back(measure(problem, f, det_f));
  TrianglePair pair;
  pair.radius = triangles.back().radius;
  std::array<std::uint32_t, 4> corner = {f[0], f[1], f[2], f[2]};
  if (second != unpaired) {
    const Face& g = problem.faces[second];
    const auto in = [](const Face& face, std::uint32_t v) {
      return std::find(face.begin(), face.end(), v) != face.end();
    };
    corner[2] = *std::find_if(f.begin(), f.end(), [&](std::uint32_t v) { return !in(g, v); });
    corner[3] = *std::find_if(g.begin(), g.end(), [&](std::uint32_t v) { return !in(f, v); });
    int shared = 0;
    for (const std::uint32_t v : f)
      if (v != corner[2]) corner[std::size_t(shared++)] = v;
    triangles.push_back(measure(problem, g, det_g));
    pair.radius = std::max(pair.radius, triangles.back().radius);
  }
  pair.a = reduced(problem, corner[0]).cast<double>();
  pair.b = reduced(problem, corner[1]).cast<double>();
  pair.c = reduced(problem, corner[2]).cast<double>();
  pair.d = reduced(problem, corner[3]).cast<double>();
  pair.det_c = double(det_f);
  pair.det_d = double(det_g);
  dets += det_f + det_g;
  return pair;
}

double entries(int degree) {
  return 0.5 * (degree + 1.0) * (degree + 2.0);
}

void check(const MomentProblem& problem) {
  if (problem.lmax < 0 || problem.lmax > largest_degree)
    throw Error(Fault::bad_argument,
                fmt::format("lmax {} is out of range: it must be 0 to {}", problem.lmax, largest_degree));
  if (!(problem.reference_radius > 0) || !std::isfinite(problem.reference_radius))
    throw Error(Fault::bad_argument,
                fmt::format("the reference radius {} must be positive and finite", problem.reference_radius));
  if (!(problem.cut_off >= 0) || problem.cut_off > 1e-3)
    throw Error(Fault::bad_argument, fmt::format("the cut-off {} must be 0 to 1e-3", problem.cut_off));
}

} // namespace

Moments moments(const MomentProblem& problem, int lanes) {
  check(problem);
  Moments plan;
  plan.lmax = problem.lmax;
  plan.lanes = lanes;
  plan.column_scale = problem.lmax <= largest_degree_unscaled ? 1 : 2;
  plan.start_exponent = plan.column_scale == 1 ? 900 : 900 - int(std::ceil(0.323 * problem.lmax));

  Extended dets = 0;
  std::vector<Triangle> triangles;
  triangles.reserve(problem.faces.size());
  std::vector<TrianglePair> found;
  const auto matched = pair_faces(problem.faces, problem.vertices.size());
  found.reserve(matched.size());
  for (const auto& [f, g] : matched) found.push_back(make_pair(problem, f, g, dets, triangles));
  // The mass is the one moment that is as good as the input, whatever cancels.
  Extended sizes = 0;
  for (const Triangle& t : triangles) sizes += 2 * t.weight;
  if (std::abs(dets) < 0x1p-6L * sizes) {
    const Extended r = problem.reference_radius;
    dets = sum_of_determinants(problem.vertices, problem.faces, problem.origin) / r / r / r;
  }
  plan.sum_of_dets = double(dets);
  plan.pair_count = found.size();

  std::vector<std::uint32_t> order(found.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t x, std::uint32_t y) {
    return found[x].radius != found[y].radius ? found[x].radius > found[y].radius : x < y;
  });
  if (!order.empty() && found[order[0]].radius > 1 + 1e-9)
    throw Error(Fault::bad_argument,
                fmt::format("the reference radius {} is smaller than the body: a vertex lies at {} of it",
                            problem.reference_radius, found[order[0]].radius));

  const std::size_t groups = (found.size() + std::size_t(lanes) - 1) / std::size_t(lanes);
  plan.pairs.resize(groups * std::size_t(lanes));
  std::vector<Triangle> group(groups);
  for (std::size_t i = 0; i < plan.pairs.size(); ++i) {
    // Padding repeats the last pair without weight, so that its rows stay in range.
    TrianglePair pair = found[order[std::min(i, order.size() - 1)]];
    if (i >= order.size()) pair.det_c = pair.det_d = 0;
    Triangle& g = group[i / std::size_t(lanes)];
    g.weight += (std::abs(pair.det_c) + std::abs(pair.det_d)) / 2;
    g.radius = std::max(g.radius, pair.radius);
    plan.pairs[i] = pair;
  }

  std::vector<double> allowed = radial_sums(std::move(triangles), problem.lmax);
  for (double& a : allowed) a *= std::max(problem.cut_off, smallest_cut_off);
  plan.last_degree = last_degrees(std::move(group), allowed);
  for (std::size_t g = 0; g < groups; ++g) plan.elements += lanes * entries(plan.last_degree[g]);
  plan.full_elements = double(plan.pair_count) * entries(problem.lmax);
  return plan;
}

void lane_inputs(const Moments& plan, std::size_t group, double* to) {
  const std::size_t lanes = std::size_t(plan.lanes);
  const double half = 0.5 / plan.column_scale;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const TrianglePair& p = plan.pairs[group * lanes + lane];
    const double c_rho = std::hypot(p.c.x(), p.c.y()), d_rho = std::hypot(p.d.x(), p.d.y());
    const std::array<double, inputs> values = {p.a.x() * half,
                                               p.a.y() * half,
                                               p.a.z(),
                                               p.b.x() * half,
                                               p.b.y() * half,
                                               p.b.z(),
                                               c_rho * half,
                                               p.c.z(),
                                               d_rho * half,
                                               p.d.z(),
                                               c_rho > 0 ? p.c.x() / c_rho : 1,
                                               c_rho > 0 ? p.c.y() / c_rho : 0,
                                               d_rho > 0 ? p.d.x() / d_rho : 1,
                                               d_rho > 0 ? p.d.y() / d_rho : 0,
                                               p.det_c,
                                               p.det_d};
    for (std::size_t k = 0; k < inputs; ++k) to[k * lanes + lane] = values[k];
  }
}

std::vector<double> lane_inputs(const Moments& plan, std::span<const std::uint32_t> order) {
  const std::size_t group_doubles = inputs * std::size_t(plan.lanes);
  std::vector<double> all(order.size() * group_doubles);
  for (std::size_t i = 0; i < order.size(); ++i) lane_inputs(plan, order[i], &all[i * group_doubles]);
  return all;
}

RunReport report(const Moments& plan, double setup_seconds, double seconds) {
  RunReport report;
  report.seconds = seconds;
  report.setup_seconds = setup_seconds;
  report.elements = plan.elements;
  report.full_elements = plan.full_elements;
  report.pairs = plan.pair_count;
  return report;
}

std::uint64_t bytes(const MomentProblem& problem) {
  return std::uint64_t(problem.faces.size()) * 304 + std::uint64_t(problem.vertices.size()) * 8;
}

Multipoles finish(const MomentProblem& problem, const Moments& plan, std::span<const double> sums) {
  Multipoles result(problem);

  std::vector<Extended> root(2 * std::size_t(problem.lmax) + 2), inverse_root(root.size());
  for (std::size_t n = 1; n < root.size(); ++n) {
    root[n] = std::sqrt(Extended(n));
    inverse_root[n] = 1 / root[n];
  }
  const Extended r = problem.reference_radius;
  const Extended unit = std::ldexp(Extended(problem.density) * r * r * r, -plan.start_exponent);
  for (int l = 0; l <= problem.lmax; ++l) {
    const Extended degree = l;
    Extended factor = unit * std::sqrt((2 * degree + 1) / (4 * std::numbers::pi_v<Extended>)) /
                      ((degree + 1) * (degree + 2) * (degree + 3));
    for (int m = 0; m <= l; ++m) {
      const std::size_t i = Multipoles::by_degree(l, m);
      const Extended im = m == 0 ? 0 : factor * sums[2 * i + 1];
      result(l, m) = {double(factor * sums[2 * i]), double(im)};
      if (m < l)
        factor *= root[std::size_t(l) + std::size_t(m) + 1] * inverse_root[std::size_t(l - m)] / plan.column_scale;
    }
  }
  return result;
}

std::vector<double> degree_bound(const MomentProblem& problem) {
  return in_units_of_moments(radial_sums(measure_all(problem), problem.lmax), problem);
}

DegreeSums degree_sums(const MomentProblem& problem) {
  DegreeSums sums;
  const double cut_off = std::max(problem.cut_off, smallest_cut_off);
  for_each_degree(measure_all(problem), problem.lmax, [&](const std::vector<Triangle>& triangles, double sum) {
    double squares = 0, small = 0;
    const double allowed = cut_off * sum;
    for (const Triangle& t : triangles) {
      squares += t.weight * t.weight;
      small += t.weight <= allowed ? t.weight : 0;
    }
    sums.bound.push_back(sum);
    sums.root.push_back(std::sqrt(squares));
    sums.left_out.push_back(std::min(small, allowed));
  });
  sums.bound = in_units_of_moments(std::move(sums.bound), problem);
  sums.root = in_units_of_moments(std::move(sums.root), problem);
  sums.left_out = in_units_of_moments(std::move(sums.left_out), problem);
  return sums;
}

} // namespace cowgpu::plan

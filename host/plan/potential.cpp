#include "host/plan/potential.hpp"

#include "host/bounds.hpp"
#include "host/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

namespace cowgpu::plan {
namespace {

using Complex = std::complex<double>;

constexpr double four_pi = 4 * std::numbers::pi;

// Coefficients of a real series in J_lm, those of m < 0 following from a_l,-m = (-1)^m conj(a_lm).
struct Set {
  explicit Set(int top) : values(Multipoles::count(top)) {}
  Complex& at(int l, int m) { return values[Multipoles::by_degree(l, m)]; }
  /// 0 where there is none.
  Complex operator()(int l, int m) const {
    if (l < 0 || std::abs(m) > l) return 0;
    const Complex a = values[Multipoles::by_degree(l, std::abs(m))];
    return m >= 0 ? a : m % 2 ? -std::conj(a) : std::conj(a);
  }
  std::vector<Complex> values;
};

double quotient(int l) {
  return double(2 * l + 1) / double(2 * l + 3);
}

Set along_z(const Set& a, int top) {
  Set r(top);
  for (int l = 1; l <= top; ++l)
    for (int m = 0; m < l; ++m) r.at(l, m) = -std::sqrt(quotient(l - 1) * double(l - m) * double(l + m)) * a(l - 1, m);
  return r;
}

// Along x or y, which are sum and difference of the derivatives along x + iy and x - iy, halved and over 2i.
Set across(const Set& a, int top, bool y) {
  Set r(top);
  for (int l = 1; l <= top; ++l)
    for (int m = 0; m <= l; ++m) {
      const double k = quotient(l - 1);
      const Complex raised = std::sqrt(k * double(l + m - 1) * double(l + m)) * a(l - 1, m - 1);
      const Complex lowered = -std::sqrt(k * double(l - m - 1) * double(l - m)) * a(l - 1, m + 1);
      r.at(l, m) = y ? (raised - lowered) * Complex(0, -0.5) : (raised + lowered) * 0.5;
    }
  return r;
}

Set value_set(const PotentialProblem& problem, int top) {
  Set r(top);
  for (int l = 0; l <= problem.lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      const Complex q = problem.moments(l, m);
      if (!std::isfinite(q.real()) || !std::isfinite(q.imag()))
        throw Error(Fault::bad_argument, fmt::format("the moment of degree {} and order {} is not finite", l, m));
      r.at(l, m) = four_pi / double(2 * l + 1) * (m == 0 ? Complex(q.real()) : std::conj(q));
    }
  return r;
}

void check(const PotentialProblem& problem) {
  require_member("the derivatives are", problem.derivatives, Derivatives::second);
  const int most = std::min(problem.moments.lmax, largest_potential_degree);
  if (problem.lmax < 0 || problem.lmax > most)
    throw Error(Fault::bad_argument,
                fmt::format("a potential to degree {}: the moments go to {}, and beyond {} orders that count underflow "
                            "next to the axis; degrees from 0 to {} are possible",
                            problem.lmax, problem.moments.lmax, largest_potential_degree, most));
  if (!(problem.moments.reference_radius > 0) || !std::isfinite(problem.moments.reference_radius))
    throw Error(Fault::bad_argument,
                fmt::format("the reference radius is {}: it must be above 0", problem.moments.reference_radius));
}

// Terms of one degree are at most the set's norm there times that of the harmonics.
void add_bounds(const Set& set, int top, std::vector<double>& bounds) {
  bounds.resize(std::size_t(top) + 1);
  for (int l = 0; l <= top; ++l) {
    double sum = std::norm(set(l, 0));
    for (int m = 1; m <= l; ++m) sum += 2 * std::norm(set(l, m));
    bounds[std::size_t(l)] = std::max(bounds[std::size_t(l)], std::sqrt(sum * (2 * l + 1) / (four_pi)));
  }
}

// The least degree up to which the terms need to be summed where R/r is `ratio`.
int needed_degree(const PotentialSeries& series, double ratio, double cut_off) {
  int needed = 0;
  std::vector<double> terms;
  for (const std::vector<double>& bounds : series.bounds) {
    if (bounds.empty()) continue;
    terms.clear();
    double power = 1, all = 0;
    for (const double bound : bounds) {
      terms.push_back(bound * power);
      all += terms.back();
      power *= ratio;
    }
    double rest = 0;
    int l = series.top;
    while (l > needed && rest + terms[std::size_t(l)] <= cut_off * all) rest += terms[std::size_t(l--)];
    needed = std::max(needed, l);
  }
  return needed;
}

} // namespace

PotentialSeries potential_series(const PotentialProblem& problem) {
  check(problem);
  PotentialSeries series;
  const int order = int(problem.derivatives), top = problem.lmax + order;
  series.lmax = problem.lmax;
  series.top = top;
  series.sets = potential_sets(problem.derivatives);
  std::vector<Set> sets = {value_set(problem, top)};
  if (order > 0) {
    sets.push_back(across(sets[0], top, false));
    sets.push_back(across(sets[0], top, true));
    sets.push_back(along_z(sets[0], top));
  }
  if (order > 1) {
    sets.push_back(across(sets[1], top, false));
    sets.push_back(across(sets[1], top, true));
    sets.push_back(across(sets[3], top, false));
    sets.push_back(across(sets[3], top, true));
    sets.push_back(along_z(sets[3], top));
  }
  for (std::size_t s = 0; s < sets.size(); ++s) add_bounds(sets[s], top, series.bounds[s == 0 ? 0 : s < 4 ? 1 : 2]);

  series.table.reserve(series.stride() * Multipoles::count(top));
  for (int m = 0; m <= top; ++m)
    for (int l = m; l <= top; ++l) {
      const double a = std::sqrt(double(2 * l + 1) * double(2 * l + 3) / (double(l + 1 - m) * double(l + 1 + m)));
      const double b =
          l == m ? 0 : a * std::sqrt(double(l - m) * double(l + m) / (double(2 * l - 1) * double(2 * l + 1)));
      series.table.push_back(l < top ? a : -std::sqrt(double(2 * m + 3) / double(2 * m + 2)));
      series.table.push_back(b);
      const double weight = m == 0 ? 1 : 2; // for -m
      for (const Set& set : sets) {
        series.table.push_back(weight * set(l, m).real());
        series.table.push_back(-weight * set(l, m).imag());
      }
    }
  return series;
}

PotentialPoints potential_points(const PotentialProblem& problem, const PotentialSeries& series,
                                 std::span<const Vec3> at) {
  const double radius = problem.moments.reference_radius;
  const std::size_t count = at.size();
  if (count > (std::size_t(1) << 31))
    throw Error(Fault::too_large, fmt::format("{} points are too many at once: pass at most 2^31", count));
  std::vector<double> ratio2(count); // (r/R)^2
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3& p = at[i];
    const double r2 = (p / radius).squaredNorm();
    if (!p.allFinite() || !(r2 < 1e300))
      throw Error(Fault::bad_argument,
                  fmt::format("point {} ({}, {}, {}) is not finite, or farther than 1e150 radii of "
                              "{}",
                              i, p[0], p[1], p[2], radius));
    if (!(r2 >= nearest_potential * nearest_potential))
      throw Error(Fault::point_inside,
                  fmt::format("point {} is {} from the origin of the moments, {} inside their sphere of radius {}: the "
                              "series is the potential outside it alone",
                              i, p.norm(), radius - p.norm(), radius));
    ratio2[i] = r2;
  }
  PotentialPoints points;
  points.order.resize(count);
  std::iota(points.order.begin(), points.order.end(), 0U);
  std::stable_sort(points.order.begin(), points.order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return ratio2[a] > ratio2[b]; });
  constexpr std::size_t block = PotentialPoints::block;
  const std::size_t padded = (count + block - 1) / block * block;
  for (auto* values : {&points.x, &points.y, &points.z, &points.z_rest, &points.q, &points.start})
    values->assign(padded, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t from = points.order[i];
    const Vec3& p = at[from];
    const Vec3 u = p / radius / ratio2[from];
    points.x[i] = u.x();
    points.y[i] = u.y();
    points.q[i] = 1 / ratio2[from];
    const long double cosine = p.z() / p.cast<long double>().norm();
    const long double z = cosine * std::sqrt((long double)(points.q[i]));
    points.z[i] = double(z);
    points.z_rest[i] = double(z - points.z[i]);
    points.start[i] = 1 / std::sqrt(four_pi * ratio2[from]);
  }
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t last = std::min(count, begin + block) - 1; // the nearest
    points.tops.push_back(needed_degree(series, std::sqrt(points.q[last]), problem.cut_off));
  }
  return points;
}

PotentialField potential_field(const PotentialProblem& problem, const PotentialPoints& points,
                               const std::vector<double>& sums) {
  const double radius = problem.moments.reference_radius;
  const std::size_t padded = points.padded(), count = points.order.size();
  PotentialField field;
  field.value.resize(count);
  if (problem.derivatives != Derivatives::none) field.gradient.resize(count);
  if (problem.derivatives == Derivatives::second) field.hessian.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t to = points.order[i];
    const auto sum = [&](std::size_t set) { return sums[set * padded + i]; };
    field.value[to] = sum(0) / radius;
    if (!field.gradient.empty()) field.gradient[to] = Vec3(sum(1), sum(2), sum(3)) / radius / radius;
    if (field.hessian.empty()) continue;
    field.hessian[to] = {sum(4), sum(5), sum(6), -sum(4) - sum(8), sum(7), sum(8)};
    for (double& component : field.hessian[to]) component = component / radius / radius / radius;
  }
  return field;
}

std::uint64_t potential_bytes(std::uint64_t points, int lmax, Derivatives derivatives) {
  const std::uint64_t sets = potential_sets(derivatives), entries = Multipoles::count(lmax + int(derivatives));
  const std::uint64_t padded = points + PotentialPoints::block;
  // The table beside the sets it is made from; sums and field.
  return entries * (16 + 32 * sets) + padded * (8 + 4 + 48 + 8 * sets + 8 * (1 + 3 + 6));
}

} // namespace cowgpu::plan

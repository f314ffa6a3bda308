// Reference of the stage `moments`: plain scalar code on any number type, the oracle of both fast paths.
#pragma once

#include "host/geometry/determinant.hpp"
#include "host/moment_problem.hpp"
#include "host/monitor.hpp"
#include "host/multipoles.hpp"
#include "host/parallel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <type_traits>
#include <vector>

namespace cowgpu::reference {

/// What determinants are taken in: all else would lose in proportion to their cancellation.
template <class Real>
using Wider = std::conditional_t<std::is_floating_point_v<Real>, Quad, Real>;

template <class Real>
struct ComplexOf {
  Real re{}, im{};
};

/// Rows of solid harmonics of one degree, entries m = 0 ... l; m = -1 follows from symmetry.
template <class Real>
using Row = std::vector<ComplexOf<Real>>;

/// The factors of (d . grad) S_lm in S_{l-1,m}, S_{l-1,m+1} and S_{l-1,m-1} (Hobson 1931, ch. III), for one l:
/// sqrt(k (l-m)(l+m)), sqrt(k (l-m)(l-m-1))/2, -sqrt(k (l+m)(l+m-1))/2 with k = (2l+1)/(2l-1).
template <class Real>
struct GradientFactors {
  std::vector<Real> same, above, below;

  explicit GradientFactors(int l) : same(std::size_t(l) + 1), above(same.size()), below(same.size()) {
    using std::sqrt;
    const Real k = Real(2 * l + 1) / Real(2 * l - 1);
    for (int m = 0; m <= l; ++m) {
      const std::size_t i = std::size_t(m);
      same[i] = sqrt(k * Real(double(l - m) * double(l + m)));
      above[i] = sqrt(k * Real(double(l - m) * double(std::max(l - m - 1, 0)))) / 2;
      below[i] = -sqrt(k * Real(double(l + m) * double(l + m - 1))) / 2;
    }
  }
};

/// row <- ((d . grad) row) / l + extra, from degree l-1 to degree l; `extra` may be null.
template <class Real>
void raise(const std::array<Real, 3>& d, int l, const GradientFactors<Real>& f, Row<Real>& row,
           const Row<Real>* extra) {
  const Real inverse = Real(1) / Real(l);
  const Real x = d[0] * inverse, y = d[1] * inverse, z = d[2] * inverse;
  ComplexOf<Real> below = l >= 2 ? ComplexOf<Real>{-row[1].re, row[1].im} : ComplexOf<Real>{};
  ComplexOf<Real> same = row[0];
  row[std::size_t(l)] = {}; // degree l-1 ends one order earlier, and the next but one is zero as well
  for (std::size_t m = 0; m <= std::size_t(l); ++m) {
    const ComplexOf<Real> above = m < std::size_t(l) ? row[m + 1] : ComplexOf<Real>{};
    const Real sz = f.same[m] * z, fa = f.above[m], fb = f.below[m];
    Real re = sz * same.re + fa * (x * above.re + y * above.im) + fb * (x * below.re - y * below.im);
    Real im = sz * same.im + fa * (x * above.im - y * above.re) + fb * (x * below.im + y * below.re);
    if (extra) {
      re += (*extra)[m].re;
      im += (*extra)[m].im;
    }
    row[m] = {re, im};
    below = same;
    same = above;
  }
}

/// The last degree of each triangle, given |det| and r: from the next one on faces * |det|/2 r^l is at most tolerance times
/// the sum over all triangles. -1 where that holds from degree 0 on.
inline std::vector<int> last_degrees(std::vector<double> sizes, std::span<const double> radii, int lmax,
                                     double tolerance) {
  std::vector<int> last(sizes.size(), lmax);
  std::vector<char> left_out(sizes.size(), 0);
  for (int l = 0; l <= lmax; ++l) {
    double sum = 0;
    for (const double s : sizes) sum += s;
    for (std::size_t t = 0; t < sizes.size(); ++t) {
      const bool negligible = double(sizes.size()) * sizes[t] <= tolerance * sum;
      if (negligible != bool(left_out[t])) last[t] = negligible ? l - 1 : lmax;
      left_out[t] = negligible;
      sizes[t] *= radii[t];
    }
  }
  return last;
}

/// Q_lm / R^l of `problem` in `Real`, real and imaginary parts interleaved in the order of Multipoles: the chained
/// recursion of host/plan/moments.hpp in orthonormal harmonics, one triangle at a time, no pairing, no scaling.
/// `tolerance` > 0 leaves out a triangle from the degree on at which faces * |det|/2 r^l is at most tolerance times the
/// sum over all triangles, which bounds the error by tolerance * degree_bound() (host/plan/moments.hpp); 0 leaves out
/// nothing. problem.cut_off is not used. Runs on all threads, in an order that does not depend on them.
template <class Real>
std::vector<Real> moments(const MomentProblem& problem, double tolerance = 0, const Monitor& monitor = {}) {
  using std::acos, std::sqrt;
  constexpr std::size_t block = 16; // triangles that share one evaluation of the factors
  const std::size_t faces = problem.faces.size();
  const std::size_t degrees = std::size_t(problem.lmax) + 1;
  const Real radius = Real(problem.reference_radius);

  struct Triangle {
    std::array<std::array<Real, 3>, 3> x;
    Real det;
    int last = 0;
  };
  std::vector<Triangle> triangles(faces);
  std::vector<double> sizes(faces), radii(faces);
  for (std::size_t t = 0; t < faces; ++t) {
    auto& x = triangles[t].x;
    Real largest(0);
    for (std::size_t k = 0; k < 3; ++k) {
      Real square(0);
      for (int c = 0; c < 3; ++c) {
        x[k][std::size_t(c)] = (Real(problem.vertices[problem.faces[t][k]][c]) - Real(problem.origin[c])) / radius;
        square += x[k][std::size_t(c)] * x[k][std::size_t(c)];
      }
      if (square > largest) largest = square;
    }
    const Face& face = problem.faces[t];
    triangles[t].det = Real(determinant_in<Wider<Real>>(problem.vertices[face[0]], problem.vertices[face[1]],
                                                        problem.vertices[face[2]], problem.origin)) /
                       radius / radius / radius;
    sizes[t] = std::abs(double(triangles[t].det));
    radii[t] = double(sqrt(largest));
    triangles[t].last = problem.lmax;
  }
  if (tolerance > 0) {
    const std::vector<int> last = last_degrees(std::move(sizes), radii, problem.lmax, tolerance);
    for (std::size_t t = 0; t < faces; ++t) triangles[t].last = last[t];
  }
  std::vector<std::size_t> order(faces); // those that reach furthest together, so that blocks end together
  for (std::size_t t = 0; t < faces; ++t) order[t] = t;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return triangles[a].last > triangles[b].last; });

  // Eight partial sums whatever the machine, at most as many at once as there are threads.
  const std::size_t blocks = (faces + block - 1) / block;
  const std::size_t tasks = std::min<std::size_t>(blocks, 8);
  const std::size_t at_once = std::min<std::size_t>(tasks, all_threads());
  std::vector<std::vector<Real>> partial(at_once);
  std::vector<Real> sums(2 * Multipoles::count(problem.lmax), Real(0)); // by degree, as the partial ones
  const Real unit = Real(problem.density) * radius * radius * radius;
  const auto run_task = [&](std::size_t task, std::vector<Real>& sum) {
    sum.assign(2 * Multipoles::count(problem.lmax), Real(0));
    const Real y00 = 1 / sqrt(4 * acos(Real(-1)));
    for (std::size_t b = task; b < blocks; b += tasks) {
      const std::size_t first = b * block, last = std::min(first + block, faces);
      std::array<std::array<Row<Real>, 3>, block> rows;
      for (std::size_t t = first; t < last; ++t)
        for (auto& row : rows[t - first]) {
          row.assign(degrees, {});
          row[0].re = y00;
        }
      for (int l = 0; l <= triangles[order[first]].last; ++l) {
        check_stop(monitor);
        if (l > 0) {
          const GradientFactors<Real> factors(l);
          for (std::size_t t = first; t < last; ++t) {
            const Triangle& triangle = triangles[order[t]];
            if (l > triangle.last) continue;
            auto& [v, e, q] = rows[t - first];
            raise<Real>(triangle.x[2], l, factors, v, nullptr);
            raise<Real>(triangle.x[1], l, factors, e, &v);
            raise<Real>(triangle.x[0], l, factors, q, &e);
          }
        }
        for (std::size_t t = first; t < last; ++t) {
          const Triangle& triangle = triangles[order[t]];
          if (l > triangle.last) continue;
          const Real weight = triangle.det / Real(double(l + 1) * double(l + 2) * double(l + 3));
          const Row<Real>& q = rows[t - first][2];
          for (int m = 0; m <= l; ++m) {
            const std::size_t i = 2 * Multipoles::by_degree(l, m);
            sum[i] += weight * q[std::size_t(m)].re;
            sum[i + 1] += weight * q[std::size_t(m)].im;
          }
        }
      }
    }
  };
  for (std::size_t first = 0; first < tasks; first += at_once) {
    const std::size_t round = std::min(at_once, tasks - first);
    parallel_for(0, round, [&](std::size_t k, unsigned) { run_task(first + k, partial[k]); });
    for (std::size_t k = 0; k < round; ++k)
      for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += unit * partial[k][i];
  }
  std::vector<Real> result(sums.size());
  for (int l = 0; l <= problem.lmax; ++l)
    for (int m = 0; m <= l; ++m)
      for (std::size_t part = 0; part < 2; ++part)
        result[2 * Multipoles::index(problem.lmax, l, m) + part] = sums[2 * Multipoles::by_degree(l, m) + part];
  if constexpr (std::is_floating_point_v<Real>) { // the mass is as good as the input, whatever cancels
    const auto dets = Real(sum_of_determinants(problem.vertices, problem.faces, problem.origin));
    result[0] = Real(problem.density) * dets / (6 * sqrt(4 * acos(Real(-1))));
  }
  return result;
}

} // namespace cowgpu::reference

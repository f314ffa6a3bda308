#include "bench/moments_quadrature.hpp"

#include "host/error.hpp"
#include "host/mesh/geometry.hpp"
#include "host/parallel.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace cowgpu::bench {
namespace {

// Factors of the recursion P_lm = a (cos(theta) P_{l-1,m} - b P_{l-2,m}) of orthonormal associated Legendre functions
// with the Condon-Shortley phase (DLMF 14.10.3, normalised), sorted by l, then m; on the diagonal `a` is the
// factor of -sin(theta) P_{m-1,m-1}.
struct LegendreFactors {
  std::vector<double> a, b;

  explicit LegendreFactors(int lmax) : a(Multipoles::count(lmax)), b(a.size()) {
    for (int l = 0; l <= lmax; ++l)
      for (int m = 0; m <= l; ++m) {
        const double ll = double(l) * l, mm = double(m) * m, below = double(l - 1) * (l - 1);
        const std::size_t i = Multipoles::by_degree(l, m);
        if (m == l) {
          a[i] = l == 0 ? 0 : std::sqrt((2.0 * l + 1) / (2.0 * l));
        } else {
          a[i] = std::sqrt((4 * ll - 1) / (ll - mm));
          b[i] = std::sqrt((below - mm) / (4 * below - 1));
        }
      }
    for (int m = 0; m < lmax; ++m) b[Multipoles::by_degree(m + 1, m)] = 0;
  }
};

// Sums of r^l P_lm(cos(theta)) over the cells of one column.
class ColumnSum {
public:
  ColumnSum(int lmax, const LegendreFactors& factors)
      : lmax_(lmax), factors_(factors), legendre_(factors.a.size()), sum_(legendre_.size()) {}

  void clear() { std::fill(sum_.begin(), sum_.end(), 0.0); }

  void add(double rho, double z, double weight) {
    const double r = std::hypot(rho, z);
    const double c = r > 0 ? z / r : 1, s = r > 0 ? rho / r : 0;
    double* const p = legendre_.data();
    p[0] = 1 / std::sqrt(4 * std::numbers::pi);
    sum_[0] += weight * p[0];
    double power = weight;
    for (int l = 1; l <= lmax_; ++l) {
      power *= r;
      const double* a = &factors_.a[Multipoles::by_degree(l, 0)];
      const double* b = &factors_.b[Multipoles::by_degree(l, 0)];
      const double* one = p + Multipoles::by_degree(l - 1, 0);
      const double* two = l > 1 ? p + Multipoles::by_degree(l - 2, 0) : p;
      double* row = p + Multipoles::by_degree(l, 0);
      for (int m = 0; m < l - 1; ++m) row[m] = a[m] * (c * one[m] - b[m] * two[m]);
      row[l - 1] = a[l - 1] * c * one[l - 1];
      row[l] = -a[l] * s * one[l - 1];
      double* sum = &sum_[Multipoles::by_degree(l, 0)];
      for (int m = 0; m <= l; ++m) sum[m] += power * row[m];
    }
  }

  // Adds the column's sums times exp(i m phi).
  void put(double cosine, double sine, std::complex<double>* to) const {
    const std::complex<double> turn(cosine, sine);
    std::complex<double> phase = 1;
    for (int m = 0; m <= lmax_; ++m) {
      for (int l = m; l <= lmax_; ++l) to[Multipoles::by_degree(l, m)] += sum_[Multipoles::by_degree(l, m)] * phase;
      phase *= turn;
    }
  }

private:
  int lmax_;
  const LegendreFactors& factors_;
  std::vector<double> legendre_, sum_;
};

// Where a column meets the surface, and how much the winding number grows there on the way to +z.
struct Crossing {
  double z = 0;
  int step = 0;
};

// Which side of the directed edge p-q, seen from +z, the point (x, y) lies on, as twice a signed area. Evaluated the
// same way for both faces at the edge; a point on it counts as moved by (e, e^2), e infinitely small (Edelsbrunner and
// Muecke 1990), so that a column crosses exactly one of them, through vertices too.
struct Side {
  double area = 0;
  bool left = false;
};
Side side_of(const MomentProblem& problem, std::uint32_t p, std::uint32_t q, double x, double y) {
  const bool swapped = q < p;
  const Vec3& from = problem.vertices[swapped ? q : p];
  const Vec3& to = problem.vertices[swapped ? p : q];
  const double dx = to.x() - from.x(), dy = to.y() - from.y();
  const double area = dx * (y - from.y()) - dy * (x - from.x());
  const bool left = area != 0 ? area > 0 : (dy != 0 ? dy < 0 : dx > 0);
  return swapped ? Side{-area, !left} : Side{area, left};
}

// The crossing of the column at (x, y) with a face, if there is one.
bool cross(const MomentProblem& problem, const Face& face, double x, double y, Crossing& crossing) {
  const Side ab = side_of(problem, face[0], face[1], x, y);
  const Side bc = side_of(problem, face[1], face[2], x, y);
  if (ab.left != bc.left) return false;
  const Side ca = side_of(problem, face[2], face[0], x, y);
  if (ca.left != ab.left) return false;
  const double a = problem.vertices[face[0]].z(), b = problem.vertices[face[1]].z(), c = problem.vertices[face[2]].z();
  const double area = ab.area + bc.area + ca.area;
  crossing.z = area != 0 ? (bc.area * a + ca.area * b + ab.area * c) / area : (a + b + c) / 3;
  crossing.step = ab.left ? -1 : 1; // a face that looks to +z is where the column leaves
  return true;
}

// Cells along one axis: midpoint i stands at first + i * spacing.
struct Axis {
  double first = 0, spacing = 0;
  std::int64_t count = 0;

  Axis(double low, double high, double side) : spacing(side) {
    const double cells = std::max(1.0, std::ceil((high - low) / side));
    if (!(cells <= 1048576)) throw Error(Fault::bad_argument, "the lattice spacing is too small for this body");
    count = std::int64_t(cells);
    first = (low + high) / 2 - (cells - 1) / 2 * side;
  }
  double at(std::int64_t i) const { return first + double(i) * spacing; }
  // The first midpoint at or above `x`, within 0 ... count.
  std::int64_t above(double x) const {
    return std::int64_t(std::clamp(std::ceil((x - first) / spacing), 0.0, double(count)));
  }
};

} // namespace

LatticeMoments lattice_moments(const MomentProblem& problem, double spacing, unsigned threads) {
  const auto start = std::chrono::steady_clock::now();
  if (!(spacing > 0)) throw Error(Fault::bad_argument, "the lattice spacing must be positive");
  if (problem.lmax < 0 || problem.lmax > largest_degree) throw Error(Fault::bad_argument, "lmax is out of range");
  const Box box = bounding_box(problem.vertices, problem.faces);
  const Axis xs(box.min.x(), box.max.x(), spacing), ys(box.min.y(), box.max.y(), spacing),
      zs(box.min.z(), box.max.z(), spacing);
  const LegendreFactors factors(problem.lmax);
  const std::size_t count = Multipoles::count(problem.lmax);

  // A task is a slab of columns of one x; its sums and its number of cells.
  std::vector<std::vector<std::complex<double>>> sums(std::size_t(xs.count));
  std::vector<std::uint64_t> cells(sums.size(), 0);
  parallel_for(threads, sums.size(), [&](std::size_t ix, unsigned) {
    const double x = xs.at(std::int64_t(ix));
    std::vector<std::vector<Crossing>> crossings(std::size_t(ys.count));
    for (const Face& face : problem.faces) {
      const Vec3 &a = problem.vertices[face[0]], &b = problem.vertices[face[1]], &c = problem.vertices[face[2]];
      if (x < std::min({a.x(), b.x(), c.x()}) || x > std::max({a.x(), b.x(), c.x()})) continue;
      const std::int64_t begin = std::max<std::int64_t>(ys.above(std::min({a.y(), b.y(), c.y()})) - 1, 0);
      const std::int64_t end = std::min(ys.above(std::max({a.y(), b.y(), c.y()})) + 1, ys.count);
      Crossing crossing;
      for (std::int64_t iy = begin; iy < end; ++iy)
        if (cross(problem, face, x, ys.at(iy), crossing)) crossings[std::size_t(iy)].push_back(crossing);
    }

    sums[ix].resize(count);
    ColumnSum column(problem.lmax, factors);
    const double dx = (x - problem.origin.x()) / problem.reference_radius;
    for (std::size_t iy = 0; iy < crossings.size(); ++iy) {
      auto& list = crossings[iy];
      if (list.empty()) continue;
      std::sort(list.begin(), list.end(), [](const Crossing& p, const Crossing& q) { return p.z < q.z; });
      const double dy = (ys.at(std::int64_t(iy)) - problem.origin.y()) / problem.reference_radius;
      const double rho = std::hypot(dx, dy);
      column.clear();
      int winding = 0;
      for (std::size_t k = 0; k < list.size(); ++k) {
        winding += list[k].step;
        if (winding == 0 || k + 1 == list.size()) continue;
        const std::int64_t end = zs.above(list[k + 1].z);
        for (std::int64_t iz = zs.above(list[k].z); iz < end; ++iz) {
          column.add(rho, (zs.at(iz) - problem.origin.z()) / problem.reference_radius, winding);
          ++cells[ix];
        }
      }
      if (winding != 0)
        throw Error(Fault::check_failed, "a lattice column enters the body more often than it leaves it");
      column.put(rho > 0 ? dx / rho : 1, rho > 0 ? dy / rho : 0, sums[ix].data());
    }
  });

  LatticeMoments result;
  result.spacing = spacing;
  result.columns = std::uint64_t(xs.count) * std::uint64_t(ys.count);
  Multipoles& moments = result.moments;
  moments = Multipoles(problem);
  const double cell_mass = problem.density * spacing * spacing * spacing;
  for (std::size_t ix = 0; ix < sums.size(); ++ix) {
    result.cells += cells[ix];
    for (int l = 0; l <= problem.lmax; ++l)
      for (int m = 0; m <= l; ++m) moments(l, m) += cell_mass * sums[ix][Multipoles::by_degree(l, m)];
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

} // namespace cowgpu::bench

#include "host/moment_terms.hpp"

#include "host/cpu/moment_terms_kernel.hpp"
#include "host/flush_denormals.hpp"
#include "host/geometry/determinant.hpp"
#include "host/parallel.hpp"
#include "host/reference/moments.hpp"

#include <hwy/aligned_allocator.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <numbers>
#include <numeric>

namespace cowgpu {
namespace {

using Doubles = hwy::AlignedFreeUniquePtr<double[]>;

// What is left out lies far below rounding.
constexpr double tolerance = 1e-18;
constexpr std::size_t blocks_at_once = 4; // share one evaluation of the factors, and fit a core's cache

Doubles zeros(std::size_t count) {
  Doubles p = hwy::AllocateAligned<double>(count);
  if (!p) throw std::bad_alloc();
  std::fill_n(p.get(), count, 0.0);
  return p;
}

// Where degree l begins in a partial sum: two doubles an order, rows padded to a multiple of four orders.
std::size_t row_offset(int l) {
  const std::size_t fours = std::size_t(l) / 4, rest = std::size_t(l) % 4;
  return 16 * fours * (fours + 1) + 8 * rest * (fours + 1);
}

// How many partial sums share the blocks: by the problem alone, so that the order of additions is as well.
// They cost more than a few triangles do.
std::size_t partial_sums(const MomentProblem& problem) {
  return problem.faces.size() <= 256 || problem.lmax > 1024 ? 2 : 8;
}

struct Terms {
  std::vector<std::array<double, 10>> inputs; ///< x, y, z of A, B, C over R, and det over the largest
  std::vector<int> last;
  double largest_det = 0; ///< over R^3
};

// By falling last degree.
Terms terms_of(const MomentProblem& problem) {
  const long double r = problem.reference_radius;
  const std::size_t faces = problem.faces.size();
  std::vector<std::array<double, 10>> inputs(faces);
  std::vector<double> sizes(faces), radii(faces);
  Terms terms;
  for (std::size_t t = 0; t < faces; ++t) {
    const Face& face = problem.faces[t];
    const auto& x = problem.vertices;
    long double largest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      long double square = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const long double value = ((long double)(x[face[k]][Eigen::Index(c)]) - problem.origin[Eigen::Index(c)]) / r;
        inputs[t][3 * k + c] = double(value);
        square += value * value;
      }
      largest = std::max(largest, square);
    }
    inputs[t][9] = double(determinant(x[face[0]], x[face[1]], x[face[2]], problem.origin) / r / r / r);
    sizes[t] = std::abs(inputs[t][9]);
    radii[t] = double(std::sqrt(largest));
    terms.largest_det = std::max(terms.largest_det, sizes[t]);
  }
  const std::vector<int> last = reference::last_degrees(std::move(sizes), radii, problem.lmax, tolerance);
  std::vector<std::size_t> order(faces);
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return last[a] > last[b]; });
  for (const std::size_t t : order) {
    if (terms.largest_det > 0) inputs[t][9] /= terms.largest_det;
    terms.inputs.push_back(inputs[t]);
    terms.last.push_back(last[t]);
  }
  return terms;
}

/// One thread's partial sum of its blocks.
class Partial {
public:
  Partial(const Terms& terms, int lmax)
      : terms_(terms), lmax_(lmax), lanes_(cpu::term_lanes()), sums_(zeros(row_offset(lmax + 1))),
        squares_(std::size_t(lmax) + 1, 0.0), root_(2 * std::size_t(lmax) + 2), factors_(3 * stride(), 0.0) {
    for (std::size_t n = 0; n < root_.size(); ++n) root_[n] = std::sqrt(double(n));
    for (std::size_t b = 0; b < blocks_at_once; ++b) rows_.push_back(zeros(stride() * cpu::term_column_doubles()));
    corners_ = zeros(blocks_at_once * 9 * lanes_);
    sizes_ = zeros(blocks_at_once * 6 * lanes_);
    scaled_ = zeros(9 * lanes_);
  }

  /// Blocks first ... first + count - 1, count <= blocks_at_once.
  void add(std::size_t first, std::size_t count, const Monitor& monitor) {
    for (std::size_t b = 0; b < count; ++b) start(b, (first + b) * lanes_);
    for (int l = 1; l <= terms_.last[first * lanes_]; ++l) {
      check_stop(monitor);
      set_factors(l);
      for (std::size_t b = 0; b < count; ++b) {
        if (terms_.last[(first + b) * lanes_] < l) break;
        const double* corners = corners_.get() + b * 9 * lanes_;
        for (std::size_t k = 0; k < 9 * lanes_; ++k) scaled_[k] = corners[k] / l;
        squares_[std::size_t(l)] +=
            cpu::raise_terms(l, {factors_.data(), factors_.data() + stride(), factors_.data() + 2 * stride()},
                             scaled_.get(), rows_[b].get(), sums_.get() + row_offset(l)) +
            raise_sizes(l, b);
      }
    }
  }

  const double* degree(int l) const { return sums_.get() + row_offset(l); }
  double square(int l) const { return squares_[std::size_t(l)]; }

private:
  // Columns of a row, and of the factors, with what is read beyond the last.
  std::size_t stride() const { return std::size_t(lmax_) + 2 * cpu::term_orders; }

  void start(std::size_t b, std::size_t first) {
    const double y00 = 1 / std::sqrt(4 * std::numbers::pi);
    double* rows = rows_[b].get();
    std::fill_n(rows, stride() * cpu::term_column_doubles(), 0.0);
    for (std::size_t lane = 0; lane < lanes_; ++lane) {
      // Lanes beyond the last triangle repeat it without weight.
      const std::size_t t = std::min(first + lane, terms_.inputs.size() - 1);
      const double det = first + lane < terms_.inputs.size() ? terms_.inputs[t][9] * y00 : 0;
      for (std::size_t k = 0; k < 9; ++k) corners_[(b * 9 + k) * lanes_ + lane] = terms_.inputs[t][k];
      for (std::size_t k = 0; k < 3; ++k) rows[2 * k * lanes_ + lane] = det;
      double* sizes = sizes_.get() + b * 6 * lanes_ + lane;
      for (std::size_t k = 0; k < 3; ++k) {
        const double* corner = &terms_.inputs[t][3 * k];
        sizes[k * lanes_] = std::hypot(corner[0], corner[1], corner[2]);
        sizes[(3 + k) * lanes_] = std::abs(det);
      }
      squares_[0] += det * det;
    }
  }

  // Advances a block's s_l by a degree, and adds up (s_l / (8 + l))^2. With a, b, c the corners' distances from the origin,
  // the integral of (a x + b y + c z)^l over a tetrahedron is det l! / (l + 3)! times the sum of all monomials of degree l in them.
  double raise_sizes(int l, std::size_t b) {
    double *sizes = sizes_.get() + b * 6 * lanes_, *sums = sizes + 3 * lanes_, square = 0;
    for (std::size_t lane = 0; lane < lanes_; ++lane) {
      double monomials = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        double& sum = sums[k * lanes_ + lane];
        sum = sizes[k * lanes_ + lane] * sum + monomials;
        monomials = sum;
      }
      square += monomials * monomials;
    }
    return (2.0 * l + 1) / ((8.0 + l) * (8.0 + l)) * square;
  }

  // sqrt(k (l-m)(l+m)), sqrt(k (l-m)(l-m-1))/2, -sqrt(k (l+m)(l+m-1))/2, k = (2l+1)/(2l-1): as in the reference.
  void set_factors(int l) {
    const double k = std::sqrt((2.0 * l + 1) / (2.0 * l - 1));
    double *same = factors_.data(), *above = same + stride(), *below = above + stride();
    for (int m = 0; m <= l; ++m) {
      const double minus = k * root_[std::size_t(l - m)], plus = k * root_[std::size_t(l + m)];
      same[m] = minus * root_[std::size_t(l + m)];
      above[m] = minus * root_[std::size_t(std::max(l - m - 1, 0))] / 2;
      below[m] = -plus * root_[std::size_t(l + m - 1)] / 2;
    }
    for (int m = l + 1; m < l + 1 + cpu::term_orders; ++m) same[m] = above[m] = below[m] = 0;
  }

  const Terms& terms_;
  int lmax_;
  std::size_t lanes_;
  Doubles sums_;
  std::vector<double> squares_, root_, factors_;
  std::vector<Doubles> rows_;
  Doubles corners_, scaled_;
  Doubles sizes_; ///< for each block the corners' distances, and sums of monomials in one, two and three of them
};

} // namespace

MomentTerms moment_terms(const MomentProblem& problem, unsigned threads, const Monitor& monitor) {
  const int lmax = problem.lmax;
  MomentTerms result;
  result.sum = Multipoles(problem);
  result.root.resize(std::size_t(lmax) + 1);
  if (problem.faces.empty()) return result;

  const Terms terms = terms_of(problem);
  const std::size_t lanes = cpu::term_lanes(), blocks = (problem.faces.size() + lanes - 1) / lanes;
  const std::size_t batches = (blocks + blocks_at_once - 1) / blocks_at_once;
  const std::size_t tasks = std::min(batches, partial_sums(problem));
  std::vector<std::unique_ptr<Partial>> partial(tasks);
  parallel_for(threads, tasks, [&](std::size_t task, unsigned) {
    const FlushDenormals flush;
    partial[task] = std::make_unique<Partial>(terms, lmax);
    for (std::size_t b = task; b < batches; b += tasks) {
      const std::size_t first = b * blocks_at_once;
      partial[task]->add(first, std::min(blocks_at_once, blocks - first), monitor);
    }
  });

  const double unit = std::abs(problem.density) * std::pow(problem.reference_radius, 3) * terms.largest_det;
  for (int l = 0; l <= lmax; ++l) {
    const double factor = unit / ((l + 1.0) * (l + 2.0) * (l + 3.0));
    double squares = 0;
    for (const auto& p : partial) squares += p->square(l);
    result.root[std::size_t(l)] = factor * std::sqrt(squares);
    for (int m = 0; m <= l; ++m) {
      double re = 0, im = 0;
      for (const auto& p : partial) {
        re += p->degree(l)[2 * m];
        im += p->degree(l)[2 * m + 1];
      }
      result.sum(l, m) = std::copysign(factor, problem.density) * std::complex(re, m == 0 ? 0.0 : im);
    }
  }
  // Of thin bodies and far origins the sum of all is far smaller than its terms.
  result.sum.values[0] = problem.density *
                         double(sum_of_determinants(problem.vertices, problem.faces, problem.origin)) /
                         (6 * std::sqrt(4 * std::numbers::pi));
  return result;
}

std::uint64_t moment_terms_bytes(const MomentProblem& problem) {
  const std::uint64_t rows = blocks_at_once * (std::uint64_t(problem.lmax) + 8) * 6 * 8 * 8;
  return 16 * Multipoles::count(problem.lmax) + 256 * std::uint64_t(problem.faces.size()) +
         partial_sums(problem) * (8 * row_offset(problem.lmax + 1) + rows + blocks_at_once * 6 * 8 * 8 +
                                  64 * std::uint64_t(problem.lmax) + 4096);
}

} // namespace cowgpu

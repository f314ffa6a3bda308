#include "host/map/solve.hpp"

#include "host/error.hpp"
#include "host/signals.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#include <fmt/format.h>
#include <metis.h>

#include <cmath>
#include <mutex>
#include <type_traits>

namespace cowgpu {

namespace {

using Permutation = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>;
using Factor = Eigen::SimplicialLDLT<SparseMatrix, Eigen::Upper, Eigen::NaturalOrdering<int>>;

// While METIS runs, SIGTERM leads to a handler of its own, which jumps away and calls it a lack of memory. The signal waits for
// the end; and there is one METIS at a time, so that the handlers put back are the program's.
bool order_by_metis(idx_t size, std::vector<idx_t>& begin, std::vector<idx_t>& neighbours, std::vector<idx_t>& order,
                    std::vector<idx_t>& position) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  const HeldSignals until_the_end;
  const KeptAction termination(SIGTERM), abortion(SIGABRT); // METIS puts handlers back for one signal only
  return METIS_NodeND(&size, begin.data(), neighbours.data(), nullptr, nullptr, order.data(), position.data()) ==
         METIS_OK;
}

Permutation nested_dissection(const SparseMatrix& matrix, const std::string& what, const Monitor& monitor) {
  static_assert(std::is_same_v<idx_t, int>, "METIS with 32-bit indices");
  const idx_t size = int(matrix.cols());
  std::vector<idx_t> begin{0}, neighbours, order(matrix.cols()), position(matrix.cols());
  begin.reserve(std::size_t(matrix.cols()) + 1);
  neighbours.reserve(std::size_t(matrix.nonZeros()));
  for (int column = 0; column < size; ++column) {
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry)
      if (entry.row() != column) neighbours.push_back(int(entry.row()));
    begin.push_back(idx_t(neighbours.size()));
  }
  const bool done = order_by_metis(size, begin, neighbours, order, position);
  check_stop(monitor);
  if (!done)
    throw Error(Fault::map_failed,
                fmt::format("METIS could not order the {} unknowns of {}: most likely memory ran out", size, what));
  return Permutation(Eigen::Map<const Eigen::VectorXi>(position.data(), size));
}

Permutation minimum_degree(const SparseMatrix& matrix) {
  Permutation inverse;
  Eigen::AMDOrdering<int>()(matrix.selfadjointView<Eigen::Upper>(), inverse);
  return inverse.inverse();
}

// B - A X in extended precision, and its size against the terms it is made of.
Eigen::MatrixXd remainder(const SparseMatrix& matrix, const Eigen::MatrixXd& x, const Eigen::MatrixXd& right,
                          double& relative) {
  Eigen::MatrixXd left(right.rows(), right.cols());
  relative = 0;
  std::vector<long double> sum(std::size_t(right.rows()));
  std::vector<double> size(std::size_t(right.rows()));
  for (Eigen::Index k = 0; k < right.cols(); ++k) {
    for (Eigen::Index i = 0; i < right.rows(); ++i) {
      sum[std::size_t(i)] = right(i, k);
      size[std::size_t(i)] = std::abs(right(i, k));
    }
    for (int j = 0; j < matrix.cols(); ++j)
      for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
        sum[std::size_t(entry.row())] -= static_cast<long double>(entry.value()) * x(j, k);
        size[std::size_t(entry.row())] += std::abs(entry.value() * x(j, k));
      }
    for (Eigen::Index i = 0; i < right.rows(); ++i) {
      left(i, k) = double(sum[std::size_t(i)]);
      const double ratio = std::abs(left(i, k)) / size[std::size_t(i)];
      if (size[std::size_t(i)] > 0 && !(ratio <= relative)) relative = ratio; // NaN stays
    }
  }
  return left;
}

// One step of refinement. A step that does not help is not taken.
template <class Solve>
Eigen::MatrixXd refined(const SparseMatrix& matrix, const Eigen::MatrixXd& right, const std::string& what,
                        Solve&& solve, double& residual) {
  Eigen::MatrixXd x = solve(right);
  const Eigen::MatrixXd left = remainder(matrix, x, right, residual);
  const Eigen::MatrixXd better = x + solve(left);
  double after = 0;
  remainder(matrix, better, right, after);
  if (after <= residual) {
    x = better;
    residual = after;
  }
  if (!(residual <= residual_limit))
    throw Error(
        Fault::map_failed,
        fmt::format("{} was solved to a relative residual of {:.1e} only, where {:.0e} is asked: the surface has "
                    "triangles too thin for its weights; remove them, or take Tutte weights",
                    what, residual, residual_limit));
  return x;
}

// Of the time of ordering and factorising, by nested dissection, where that is long.
constexpr double ordering_share = 0.5;

} // namespace

struct SymmetricSolver::State {
  SparseMatrix matrix;
  std::string what;
  Ordering ordering;
  Permutation order;
  Factor factor;
  double residual = 0;
};

SymmetricSolver::SymmetricSolver(const SparseMatrix& matrix, std::string what, Ordering ordering, Monitor& monitor)
    : state_(std::make_unique<State>()) {
  if (ordering == Ordering::automatic)
    ordering =
        std::size_t(matrix.cols()) < nested_dissection_from ? Ordering::minimum_degree : Ordering::nested_dissection;
  state_->what = std::move(what);
  state_->ordering = ordering;
  constexpr const char* phase = "solving a linear system";
  monitor.progress(phase, 0);
  if (matrix.cols() > 0)
    state_->order = ordering == Ordering::nested_dissection ? nested_dissection(matrix, state_->what, monitor)
                                                            : minimum_degree(matrix);
  SparseMatrix permuted(matrix.rows(), matrix.cols());
  permuted.selfadjointView<Eigen::Upper>() = matrix.selfadjointView<Eigen::Upper>().twistedBy(state_->order);
  state_->factor.analyzePattern(permuted);
  check_stop(monitor);
  monitor.progress(phase, ordering_share);
  factorise(matrix);
  check_stop(monitor);
  monitor.progress(phase, 1);
}

SymmetricSolver::~SymmetricSolver() = default;
SymmetricSolver::SymmetricSolver(SymmetricSolver&&) noexcept = default;

void SymmetricSolver::factorise(const SparseMatrix& matrix) {
  State& s = *state_;
  s.matrix = matrix;
  SparseMatrix permuted(s.matrix.rows(), s.matrix.cols());
  permuted.selfadjointView<Eigen::Upper>() = s.matrix.selfadjointView<Eigen::Upper>().twistedBy(s.order);
  s.factor.factorize(permuted);
  Eigen::Index bad = 0;
  if (s.factor.info() == Eigen::Success) {
    const Eigen::VectorXd pivots = s.factor.vectorD();
    while (bad < pivots.size() && pivots[bad] > 0 && std::isfinite(pivots[bad])) ++bad;
    if (bad == pivots.size()) return;
  }
  throw Error(
      Fault::map_failed,
      fmt::format("{} ({} unknowns) is singular or not positive definite, so it cannot be solved: the surface has "
                  "triangles too thin for its weights; remove them, or take Tutte weights",
                  s.what, s.matrix.cols()));
}

Eigen::MatrixXd SymmetricSolver::solve(const Eigen::MatrixXd& right, Refinement refinement) {
  State& s = *state_;
  const auto plain = [&](const Eigen::MatrixXd& b) -> Eigen::MatrixXd {
    if (b.rows() == 0) return b;
    return s.order.inverse() * Eigen::MatrixXd(s.factor.solve(Eigen::MatrixXd(s.order * b)));
  };
  if (refinement == Refinement::none) return plain(right);
  return refined(s.matrix, right, s.what, plain, s.residual);
}

double SymmetricSolver::residual() const {
  return state_->residual;
}

Ordering SymmetricSolver::ordering() const {
  return state_->ordering;
}

std::size_t SymmetricSolver::factor_size() const {
  return std::size_t(state_->factor.matrixL().nestedExpression().nonZeros());
}

Eigen::MatrixXd solve_general(const SparseMatrix& matrix, const Eigen::MatrixXd& right, const std::string& what,
                              double* residual) {
  double relative = 0;
  Eigen::MatrixXd x = right;
  if (matrix.cols() > 0) {
    Eigen::SparseLU<SparseMatrix> factor;
    factor.compute(matrix);
    if (factor.info() != Eigen::Success)
      throw Error(Fault::map_failed, fmt::format("{} ({} unknowns) is singular, so it cannot be solved: {}", what,
                                                 matrix.cols(), factor.lastErrorMessage()));
    x = refined(
        matrix, right, what, [&](const Eigen::MatrixXd& b) -> Eigen::MatrixXd { return factor.solve(b); }, relative);
  }
  if (residual != nullptr) *residual = relative;
  return x;
}

} // namespace cowgpu

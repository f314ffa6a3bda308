// Sparse linear systems with several right sides, solved directly.
#pragma once

#include "host/map/laplacian.hpp"
#include "host/monitor.hpp"

#include <memory>

namespace cowgpu {

/// How the unknowns of a symmetric system are ordered to keep its factor sparse.
enum class Ordering {
  automatic,         ///< minimum degree below nested_dissection_from unknowns, nested dissection from there on
  minimum_degree,    ///< Eigen's AMD
  nested_dissection, ///< METIS
};

/// Measured: at 420,000 unknowns AMD takes 3.4 s in all and METIS 3.8 s, at 707,000 16 s and 8.7 s.
inline constexpr std::size_t nested_dissection_from = 500000;

enum class Refinement {
  one_step, ///< and a check of the residual
  none,     ///< for corrections in an iteration that corrects itself
};

/// An LDL^T factorisation of a symmetric positive definite matrix, to be used for many right sides, and for several
/// matrices of one pattern.
class SymmetricSolver {
public:
  /// Orders and factorises. Both triangles of `matrix` must be there. `what` names the system in errors ("the harmonic
  /// system"). Throws Error(map_failed) if a pivot is not positive or not finite, interrupted between the two.
  explicit SymmetricSolver(const SparseMatrix& matrix, std::string what, Ordering ordering = Ordering::automatic,
                           Monitor& monitor = silent_monitor());
  ~SymmetricSolver();
  SymmetricSolver(SymmetricSolver&&) noexcept;

  /// Takes another matrix of the same pattern, and keeps the ordering.
  void factorise(const SparseMatrix& matrix);

  /// X with A X = B. Refined, it throws Error(map_failed) if the residual is larger than
  /// residual_limit.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right, Refinement refinement = Refinement::one_step);

  /// The largest |B - A X| / (|A| |X| + |B|), entry by entry, of the last refined solve: 1e-16 is rounding.
  double residual() const;
  Ordering ordering() const;
  std::size_t factor_size() const; ///< entries below the diagonal

private:
  struct State;
  std::unique_ptr<State> state_;
};

/// X with A X = B for a matrix that is not symmetric (sparse LU with column ordering), with the same refinement, check and
/// errors. `residual` receives the residual as above.
Eigen::MatrixXd solve_general(const SparseMatrix& matrix, const Eigen::MatrixXd& right, const std::string& what,
                              double* residual = nullptr);

/// A solution further off is refused.
inline constexpr double residual_limit = 1e-10;

} // namespace cowgpu

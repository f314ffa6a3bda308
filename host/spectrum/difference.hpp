// How far two sets of coefficients are apart, degree by degree.
#pragma once

#include "host/coefficient_set.hpp"

#include <string>
#include <vector>

namespace cowgpu {

/// Of one field.
struct FieldDifference {
  std::string name;                 ///< name of the first set's field, or its number
  std::vector<double> norm;         ///< norm of degree l of the first, sqrt(sum_m C_lm^2 + S_lm^2), all orders
  std::vector<double> difference;   ///< the same of the difference
  std::vector<int> worst_order;     ///< m where sqrt(dC^2 + dS^2) is largest
  double total_norm = 0, total = 0; ///< over all degrees

  /// difference / norm; 0 where both vanish, infinity where the norm does alone.
  double relative(std::size_t l) const;
  double total_relative() const;

  /// The largest difference of a degree over the largest norm among the degrees l - 2 ... l + 2, and where: what a
  /// tolerance is held against. Degrees that vanish (the dipole about the centre of mass, odd ones of symmetric bodies) are
  /// rounding, and their own norm is no scale.
  double worst = 0;
  int worst_degree = 0;
};

struct CoefficientDifference {
  Convention convention; ///< convention of the norms
  CoefficientKind kind = CoefficientKind::field;
  int lmax = 0;                ///< the smaller of both
  double reference_radius = 0; ///< reference radius of multipoles and potentials
  std::vector<FieldDifference> fields;
  std::vector<std::string> unlike; ///< sentences: what else differs between the sets

  double worst() const; ///< largest difference of all fields
};

/// Both as real coefficients in `convention`, the second one's kind and reference radius changed to the first one's. Degrees
/// that only one of them has are named among `unlike` and not compared. Throws Error(bad_argument) where the sets cannot be
/// compared: other kinds, numbers of fields, or origins farther apart than 1e-12 R (moments about another point are other
/// numbers, and translation is not offered), and what converted() throws.
CoefficientDifference difference(const CoefficientSet& a, const CoefficientSet& b, Convention convention);

} // namespace cowgpu

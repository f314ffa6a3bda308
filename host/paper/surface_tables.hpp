// The paper's tables of a cow's surface over the harmonic map and over the distance's flow, to compare with.
#pragma once

#include "host/spectrum/reconstruct.hpp"

#include <array>
#include <complex>
#include <span>

namespace cowgpu {

/// A row of a table in the paper "Higher multipoles of the cow": coefficients <f|Y_lm>, with
/// Y_lm orthonormal and the Condon-Shortley phase, four decimals.
struct PaperRow {
  int l = 0, m = 0;
  std::array<std::complex<double>, 3> values; ///< f_r, f_dtheta, f_dphi
};

/// Degrees 0 to 3; of the mesh that `benchmark` names.
std::span<const PaperRow> paper_harmonic_table();

/// The same of the distance's gradient flow: its time is not told, 0.2 comes closest (host/flow/fixed_steps.hpp).
std::span<const PaperRow> paper_flow_table();

/// Column by column sqrt(sum |c - t|^2 / sum |t|^2) over the rows with l >= 1, rows with m > 0 counted twice, as they
/// stand for -m too. Throws Error(bad_argument) for an expansion below degree 3.
std::array<double, 3> paper_misfits(const SurfaceExpansion& expansion,
                                    std::span<const PaperRow> table = paper_harmonic_table());

/// Column by column the largest |c - t| of the table, the monopole of f_r among them. Throws the same.
std::array<double, 3> paper_distances(const SurfaceExpansion& expansion,
                                      std::span<const PaperRow> table = paper_harmonic_table());

} // namespace cowgpu

// Moments about an origin that is far from the body: computed near it, then moved.
//
// About an origin at a distance d of many body radii the triangles' tetrahedra are long needles that cancel, and a degree
// loses the digits of d over the body's size. Moved from a point near the body, it loses none: the regular solid harmonics
// R_lm = S_lm / (sqrt((2l+1)/4pi) sqrt((l-m)!(l+m)!)) have the addition theorem (Steinborn and Ruedenberg 1973, "Rotation and
// translation of regular and irregular solid spherical harmonics")
//
//   R_lm(x + d) = sum over k = 0 ... l, j = -k ... k of R_kj(x) R_{l-k,m-j}(d)
//
// and the same holds for the moments. With |Q_k / r^k| <= B_k <= sqrt(2k+1) B_0 the term k adds at most
// sqrt(2l+1) C(l,k) (r/|d|)^k |d|^l B_0 to the norm of degree l, so that a few degrees k are enough.
#pragma once

#include "host/moment_problem.hpp"
#include "host/multipoles.hpp"

#include <optional>
#include <span>
#include <vector>

namespace cowgpu {

/// The same surface about the middle of its box, with its radius there and as many degrees as the given problem's moments need
/// of it, terms below 2^-64 being left out. Nothing where the given origin is nearer than 16 radii, or than lmax/2 radii (the
/// terms then grow before they fall), or lmax is above 800 (factorials leave the range of extended precision).
std::optional<MomentProblem> near_problem(const MomentProblem& far);

/// Moments Q_lm / R^l of `far` from those of near_problem(), in extended precision, real and imaginary parts interleaved.
std::vector<long double> translated(const MomentProblem& far, const MomentProblem& near,
                                    std::span<const long double> moments);
Multipoles translated(const MomentProblem& far, const MomentProblem& near, const Multipoles& moments);

/// What the errors of the near moments' degrees amount to in those of `far`: independent errors of the degrees k, and the terms
/// left out, given B_0.
std::vector<double> translated_error(const MomentProblem& far, const MomentProblem& near, std::span<const double> error,
                                     double bound);

} // namespace cowgpu

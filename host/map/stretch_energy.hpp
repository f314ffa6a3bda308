// How much a map from the sphere to a surface stretches: the energy that the stretch map minimises.
//
// E. Praun, H. Hoppe, Spherical parametrization and remeshing, SIGGRAPH 2003, after P. Sander, J. Snyder, S. Gortler, H.
// Hoppe, Texture mapping progressive meshes, SIGGRAPH 2001: a triangle of area A_S on the surface counts A_S times half
// the sum of the squared singular values of the affine map that takes its image to it. Here the image of (a, b, c) has
// the area A = det(a, b, c)/2 in place of the chord triangle's, which goes to zero where a triangle is about to turn
// over on the sphere: the energy is a barrier against it.
//
//   E = (A_S / 8) (1/A^2 + lambda/A_S^2) N,   N = d_a |b - c|^2 + d_b |c - a|^2 + d_c |a - b|^2,
//
// d_a = (B - A) . (C - A) of the surface's triangle A, B, C, and so on. The term in lambda is the stretch the other way,
// from the surface to the sphere, on the surface's area.
#pragma once

#include "host/types.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace cowgpu {

/// What the surface's triangle has in the energy E = N (forward/A^2 + backward).
struct StretchWeights {
  std::array<double, 3> dot; ///< d_a, d_b, d_c
  double forward, backward;
};

/// From the squared lengths of the sides opposite to A, B, C, on a surface of total area 4 pi. Degenerate triangles are
/// made harmless, so that each stays a barrier: `softening` is added to each square (as if the corners left the plane, in
/// directions of their own), A_S counts as 1e-4 of the longest square at least, and as 1e-2 of it under lambda.
StretchWeights stretch_weights(double side_a, double side_b, double side_c, double lambda, double softening = 1e-10);
inline StretchWeights stretch_weights(const Vec3& a, const Vec3& b, const Vec3& c, double lambda) {
  return stretch_weights((b - c).squaredNorm(), (c - a).squaredNorm(), (a - b).squaredNorm(), lambda);
}

/// The energy of one triangle on the unit sphere, infinite unless det(a, b, c) > 0.
double stretch_energy(const StretchWeights& weights, const Vec3& a, const Vec3& b, const Vec3& c);

/// With derivatives along the sphere: the corners move to the normalised x + p t1 + q t2, where row 0 and 1 of a frame are
/// t1 and t2 and row 2 is x itself. Unknowns are (p, q) of a, of b, of c. det(a, b, c) > 0.
using Frame = Eigen::Matrix3d;
struct StretchDerivatives {
  double energy;
  Eigen::Matrix<double, 6, 1> gradient;
  Eigen::Matrix<double, 6, 6> hessian;
};
StretchDerivatives stretch_derivatives(const StretchWeights& weights, const std::array<Frame, 3>& frames);

/// Right-handed, with x (a unit vector) in row 2.
Frame tangent_frame(const Vec3& x);

/// The triangles round one vertex, as functions of where it goes: to the normalised x + p t1 + q t2 about a centre x.
class Star {
public:
  /// About the centre x: ring[i], ring[i+1] are the other corners of triangle i on the sphere, and weights[i] its
  /// weights, d_a that of the moving corner. The centre need not be where the vertex is.
  void set(const Vec3& x, std::span<const Vec3> ring, std::span<const StretchWeights> weights);

  /// The sum of the energies, infinite if a triangle is no longer positively oriented by more than rounding.
  double energy(double p, double q) const;
  /// At (0, 0).
  double derivatives(Eigen::Vector2d& gradient, Eigen::Matrix2d& hessian) const;
  /// One Newton step from (0, 0) with Armijo's rule. `energy_here` is energy(0, 0). Gives the new (p, q); false if
  /// nothing lower was found.
  bool newton_step(Eigen::Vector2d& to) const;

  Vec3 position(double p, double q) const;
  /// Coordinates (p, q) of the direction y (not opposite to x).
  Eigen::Vector2d coordinates(const Vec3& y) const;
  /// Direction at x, along t1 and t2, of the great circle to y; of any length.
  Eigen::Vector2d direction(const Vec3& y) const { return frame_.topRows<2>() * y; }
  /// The distance from the centre to the nearest corner of the ring that does not coincide with it.
  double nearest() const { return nearest_; }

private:
  struct Wedge {
    double area, area_p, area_q;             // A = (area + p area_p + q area_q) / s, s = sqrt(1 + p^2 + q^2)
    double form, form_p, form_q, form_delta; // N = form + form_p p/s + form_q q/s + form_delta (1 - 1/s)
    double forward, backward, least_area;
  };
  Frame frame_;
  double nearest_ = 0;
  std::vector<Wedge> wedges_;
  std::vector<std::array<double, 3>> local_;
};

} // namespace cowgpu

// The exact gravity of polyhedra of uniform density, inside and outside.
#pragma once

#include "host/mesh/body.hpp"
#include "host/monitor.hpp"
#include "host/potential.hpp"
#include "host/types.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::physics {

using LongVec3 = Eigen::Matrix<long double, 3, 1>;
using LongMatrix3 = Eigen::Matrix<long double, 3, 3>;

/// V = integral of 1/|x - p| over the inside, each point counted as often as the surface winds about it, and its derivatives.
struct PolyhedronAt {
  long double value = 0;
  LongVec3 gradient = LongVec3::Zero();
  LongMatrix3 hessian = LongMatrix3::Zero(); ///< on a face the mean of both sides'; infinite on edges
  long double winding = 0; ///< winding number about the point, -(trace of the hessian)/4 pi; on a face the mean
  bool on_edge = false;    ///< or on a vertex, where faces that meet there are not coplanar: the hessian leaves it out
};

/// Estimates of absolute errors of V, of its gradient (a norm) and of its second derivatives.
struct FieldError {
  long double value = 0, gradient = 0, hessian = 0;
};

/// R. A. Werner and D. J. Scheeres, Exterior gravitation of a polyhedron derived and compared with harmonic and mascon
/// gravitation representations of asteroid 4769 Castalia, Celest. Mech. Dyn. Astron. 65 (1997) 313: with the solid angle w_f
/// of each face (eq. 6), L_e = ln((a + b + e)/(a + b - e)) of each edge (eq. 7), and vectors r from the point to them,
///   V = sum r E r L_e / 2 - sum r F r w_f / 2,  grad V = -sum E r L_e + sum F r w_f,  dd V = sum E L_e - sum F w_f
/// (eqs. 10, 15, 16), F the dyad n n of a face and E the sum of n n_e over the faces at an edge. 80-bit arithmetic, since
/// these sums cancel like (distance/size)^2.
class Polyhedron {
public:
  /// A closed surface; edges with more than two faces, cavities and faces without area may occur.
  Polyhedron(std::span<const Vec3> vertices, std::span<const Face> faces);

  /// Room for at(), one for each thread.
  struct Scratch {
    std::vector<LongVec3> to;
    std::vector<long double> distances;
  };

  /// `point` in mesh coordinates. What is nearer to a face or an edge than the rounding of coordinates is on it: there value
  /// and gradient have their limits.
  PolyhedronAt at(const LongVec3& point, Scratch& scratch) const;
  PolyhedronAt at(const Vec3& point) const;

  /// Rounding of at() at points no farther than `reach` from each vertex: every edge adds r E r L_e/2 ~ reach e/2 and E r L_e ~ e,
  /// right to some units in the last place of an 80-bit number (more where the normals at the edge are those of needles),
  /// whose errors add like those of a random walk. On bodies of size e V is about e^3/reach, so that of V a part of
  /// (reach/e)^2 units is lost.
  FieldError rounding(long double reach) const;

private:
  struct Edge {
    std::uint32_t from, to;
    long double length;
    LongVec3 direction;
    LongMatrix3 dyad;
    bool flat;            // its dyad is zero but for rounding
    long double rounding; // rounding of the dyad, in units of the last place
  };
  struct Side {
    std::array<std::uint32_t, 3> corners;
    LongVec3 normal;
    long double double_area;
  };
  void add_edge(const Edge& edge, const Scratch& scratch, long double tolerance, PolyhedronAt& sum) const;
  static void add_side(const Side& side, const Scratch& scratch, long double tolerance, PolyhedronAt& sum);

  std::vector<LongVec3> vertices_;
  std::vector<Edge> edges_;
  std::vector<Side> sides_;
  long double size_ = 0;   // largest coordinate
  long double spread_ = 0; // root of the sum of (rounding times length)^2 of the edges
};

/// A body's field at many points.
struct ExactField {
  PotentialField field;        ///< V = integral of density/|x - p| and what else was asked for
  std::vector<double> density; ///< that the body has at each point: -(trace of dd V)/4 pi; on a face the mean
  /// 1 where the series of FarField has the smaller error, and was taken: far away, and beside very thin bodies.
  std::vector<std::uint8_t> by_series;
  /// Largest estimated error, of V by |V| and of the gradient by the larger of its norm and |V| over the distance from the
  /// body's middle; at least the rounding of the doubles it is given in.
  double error = 0;
};

/// At points in mesh coordinates, the body's parts added with their densities, on `threads` threads (0: all); each point by
/// the closed form or by the series, whichever is estimated to be nearer to the truth. What is smaller than doubles hold is
/// 0. Throws Error(point_singular) where second derivatives are asked for on an edge, bad_argument for points that are not finite,
/// interrupted.
ExactField exact_field(const Body& body, std::span<const Vec3> points, Derivatives derivatives, unsigned threads,
                       Monitor& monitor);

/// Upper bound of the bytes exact_field() allocates, its result included.
std::uint64_t exact_field_bytes(const Body& body, std::uint64_t points, unsigned threads);

} // namespace cowgpu::physics

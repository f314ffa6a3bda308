// The body again, from the spherical-harmonic coefficients of its surface.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/spectrum/directions.hpp"

#include <span>
#include <string>
#include <vector>

namespace cowgpu {

/// Which fields a surface is built from.
enum class SurfaceFields {
  xyz, ///< x, y, z
  f,   ///< f_r, f_dtheta, f_dphi
};

/// Coefficients of a surface F over the sphere of directions (theta, phi) of a map, as the expansions of result files
/// hold them.
struct SurfaceExpansion {
  /// Six fields: f_r = |F - origin|, f_dtheta = theta(F - origin) - theta and f_dphi = phi(F - origin) - phi in radians,
  /// their means removed; then x, y, z of F in mesh coordinates. Lengths in the mesh's unit.
  SphereCoefficients coefficients{0, 6};
  Vec3 origin = Vec3::Zero();            ///< mesh coordinates
  double mean_dtheta = 0, mean_dphi = 0; ///< what was removed, radians
  bool signed_dphi = true; ///< false: |dphi| was expanded, as in the paper's table; no surface comes of it
};

/// The radius of the spherical cow: the mean distance of F from the origin, f_r00 / sqrt(4 pi).
double spherical_radius(const SurfaceExpansion& expansion);

/// What order `order` is, in a sentence for the user: order 0 is the sphere about the origin by definition, because the
/// x, y, z expansion is a point there and starts at order 1.
std::string describe_order(const SurfaceExpansion& expansion, SurfaceFields fields, int order);

/// Unit vectors and triangles between them, counter-clockwise seen from outside.
struct SphereTriangulation {
  std::vector<Vec3> directions;
  std::vector<Face> faces;
};
/// An icosahedron cut `level` times (0 to 9): 20 4^level triangles of nearly one size.
SphereTriangulation icosphere(int level);
/// The points of a Clenshaw-Curtis grid, whose rings at the poles become one vertex each: the first and the last. The
/// others follow ring by ring. Throws Error(bad_argument) for another kind of grid and fewer than 3 points a ring.
SphereTriangulation triangulation(const SphereGrid& grid);

/// The surface of degrees 0 to `order` at `directions`, where each becomes the vertex of its index, with vertex normals.
/// Order 0 is the sphere of spherical_radius() about the origin, whatever the fields. O(order^2) per direction, on
/// `threads` threads (0: all). Throws Error(bad_argument) for an order that is negative or above the expansion's lmax,
/// coefficients of other than six fields, fields f of |dphi|, or a direction that is zero; interrupted.
TriangleSurface reconstruct(const SurfaceExpansion& expansion, SurfaceFields fields, int order,
                            const SphereTriangulation& sphere, unsigned threads, Monitor& monitor);

/// The same on triangulation(grid), through the backend's transform; grid.lmax must be at least `order`.
TriangleSurface reconstruct(const SurfaceExpansion& expansion, SurfaceFields fields, int order, const SphereGrid& grid,
                            Backend& backend, Monitor& monitor);

/// Size and shape of the smooth surface of one order, density 1.
struct SurfaceMeasures {
  double volume = 0;                  ///< signed: negative where the map turns the surface inside out
  Vec3 centre_of_mass = Vec3::Zero(); ///< mesh coordinates; not finite where the volume is 0
  Eigen::Matrix3d inertia =
      Eigen::Matrix3d::Zero(); ///< integral of (r^2 delta_ij - x_i x_j) about the expansion's origin
};

/// For x, y, z by the divergence theorem over the smooth surface itself, not over triangles: with P = F - origin and
/// p = P . (dF/dtheta x dF/dphi) / sin theta, the integrals over the sphere of p/3, p P/4 and p P P^T/5 are volume, first
/// and second moment: polynomials of degree 3, 4 and 5 times the order, for which the Gauss-Legendre grid of degree 5/2
/// order is exact up to rounding (to order 3276; above, grids end).
///
/// For f the surface has a hole about either pole, a circle, closed here by a flat disk; reconstruct() tends to the same
/// body. It is measured as two polyhedra, on grids of degree 2 order and 4 order (64 and 128 at least), and extrapolated
/// to degree infinity; the error falls with the fourth power of the degree.
///
/// Overlaps count as often as the surface winds round them. Throws what reconstruct() throws.
SurfaceMeasures measure(const SurfaceExpansion& expansion, SurfaceFields fields, int order, Backend& backend,
                        Monitor& monitor);

} // namespace cowgpu

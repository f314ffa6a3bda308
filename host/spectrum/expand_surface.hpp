// A surface's spherical-harmonic coefficients, over the sphere that a map gives it.
#pragma once

#include "host/map/sphere_map.hpp"
#include "host/spectrum/reconstruct.hpp"

#include <array>
#include <functional>
#include <vector>

namespace cowgpu {

/// The names of SurfaceExpansion's fields, in their order.
inline constexpr std::array surface_field_names = {"f_r", "f_dtheta", "f_dphi", "x", "y", "z"};

struct ExpandSurfaceOptions {
  int lmax = 0;               ///< 0 to largest_surface_degree
  Vec3 origin = Vec3::Zero(); ///< origin of f_r, f_dtheta and f_dphi, in mesh coordinates
  /// Look a direction up at the closest point of the chord triangles (closest_point.hpp), not along the ray
  /// (SphereSampler).
  bool closest_point = false;
  bool signed_dphi = true; ///< false: expand |f_dphi|, as the paper's table does
  int grid_degree = 0;     ///< degree of the grid sampled on, at least 2 lmax; 0: surface_grid_degree(lmax)
  /// Expand once more on the grid of half the degree, with a quarter of the points, for ExpandSurfaceReport::aliasing.
  bool estimate_aliasing = false;
};

/// Fields are sampled on a grid of twice the degree.
inline constexpr int largest_surface_degree = largest_grid_degree / 2;

/// The degree of the grid that a surface is sampled on: 2 lmax, but no less than this. Fields of a mesh are not
/// band-limited, and on the smallest grids aliasing would decide even the leading coefficients (by 6 % at lmax 3).
inline constexpr int least_surface_grid_degree = 256;
int surface_grid_degree(int lmax);

/// What came of an expansion beside the coefficients.
struct ExpandSurfaceReport {
  int rings = 0, ring_length = 0;
  std::size_t faces_hit = 0;       ///< faces that any point of the grid lies in
  std::size_t flipped_faces = 0;   ///< faces of the map with det(a, b, c) < 0: nearly all if it is inside-out
  std::size_t folded_points = 0;   ///< points inside more than one triangle; 0 with closest_point
  std::size_t exact_decisions = 0; ///< as in SphereSamples
  double sample_seconds = 0, analyse_seconds = 0; ///< wall time; the estimate of aliasing is in neither
  /// [degree][field]: norm sqrt(sum over m = -l ... l of |a_lm - a'_lm|^2), a' from the coarser grid. Fields of a mesh are
  /// not band-limited; this bounds what aliasing leaves in a as long as refining the grid lowers it. Empty if not asked for.
  std::vector<std::array<double, 6>> aliasing;
  /// [degree l][field]: the root mean square over the sphere of the field less its degrees 0 to l, by Parseval's equation:
  /// sqrt((integral of f^2 - sum over l' <= l of S_l') / 4 pi), the means of the angles among degree 0. The integral is
  /// the grid's, so that this is the root mean square at its points; what is below 3e-8 of the whole is rounding.
  std::vector<std::array<double, 6>> truncation;
};

/// The values of all six fields on a grid, [field][ring][longitude], from any map (host/spectrum/surface_fields.hpp); it may
/// say in the report what it met.
using SurfaceSampler = std::function<std::vector<double>(const SphereGrid& grid, ExpandSurfaceReport& report)>;

/// Samples on the Gauss-Legendre grid of surface_grid_degree(lmax), removes the mean of the two angles, and analyses all six fields to
/// lmax. Of the options, closest_point is the sampler's business, and so are the origin and the sign, which are only noted.
/// Throws Error(bad_argument) for lmax out of range or an origin that is not finite, and what the sampler and
/// sphere_transform throw.
SurfaceExpansion expand_surface(const SurfaceSampler& sampler, const ExpandSurfaceOptions& options, Backend& backend,
                                Monitor& monitor, ExpandSurfaceReport* report = nullptr);

/// Samples the map on the Gauss-Legendre grid of surface_grid_degree(lmax); interpolates the position F linearly in the triangles;
/// forms f_r = |F - origin|, f_dtheta = theta(F - origin) - theta and f_dphi = phi(F - origin) - phi wrapped to (-pi, pi],
/// x, y, z; removes the mean of the two angles; and analyses all six to lmax. The angles are 0 where F is the origin.
///
/// `faces` and `vertices` are the mesh's; the map has a position for each vertex. Throws Error(bad_argument) for lmax out
/// of range, an origin that is not finite or a map of another mesh, and what SphereSampler and SphereTransform throw.
SurfaceExpansion expand_surface(std::span<const Vec3> vertices, std::span<const Face> faces, const SphereMap& map,
                                const ExpandSurfaceOptions& options, Backend& backend, Monitor& monitor,
                                ExpandSurfaceReport* report = nullptr);

/// Upper bound of the memory that takes, its result included.
MemoryNeed expand_surface_memory(std::uint64_t faces, int lmax, const Backend& backend);

} // namespace cowgpu

// Expansions of a surface over the map that the distance's flow makes of it.
#pragma once

#include "host/flow.hpp"
#include "host/flow/cell_means.hpp"
#include "host/flow/level_set.hpp"
#include "host/flow/sheets.hpp"
#include "host/flow/star_shape.hpp"
#include "host/flow/sutures.hpp"
#include "host/mesh/raw_mesh.hpp"
#include "host/spectrum/expand_surface.hpp"

namespace cowgpu {

/// The directions of flowed vertices from `origin`: method flow. Throws Error(map_failed) for a vertex that came to the
/// origin itself.
SphereMap direction_map(std::span<const Vec3> positions, const Vec3& origin);

/// f_00 of f_r = |F - origin| (orthonormal) that the flow's map tends to as the time grows: then every direction holds the
/// vertex that is farthest along it, a corner of the convex hull, so that f_00 = sum over these of |v - origin| times the
/// solid angle of its normal cone, over sqrt(4 pi). Exact but for rounding. Throws Error(bad_argument) for vertices in one plane.
double monopole_at_large_times(std::span<const Vec3> vertices, const Vec3& origin);

/// The mesh's vertices along their normals for `time` in steps of about `step` (host/flow/fixed_steps.hpp), seen from the
/// origin. Expand with ExpandSurfaceOptions::closest_point and without signed_dphi.
SphereMap stepped_flow_map(const RawMesh& mesh, const Vec3& origin, double time, double step, Backend& backend,
                           Monitor& monitor);

/// Where the level set's map jumps and how slowly its coefficients fall because of that (host/flow/sutures.hpp).
struct LevelSetSutures {
  SutureReport jumps;               ///< on the finest grid; none of a radial function, which is continuous
  double threshold = 0;             ///< of them: 0.04 of the bounding box's diagonal
  int slope_from = 0, slope_to = 0; ///< degrees; 0 where lmax is below 32: no slopes
  /// By field (surface_field_names): of log(S_l / (2 l + 1)) over log l; NaN where a degree has no power.
  std::array<double, 6> slopes{};
};

/// Expands the level set's map (host/flow/level_set.hpp); the options' closest_point means nothing here. `time` 0 takes the
/// star-shape time's upper bound, looked for to usual_star_shape_tolerance(); where that is given up, to what was proven, and a note says
/// so. Of the options, grid_degree 0 is max(1024, 2 lmax), and aliasing is estimated whether asked for or not.
struct LevelSetExpansion {
  SurfaceExpansion expansion;
  ExpandSurfaceReport report;
  LevelSetReport level_set;
  StarShapeTime star; ///< looked for even where the time is given
  double time = 0;    ///< T
  /// [degree][field]: the largest over m of what a coefficient is off by. 1.4 times the largest difference from two
  /// turned grids of half the degree, or a third of what one of them differs by from a grid of a quarter, among the fields of
  /// one kind (lengths, angles) and the two degrees on either side; and
  /// what rounding does, what spikes leave open that the grid does not resolve (CellMeansReport), what the bounds of the
  /// star-shape time leave open where the time is that, and `unsettled`. The means
  /// of the angles, as coefficients, are among degree 0.
  std::vector<std::array<double, 6>> uncertainty;
  /// Likewise what directions leave open that did not settle on the level set, were they anywhere on the surface.
  std::vector<std::array<double, 6>> unsettled;
  /// A sentence if that is more than the grid leaves and than four digits show: the coefficients are then not to be used.
  std::string failure;
  LevelSetSutures sutures;
  CellMeansReport averaged;       ///< on the finest grid
  std::vector<std::string> notes; ///< sentences for the user
};

LevelSetExpansion expand_level_set(const RawMesh& mesh, double time, const ExpandSurfaceOptions& options,
                                   Backend& backend, Monitor& monitor);

/// Signed sheets at a time, on the mesh cut at its edges' midpoints 0 ... `refinements` times.
struct SheetExpansion {
  SurfaceExpansion expansion; ///< extrapolated
  ExpandSurfaceReport report; ///< of the finest
  /// [degree][field]: of the expansion, the largest over m. What the last two extrapolations differ by, half the last
  /// refinement's change, and what the grid of half the degree gives differently, whichever is most, and what rounding of
  /// the coordinates does.
  std::vector<std::array<double, 6>> uncertainty;
  std::vector<SphereCoefficients> levels; ///< of each refinement, means of the angles included
  std::vector<SheetReport> sheets;
  FlowReport flow; ///< of the finest mesh's vertices, which hold those of the others
};

/// Degree of the grid that sheets are counted on unless the options name another: 1024, or surface_grid_degree(lmax).
int sheets_grid_degree(int lmax);

/// The sutures make the error fall by about half with each refinement, so a is extrapolated as 2 a_k - a_(k-1). The flow
/// goes by events at `tolerance`. Of the options, grid_degree 0 is max(1024, 2 lmax). Throws Error(bad_argument) for refinements outside 1 ... 5 or time <= 0.
SheetExpansion expand_sheets(const RawMesh& mesh, double time, int refinements, double tolerance,
                             const ExpandSurfaceOptions& options, DistanceFlow& flow, Backend& backend,
                             Monitor& monitor);

} // namespace cowgpu

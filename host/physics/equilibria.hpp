// All places where a particle stays at rest on or about a spinning body, inside it too.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/body.hpp"
#include "host/monitor.hpp"
#include "host/physics/equilibrium_stability.hpp"
#include "host/physics/spinning_field.hpp"
#include "host/types.hpp"

#include <cstdint>
#include <vector>

namespace cowgpu::physics {

struct EquilibriaProblem {
  double constant = 1; ///< G in the body's units
  Spin spin;
  /// Cells are refined down to this half diagonal, in radii of the ball of the body's volume.
  double smallest = 1e-4;
  /// As many places are looked at, at most.
  std::uint64_t most_places = 1'000'000;
  /// Of the field in the search, as PolyhedronProblem has it; it counts among the bounds. Equilibria themselves are those of
  /// direct sums.
  double tolerance = 1e-9;
};

/// Where grad W = 0, W = G V + w^2 r^2/2.
struct Equilibrium {
  Vec3 at = Vec3::Zero(); ///< in mesh coordinates
  double jacobi = 0;      ///< -W there: the least Jacobi constant v^2/2 - W of what comes there
  double residual = 0;    ///< |grad W| that is left
  bool inside = false;
  double density = 0;                                 ///< of the body there; 0 outside
  double depth = 0;                                   ///< distance from the nearest surface
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero(); ///< dd W
  SmallMotions motions;
  /// Radius of the ball about it where it is shown to be the only one; 0: not shown.
  double alone_within = 0;
};

/// Cells next to each other that the bounds do not decide at the smallest size: an equilibrium may be missing there.
struct UndecidedPlace {
  Vec3 centre = Vec3::Zero(); ///< in mesh coordinates
  double radius = 0;          ///< of the ball about it that holds them
  std::uint64_t cells = 0;
  bool ring = false;       ///< they go round the spin's axis
  std::uint64_t found = 0; ///< equilibria among them
};

struct Equilibria {
  std::vector<Equilibrium> points; ///< from the innermost, by distance from the centre of mass
  std::vector<UndecidedPlace> undecided;
  std::uint64_t places = 0; ///< looked at: cells
  std::uint64_t undecided_cells = 0;
  double smallest_cell = 0; ///< half diagonal that cells were refined to where it took that
  bool exhausted = false;   ///< most_places ended the search
  double farthest = 0;      ///< there is none farther than this from the spin's axis,
  double low = 0, high = 0; ///< and none below and above these along it, from the point that this goes through
  int largest_winding = 1;  ///< of a surface about one of the places
  int index_sum = 0;        ///< sum of the signs of det dd W over `points`: -1 of all (Poincare and Hopf)

  /// No cell is left undecided, none of the points is degenerate and the signs add up: all of them are known.
  bool complete() const;
};

/// Where the spin's centrifugal term takes over, sqrt^3(G M/w^2): a particle far enough from all details of the body would stay
/// above one place on this circle. 0 without spin.
double synchronous_radius(const Body& body, double constant, const Spin& spin);

/// Upper bound of what equilibria() allocates.
MemoryNeed equilibria_memory(const Body& body, const EquilibriaProblem& problem, const Backend& backend);

/// By cells, boxes that hold all places where grad W can vanish: between the lowest and the highest vertex along the spin's axis,
/// beyond which gravity pulls back; and no farther from it than where w^2 r exceeds any pull of the mass, G M/(r - b)^2 with b
/// the largest distance of a vertex from the axis. Each cell's centre has its grad W, dd W and distance from the surface. A cell
/// is excluded where the bounds of host/physics/equilibrium_bounds.hpp keep grad W from 0; Newton's method starts from cells
/// whose linear field vanishes near by; what is found is the only one in a ball where dd W cannot become singular, and cells
/// within are done. Others are cut in up to eight. Beside the surface dd W jumps, and by faces' edges it has no bound: there
/// the first bound decides alone, and an equilibrium within a part of the smallest cell of the surface stays undecided.
///
/// The index of grad W on the boundary of that region is -1, so that the signs of det dd W at all equilibria add up to -1,
/// and where none is degenerate there is an odd number of them.
///
/// Throws Error(bad_argument) for a body that has no mass or less than nothing somewhere, for a smallest size that is not from
/// 1e-8 to 0.1, fewer than 1000 places, a constant that is not above 0; what SpinningField throws.
Equilibria equilibria(const Body& body, const EquilibriaProblem& problem, const Backend& backend, Monitor& monitor);

} // namespace cowgpu::physics

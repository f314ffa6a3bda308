// Which cells of faces act on which cells of points, how, and what is left out: the far field's middle.
#pragma once

#include "host/plan/polyhedron_sources.hpp"
#include "host/plan/polyhedron_tree.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// How much of A one pair may leave out.
struct PairTolerance {
  double tau = 0;   ///< for a target leaf near the body; larger cells may leave out (places/largest leaf)^(-1/4) of it
  double reach = 1; ///< from the body's origin; beyond it tau falls as its square over the distance's
  std::uint32_t largest_leaf = 64; ///< of the targets
};

/// A multipole expansion taken to a local one to this order, and a bound of what A loses by it anywhere in the target.
struct FarPair {
  int order;
  double bound;
};

/// The least order at which the bound of a pair is below its share of the tolerance; none where no order is enough, or the
/// cells are too near. With N_l the source's norms, A its reach, P its order, s and t the radii, d the distance of the centres,
/// x = 1/(d - t), what order p loses of A is at most
///   sum over p < l <= P of N_l x^(l+1) + A x^(P+2)/(1 - s x) + sum over j > p of t^j sum over l <= P of C(l+j, l) N_l/d^(l+j+1):
/// multipoles of degree l > P are at most those of faces at the source's rim; the matrix that takes degree l to degree j has
/// its norm in its entry m = 0. Rounding is not covered.
std::optional<FarPair> far_pair(const PolyhedronSources& sources, std::uint32_t source, const TreeCell& target,
                                const PairTolerance& tolerance);

/// A bound of what a cell's multipoles lose of A at so large a distance from its centre; infinite within its ball.
double multipole_bound(const PolyhedronSources& sources, std::uint32_t source, double distance);

/// From here on the multipoles of all faces together keep the tolerance, and lose no digits as closed forms do far away.
double far_distance(const PolyhedronSources& sources, const PairTolerance& tolerance);

/// A share of the field at a task's points. Cells are indices of the trees.
struct CellPair {
  std::uint32_t source, target;
};

/// What happens in one task: a subtree of the points, whose cells are first ... last - 1.
struct TaskPairs {
  std::uint32_t first = 0, last = 0;
  std::vector<std::vector<CellPair>> to_locals; ///< [order]
  std::vector<CellPair> at_points;              ///< multipoles at each point of a leaf; leaves ascend
  std::vector<CellPair> near;                   ///< a leaf's faces at the points of a leaf; leaves ascend
  std::vector<double> bound;                    ///< [cell - first]: of A, at any of its points
  double largest_bound = 0;
  std::uint64_t near_faces = 0; ///< pairs of a face and a point in `near`

  /// The entries of `of` for a leaf.
  static std::span<const CellPair> of_leaf(const std::vector<CellPair>& of, std::uint32_t leaf);
};

/// `points` are in the order of the targets' tree. Fills `found`, which keeps its memory from call to call.
void find_pairs(const PolyhedronSources& sources, const PlaceTree& targets, std::span<const Vec3> points,
                std::uint32_t task, const PairTolerance& tolerance, TaskPairs& found);

/// The roots of the largest subtrees with at most `points` places.
std::vector<std::uint32_t> point_tasks(const PlaceTree& targets, std::uint32_t points);

} // namespace cowgpu::plan

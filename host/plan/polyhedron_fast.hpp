// The fast sum of the stage `polyhedron`, what both paths share: faces far away by multipoles, those near by their closed forms.
//
// L. Greengard and V. Rokhlin, A new version of the fast multipole method for the Laplace equation in three dimensions, Acta
// Numerica 6 (1997) 229; with trees on faces and points, exact moments of faces, and an order for each pair of cells that its
// bound asks for (host/plan/polyhedron_pairs.hpp). The cost is in proportion to faces plus points. A path sums the near faces,
// and takes multipoles to local expansions.
#pragma once

#include "host/monitor.hpp"
#include "host/plan/polyhedron.hpp"
#include "host/plan/polyhedron_far.hpp"
#include "host/plan/polyhedron_settings.hpp"
#include "host/polyhedron.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// A body's multipoles: all that does not depend on points but the near faces.
struct FastBody {
  FastBody(const PolyhedronProblem& problem, const FastSettings& settings, unsigned threads, Monitor& monitor);

  double unit, touching; ///< polyhedron_unit(), touching_distance() in units
  Translations translations;
  PolyhedronSources sources;

  static std::uint64_t bytes(const PolyhedronProblem& problem, const FastSettings& settings);
  static std::uint64_t bytes_while_made(const PolyhedronProblem& problem, const FastSettings& settings,
                                        unsigned threads);
};

/// The faces of the leaves of a body's tree.
struct LeafFaces {
  LeafFaces(const PolyhedronProblem& problem, const PolyhedronSources& sources);

  std::vector<std::uint32_t> starts;
  std::vector<Vec3> centres;
  std::vector<std::uint8_t> sharp;
};

/// The points of a call, in a tree whose leaves have so many at most.
struct FastPoints {
  /// Throws Error(bad_argument) for points that are not finite, too_large for more than 2^32.
  FastPoints(const PolyhedronProblem& problem, const FastSettings& settings, const FastBody& body,
             std::span<const Vec3> points, std::uint32_t largest_leaf, unsigned threads);

  std::vector<std::uint32_t> farthest; ///< so far away that the body is a point
  std::vector<std::uint32_t> far;      ///< where the multipoles of all faces together are enough
  std::optional<PlaceTree> targets;    ///< the others; `order` has indices of all points
  std::vector<Vec3> points;            ///< the tree's points in its order, in units
  std::vector<std::uint32_t> tasks;    ///< roots of subtrees
  PairTolerance tolerance;
  double limit; ///< largest bound of the gradient's truncation that is allowed where it is guaranteed, in units

  static std::uint64_t bytes(std::uint64_t points, std::uint32_t largest_leaf);
  static std::uint64_t bytes_while_made(std::uint64_t points);
};

/// Throws Error(bad_argument) for a tolerance that is not that of a fast sum.
void check_fast(const PolyhedronProblem& problem);

/// The pairs of a task, and where it is guaranteed so that no bound is above the limit.
void find_task_pairs(const PolyhedronProblem& problem, const FastBody& body, const FastPoints& points,
                     std::uint32_t task, TaskPairs& pairs);

/// Adds a task's work to the report: elements, pairs and multiply_adds.
void count_task(const FastBody& body, const TaskPairs& pairs, RunReport& report);

/// The values of the points that are far and farthest.
void set_far_points(const PolyhedronProblem& problem, const FastBody& body, const FastPoints& points,
                    std::span<const Vec3> all, unsigned threads, Monitor& monitor, PolyhedronValues& values);

/// One leaf of the targets in columns, filled up with its last point to a multiple of `group`.
struct LeafColumns {
  std::size_t count;    ///< of a column
  const double* points; ///< [3][count], aligned to 64 bytes
  double* sums;         ///< [row][count], the same: zeros
};
class LeafRoom {
public:
  LeafColumns columns(const FastPoints& points, const TreeCell& leaf, std::size_t group, std::size_t rows);

private:
  struct alignas(64) Line {
    double values[8];
  };
  std::vector<Line> points_, sums_;
};

/// The sums of a leaf, in PolyhedronRows, to its points' values.
void store_leaf(const PolyhedronProblem& problem, const FastBody& body, const FastPoints& points,
                const TaskPairs& pairs, std::uint32_t leaf, const LeafColumns& columns, PolyhedronValues& values);

/// Upper bounds of the bytes of one task at a time, of so many points, and of a call's values.
std::uint64_t task_bytes(std::uint64_t points, std::uint32_t largest_leaf, const FastSettings& settings);
std::uint64_t fast_value_bytes(const PolyhedronProblem& problem, std::uint64_t points);

/// The fast sum or the direct one, whichever takes less time for the points that are asked for: `pays` of a number of points.
std::unique_ptr<PreparedPolyhedron> faster_polyhedron(const PolyhedronProblem& problem,
                                                      std::unique_ptr<PreparedPolyhedron> fast,
                                                      std::unique_ptr<PreparedPolyhedron> direct,
                                                      std::function<bool(std::uint64_t)> pays);

} // namespace cowgpu::plan

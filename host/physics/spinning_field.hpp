// The field that a particle feels which turns with a body: gravity and the centrifugal acceleration.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/body.hpp"
#include "host/monitor.hpp"
#include "host/physics/surface_gravity.hpp"
#include "host/types.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace cowgpu::physics {

/// Throws Error(bad_argument) for a rate that is negative or not finite and an axis whose length is not 1 to 1e-9.
void check_spin(const Spin& spin);

/// At points, in the frame that turns with the body. With V as PolyhedronProblem has it, times density, w the spin's rate and r
/// the distance from its axis, W = G V + w^2 r^2/2:
struct SpinningValues {
  std::vector<double> geopotential; ///< -W: gravity's potential -G V with the centrifugal one
  std::vector<Vec3> acceleration;   ///< grad W
  std::vector<Eigen::Matrix3d>
      gradient;                ///< dd W; on faces the mean of both sides', on edges without what is infinite there
  std::vector<double> density; ///< that the body has there, its unit as Body has it
  std::vector<std::uint8_t> on_edge; ///< 1 where dd W is infinite
  std::vector<double> depth;         ///< distance from the nearest surface of body and parts, not negative
  int largest_winding = 1;           ///< how often a surface winds about one of the points at most
};

/// Body and backend must outlive it. Not for several threads at once.
class SpinningField {
public:
  /// `constant` is G in the body's units. Without second or first derivatives what is made of these is left empty. `tolerance` as PolyhedronProblem has it, of each surface. Throws what check_spin()
  /// and check_distance_surface() throw.
  SpinningField(const Body& body, double constant, const Spin& spin, double tolerance, const Backend& backend,
                Derivatives derivatives = Derivatives::second);

  /// At points in mesh coordinates, values added over body and parts. With `depths` the distances too. Throws what
  /// PreparedPolyhedron::at() and DistanceField::closest() throw.
  SpinningValues at(std::span<const Vec3> points, bool depths, Monitor& monitor) const;

  /// Upper bound of what at() allocates for so many points.
  MemoryNeed memory(std::uint64_t points) const;

private:
  struct Piece {
    double density;
    std::unique_ptr<PreparedPolyhedron> polyhedron;
    std::unique_ptr<DistanceField> distance;
  };
  double constant_;
  Spin spin_;
  Derivatives derivatives_;
  std::vector<Piece> pieces_;
};

} // namespace cowgpu::physics

// The exact field of a body, surface and parts, at any place: one interface to all that sums polyhedra.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/body.hpp"
#include "host/monitor.hpp"
#include "host/potential.hpp"
#include "host/run_report.hpp"
#include "host/types.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace cowgpu::physics {

/// How the closed forms of a body's polyhedra are summed.
enum class FieldSum {
  /// In 80-bit arithmetic on the CPU, a microsecond for three faces and points: for few points whose digits are all shown.
  extended,
  /// By Backend::polyhedron, in double precision.
  device,
};

struct BodyFieldProblem {
  Derivatives derivatives = Derivatives::first;
  FieldSum sum = FieldSum::extended;
  unsigned threads = 0; ///< threads of what is summed on the host; 0: all
  /// Of the device's sums, as PolyhedronProblem has them, but relative to |M|/R^2 and |M|/R of the whole body, R the radius of
  /// the ball with its surface's volume: what surface and parts leave out adds up to no more.
  double tolerance = 0;
  bool guarantee = false;
};

/// A body's field at many points.
struct BodyFieldValues {
  PotentialField field;        ///< V = integral of density/|x - p| and what else was asked for
  std::vector<double> density; ///< that the body has at each point: -(trace of dd V)/4 pi; on a face the mean
  /// 1 where the series of FarField has the smaller error, and was taken: far away (what the device takes of its own accord
  /// aside), and beside very thin bodies.
  std::vector<std::uint8_t> by_series;
  std::vector<double> bound; ///< where it is guaranteed: of what the sums leave out of the gradient, without rounding
  /// Largest estimated error, of V by |V| and of the gradient by the larger of its norm and |V| over the distance from the
  /// body's middle; at least the rounding of the doubles it is given in.
  double error = 0;
  double value_error = 0, gradient_error = 0; ///< the largest of the same errors themselves
};

/// |M|/R^2 of a body, which tolerances are parts of.
double gravity_scale(const Body& body);

class ClosedForms;

/// The body must outlive it.
class BodyField {
public:
  /// Cheap. Throws Error(bad_argument) for a tolerance out of range.
  BodyField(const Body& body, const BodyFieldProblem& problem, const Backend& backend);
  ~BodyField();

  /// Upper bound of what at() allocates for so many points, its result included.
  MemoryNeed memory(std::uint64_t points) const;

  /// At points in mesh coordinates, the body's parts added with their densities; each point by the closed forms or by the
  /// series, whichever is estimated to be nearer to the truth (of the device's sums: where these lose more than the tolerance
  /// and 1e-12 of the field, as beside thin and about hollow bodies). What is smaller than doubles hold is 0. Throws Error(point_singular) where second derivatives are asked for
  /// on an edge, bad_argument for points that are not finite, what PreparedPolyhedron::at() throws, interrupted. Of the
  /// report what the device's sums report is set.
  BodyFieldValues at(std::span<const Vec3> points, Monitor& monitor, RunReport* report = nullptr) const;

private:
  const Body& body_;
  BodyFieldProblem problem_;
  std::unique_ptr<const ClosedForms> forms_;
};

/// The same by 80-bit sums.
BodyFieldValues exact_field(const Body& body, std::span<const Vec3> points, Derivatives derivatives, unsigned threads,
                            Monitor& monitor);

} // namespace cowgpu::physics

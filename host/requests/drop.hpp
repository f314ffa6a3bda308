// Whether a body that is dropped on the earth lands on its feet.
#pragma once

#include "host/report/drop_findings.hpp"
#include "host/requests/load_body.hpp"

#include <variant>

namespace cowgpu {

/// How the body is held before it is dropped: the feet down, up, or to the side by a quarter turn about x.
enum class Held { upright, upside_down, on_side };

struct DropRequest {
  BodyRequest body;           ///< a mesh; units must be stated
  double height = 0;          ///< height of the centre of mass above the ground, m
  Vec3 feet = -Vec3::UnitY(); ///< direction of the feet in the body's axes, of length 1
  std::variant<Held, physics::LongMat3> attitude = Held::upright; ///< or the rotation from the body's axes to x, up, z
  Vec3 spin = Vec3::Zero(); ///< angular velocity at the start in the body's axes, rad/s
  int order = 6;            ///< highest degree of the multipoles
};

/// Throws what load_mass(), free_body() and physics::drop() throw, Error(bad_argument) without units, Error(file_format) for
/// coefficients, which do not say where the body's lowest point is.
DropOutcome drop(const DropRequest& request, Monitor& monitor);

} // namespace cowgpu

// A surface with what turns it into a body: where its origin is and how dense it is.
#pragma once

#include "host/mesh/closed_surface.hpp"
#include "host/mesh/geometry.hpp"

#include <optional>
#include <string>

namespace cowgpu {

/// A body of uniform density. Lengths are in the mesh's unit, masses in density times its cube.
struct Body {
  explicit Body(ClosedSurface s) : surface(std::move(s)) {}

  ClosedSurface surface;
  double density = 1;
  double volume = 0;
  double area = 0;
  Vec3 centre_of_mass = Vec3::Zero();
  Box box;
  Vec3 origin = Vec3::Zero();  ///< of every moment and tensor, in mesh coordinates
  std::string origin_kind;     ///< "centre of mass", "mesh" or "given"
  double brillouin_radius = 0; ///< largest distance of a vertex from `origin`

  double mass() const { return density * volume; }
};

/// Where moments are taken about: the centre of mass by default, a point of the mesh's coordinates if given.
struct OriginChoice {
  std::string kind = "centre of mass";
  std::optional<Vec3> point; ///< empty: the centre of mass
};

/// Measures the surface. Throws Error(bad_argument) for a density that is zero or not finite, or an origin so far away
/// (over 1e6 radii) that nothing would be left of the body in double precision.
Body make_body(ClosedSurface surface, const OriginChoice& origin, double density);

} // namespace cowgpu

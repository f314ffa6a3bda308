// A surface with what turns it into a body: where its origin is and how dense it is; and bodies of several parts.
#pragma once

#include "host/mesh/closed_surface.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/placement.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// A region of uniform density, which adds to whatever else is there: with a negative density it digs a hole.
struct Part {
  explicit Part(ClosedSurface s, double d = 1);

  ClosedSurface surface;
  double density = 1;
  double volume = 0;
  Vec3 centre_of_mass = Vec3::Zero();

  double mass() const { return density * volume; }
};

/// A body: the region inside `surface` with `density`, and parts. Lengths are in the mesh's unit and masses in density times
/// its cube; metres and kilograms where its units are stated.
struct Body {
  explicit Body(ClosedSurface s) : surface(std::move(s)) {}

  ClosedSurface surface;
  double density = 1;
  double volume = 0;                  ///< volume that `surface` bounds
  double area = 0;                    ///< area of `surface`
  Vec3 centre_of_mass = Vec3::Zero(); ///< centre of mass of body and parts; NaN where their masses cancel
  Box box;                            ///< bounding box of body and parts
  Vec3 origin = Vec3::Zero();         ///< the point that moments and tensors are about, in mesh coordinates
  std::string origin_kind;            ///< "centre of mass", "mesh" or "given"
  double brillouin_radius = 0;        ///< largest distance of a vertex, of parts too, from `origin`
  std::vector<Part> parts;
  Placement placement; ///< what surface and parts have gone through

  /// With the mass of a cubed unit of the mesh at `density`.
  Units units() const;

  double mass() const;
};

/// Where moments are taken about: the centre of mass by default, a point of the mesh's coordinates if given.
struct OriginChoice {
  std::string kind = "centre of mass";
  std::optional<Vec3> point; ///< empty: the centre of mass
};

/// Measures the surface and the parts. Throws Error(bad_argument) for a density that is zero or not finite, an origin so far
/// away (over 1e6 radii) that nothing would be left of the body in double precision, and where body and parts cancel to a
/// mass of nothing but rounding and the origin is to be their centre.
Body make_body(ClosedSurface surface, const OriginChoice& origin, double density, std::vector<Part> parts = {});

} // namespace cowgpu

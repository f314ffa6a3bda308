// Gravity on the surface of a body: at its faces, its vertices, or at points.
#pragma once

#include "host/backend.hpp"
#include "host/mesh_values.hpp"
#include "host/report/surface_gravity_findings.hpp"
#include "host/requests/load_body.hpp"
#include "host/units.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// What `cowgpu surface` takes unless told otherwise, as a part of GM/R^2.
inline constexpr double default_surface_tolerance = 1e-9;

struct SurfaceGravityRequest {
  BodyRequest body;            ///< a mesh
  std::optional<Measure> mass; ///< instead of a density: in kg where units are stated, else in the mesh's own units
  ValuePlace place = ValuePlace::faces;
  std::vector<Vec3> points;      ///< for ValuePlace::points, in the body's coordinates
  std::string points_name;       ///< that results call them
  std::optional<Measure> height; ///< above faces or vertices, along their normals
  /// How fast the body turns: in rad/s where units are stated, else in units of sqrt(G density).
  std::optional<Measure> spin_rate;
  std::optional<Vec3> spin_axis; ///< a direction, through the body's origin; empty: the largest principal axis
  double tolerance = default_surface_tolerance; ///< of g, as a part of GM/R^2; 0: all faces are summed everywhere
  bool guarantee = false;         ///< the truncation of g is proven to stay below the tolerance, and its bound is told
  unsigned threads = 0;           ///< threads of what is done on the host; 0: all
  std::vector<std::string> notes; ///< sentences that come after those about the body
};

/// A request whose mesh is read and checked, and what it takes.
struct SurfaceGravityPlan {
  SurfaceGravityRequest request;
  LoadedMass loaded;
  std::optional<physics::Spin> spin;
  double height = 0;
  std::uint64_t places = 0;
  std::uint64_t extra_bytes = 0; ///< memory that the caller needs beside the result

  const Body& body() const { return *loaded.mesh; }

  /// What surface_gravity() allocates at most, and the caller beside it.
  MemoryNeed memory(const Backend& backend) const;
};

/// Reads and checks all but memory. Throws what load_mass() throws, Error(file_format) for coefficients, Error(bad_argument)
/// for density and mass at once, a mass that is not above 0 or one of a body with parts, measures with units where the mesh
/// has none and without where it has, a height above points, no points, a spin without an axis, an axis without a spin, a tolerance
/// out of range, a guarantee without a tolerance.
SurfaceGravityPlan plan_surface_gravity(SurfaceGravityRequest request, Monitor& monitor);

/// Throws Error(too_large) where this machine has less memory than the plan needs, Error(file_format) for points beyond the range of
/// doubles, and what physics::BodyField throws.
SurfaceGravityResult surface_gravity(SurfaceGravityPlan plan, Backend& backend, Monitor& monitor);

} // namespace cowgpu

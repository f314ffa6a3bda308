// What is found out about a mesh, and how it is said (host/requests/inspect.hpp).
#pragma once

#include "host/mesh/audit.hpp"
#include "host/mesh/inscribed.hpp"
#include "host/mesh/overlap.hpp"
#include "host/mesh/self_intersections.hpp"
#include "host/report/result.hpp"

#include <optional>
#include <string>

namespace cowgpu {

/// Pairs of intersecting faces that are named.
inline constexpr std::size_t listed_pairs = 10;

struct Inspection {
  RawMesh mesh;
  Audit audit;
  std::string moments = "yes", maps = "yes";      ///< which of the two types it satisfies, or the reason why not
  std::optional<SelfIntersections> intersections; ///< faces that cross; known for finite meshes with faces
  std::optional<Overlap> overlap; ///< volume wound twice, of closed, oriented meshes whose pairs are all known
  // The radii are missing too where not all pairs are known.
  std::optional<double> brillouin_radius;  ///< about the centre of mass
  std::optional<double> inscribed_radius;  ///< about the centre of mass, if that lies inside
  std::optional<LargestBall> largest_ball; ///< if there is a point inside
};

/// After data/schemas/cowgpu.inspect.v1.json. `output`: the file that the mesh was written to, or "".
Object document(const Inspection& found, const std::string& output);

/// Lines for the screen.
void write_inspection(const Inspection& found, const Sink& sink);

} // namespace cowgpu

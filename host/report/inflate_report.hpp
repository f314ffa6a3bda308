// A body inflated by distances, and how it is said (host/requests/inflate.hpp).
#pragma once

#include "host/flow/level_surface.hpp"
#include "host/flow/star_shape.hpp"
#include "host/mesh/audit.hpp"
#include "host/mesh/body.hpp"
#include "host/report/result.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// All points at one distance from the body.
struct InflatedBody {
  double level = 0; ///< the distance, in the mesh's length unit
  Audit audit;      ///< of `surface`
  LevelSurfaceReport report;
  LevelSurfaceError error;
  TriangleSurface surface;
  std::string note;         ///< that volume and area are known only roughly, and what to do, or empty
  std::string name, output; ///< what the caller calls the level, and the file that it was written to, or empty
};

struct InflateResult {
  Body body; ///< as given, density 1, about the origin that was asked for
  DeviceFacts device;
  std::vector<std::string> notes = {};    ///< on the mesh, and what the caller adds
  std::optional<StarShapeTime> star = {}; ///< where it was asked for
  double star_seconds = 0;
  std::vector<InflatedBody> bodies = {}; ///< one a level, in their order
  std::string picture = {};              ///< the file that the caller drew them into, or empty
};

/// After data/schemas/cowgpu.inflate.v1.json.
Object document(const InflateResult& result, const std::vector<std::string>& command);

/// Lines for the screen.
void write_inflate(const InflateResult& result, const Sink& sink);

} // namespace cowgpu

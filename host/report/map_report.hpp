// A map to the sphere and what it is worth, ready to be shown (host/requests/map.hpp).
#pragma once

#include "host/flow.hpp"
#include "host/flow/star_shape.hpp"
#include "host/map/quality.hpp"
#include "host/map/stretch_repeats.hpp"
#include "host/report/result.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// Of the map that the distance's flow makes.
struct FlowMapReport {
  double time = 0;
  std::string time_choice; ///< "auto" or "given"
  Vec3 origin = Vec3::Zero();
  StarShapeTime star;
  FlowReport points;
};

/// A map of a surface, and what it is worth.
struct MapResult {
  ManifoldSurface surface;
  SphereMap map = {};
  std::vector<std::string> notes = {}; ///< on the mesh
  MapQuality quality = {};
  std::optional<StretchMeasure> stretch = {}; ///< stretch of the stretch map
  std::vector<StretchRepeat> repeats = {}; ///< repeats of the stretch map on relabelled copies, if they were asked for
  std::optional<FlowMapReport> flow = {};  ///< report of the flow's map
  std::string output = {};                 ///< the file that the caller wrote, or empty
  double map_seconds = 0, judge_seconds = 0, repeat_seconds = 0; ///< wall time
};

/// For people: the mesh, the method and its notes, a table of figures, the same in sentences.
void write_screen(const MapResult& result, const Sink& sink);

/// After data/schemas/cowgpu.map.v1.json.
Object document(const MapResult& result, const std::vector<std::string>& command);

} // namespace cowgpu

// One of the surface expansions in a result.
#pragma once

#include "host/document.hpp"
#include "host/map/quality.hpp"
#include "host/paper/surface_tables.hpp"
#include "host/report/flow_result.hpp"
#include "host/spectrum/expand_surface.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

struct SurfaceResult {
  MapMethod of = MapMethod::stretch; ///< whose name is the key among the expansions; not file
  SphereMap map;                     ///< the map; of the flow: where the mesh's vertices come to, seen from the origin
  std::string map_file, map_sha256;  ///< the file that the map was read from (map.method file), or empty
  std::string recipe;                ///< "default" or "paper"
  std::string origin_kind;           ///< as in Body
  std::string length_unit = "the mesh's length unit";
  bool closest_point = false;
  bool beside_paper = false; ///< the paper's recipe on the paper's mesh, to degree 3 at least, with aliasing estimated
  SurfaceExpansion expansion;
  ExpandSurfaceReport report;
  MapQuality quality; ///< for the grid of the expansion
  double map_seconds = 0;
  std::optional<FlowResult> flow; ///< what the flow adds to its expansion
};

/// How directions are looked up: "ray", "closest point", "level set" or "sheets".
std::string lookup_name(const SurfaceResult& result);

/// The paper's table of this map.
std::span<const PaperRow> paper_table(const SurfaceResult& result);

/// What the paper's recipe converges to: the flow's signed sheets, or the expansion itself.
const SurfaceExpansion& converged_expansion(const SurfaceResult& result);

/// The largest uncertainty of that among degrees 0 to 3, by field: the estimate of aliasing where there is no flow.
std::array<double, 6> converged_within(const SurfaceResult& result);

/// The member of `expansions` after data/schemas/cowgpu.result.v1.json. It refers to the coefficients of `result`, which must
/// live as long.
Object members(const SurfaceResult& result);

/// Bytes of that as JSON, to about ten per cent.
std::uint64_t surface_json_bytes(int lmax);

/// For people: the map, its flaws, the leading coefficients to degree 3, and the paper's beside them where it has them.
void write_surface_screen(const SurfaceResult& result, const Sink& sink);

} // namespace cowgpu

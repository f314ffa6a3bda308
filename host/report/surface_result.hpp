// One of the surface expansions in a result.
#pragma once

#include "host/map/quality.hpp"
#include "host/spectrum/expand_surface.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

struct SurfaceResult {
  std::string name; ///< key among the expansions: "harmonic", "stretch" or "smooth"
  SphereMap map;
  std::string map_file, map_sha256; ///< the file that the map was read from (method "file"), or empty
  std::string recipe;               ///< "default" or "paper"
  std::string origin_kind;          ///< as in Body
  bool closest_point = false;
  bool beside_paper = false; ///< the paper's recipe on the paper's mesh, to degree 3 at least, with aliasing estimated
  SurfaceExpansion expansion;
  ExpandSurfaceReport report;
  MapQuality quality; ///< for the grid of the expansion
  double map_seconds = 0;
};

/// The largest estimate of aliasing among degrees 0 to 3, by field.
std::array<double, 6> converged_within(const SurfaceResult& result);

/// The member of `expansions` as text after data/schemas/cowgpu.result.v1.json, streamed.
void write_surface_json(const SurfaceResult& result, const std::function<void(std::string_view)>& sink);

/// Bytes that writes, to about ten per cent.
std::uint64_t surface_json_bytes(int lmax);

/// For people: the map, its flaws, the leading coefficients to degree 3, and the paper's beside them where it has them.
void write_surface_screen(const SurfaceResult& result, const std::function<void(std::string_view)>& sink);

} // namespace cowgpu

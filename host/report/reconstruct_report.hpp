// A body at several orders, ready to be shown.
#pragma once

#include "host/mesh/body.hpp"
#include "host/report/result.hpp"
#include "host/spectrum/reconstruct.hpp"
#include "host/spectrum/surface_distance.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// The body of one order.
struct RebuiltOrder {
  int order = 0;
  SurfaceMeasures measures;
  std::size_t vertices = 0, faces = 0;
  int resolution = 0;                      ///< degree of the Clenshaw-Curtis grid of its vertices
  std::optional<SurfaceDistance> distance; ///< forth: from it to the mesh; where the mesh is known
  std::string output;                      ///< the file written, or empty
  double seconds = 0;                      ///< wall time, its distance and file included
};

/// Result of `reconstruct`.
struct ReconstructReport {
  std::vector<std::string> command; ///< as typed
  std::string created;              ///< UTC, ISO 8601
  std::string input;                ///< a mesh's name, or a result file
  bool from_file = false;
  DeviceFacts device;
  std::string name, recipe, map_method; ///< names of the expansion, its recipe and its map's method
  std::string mesh, mesh_hash;          ///< name and SHA-256 of the mesh that was expanded
  SurfaceExpansion expansion;
  SurfaceFields fields = SurfaceFields::xyz;
  std::optional<Body> body; ///< where the mesh is known
  std::size_t samples = 0;  ///< points of each surface that distances are taken from
  std::vector<RebuiltOrder> orders;
  std::vector<std::string> notes;
  double source_seconds = 0, total_seconds = 0; ///< reading, mapping and expanding; all
};

/// What a file of the body of one order says about it, each a word and a text.
std::vector<std::string> order_facts(const ReconstructReport& report, int order);

/// For people: what was rebuilt from what, then a table by order.
void write_screen(const ReconstructReport& report, const Sink& sink);

/// After data/schemas/cowgpu.reconstruct.v1.json.
Object document(const ReconstructReport& report);

} // namespace cowgpu

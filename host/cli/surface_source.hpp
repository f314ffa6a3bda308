// Surface expansions for the commands that rebuild bodies: of a mesh, or from a result file.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/body.hpp"
#include "host/spectrum/reconstruct.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu::cli {

/// What the options say.
struct SurfaceChoice {
  std::string input; ///< a mesh, or a result file (FILE.json)
  std::string of;    ///< a map's name, or ""; see load_surface()
  std::string mesh;  ///< the mesh beside a result file, or ""
  int lmax = -1;     ///< degree of a mesh's expansion; below 0: enough for every order, and default_lmax at least
};

/// Degrees beyond the orders that are rebuilt cost little, and the finer grid keeps aliasing out of them.
inline constexpr int default_lmax = 64;

struct SurfaceSource {
  std::string name; ///< name of the expansion: "stretch"
  SurfaceExpansion expansion;
  std::string recipe, map_method;
  std::string mesh, mesh_hash; ///< name and SHA-256 of the mesh that was expanded
  Placement placement;         ///< placement of that mesh, before it was expanded
  std::optional<Body> body;    ///< where the mesh is known; density 1
  std::vector<std::string> notes;
};

/// Reads a result file (`of` "": read_surface()'s choice) and the mesh beside it, or reads a mesh, maps it (`of` "":
/// stretch) and expands it about its centre of mass as `cowgpu expand` does. Throws Error(bad_argument) for an order
/// beyond the expansion, options that do not go with the input, a map of no known name; and what reading, mapping and
/// expanding throw.
SurfaceSource load_surface(const SurfaceChoice& choice, int largest_order, Backend& backend, Monitor& monitor);

/// The parts of that which need no work: words that mean nothing. Throws Error(bad_argument).
void check_surface_choice(const SurfaceChoice& choice, int largest_order);

/// Reads --fields: "xyz" or "f".
SurfaceFields parse_fields(const std::string& text);

/// Degree of the Clenshaw-Curtis grid that a body of this order is triangulated on unless told otherwise.
int default_resolution(int order);

/// What reconstruct() and measure() take at most for this order, beside the expansion.
MemoryNeed rebuild_memory(int order, int resolution, const Backend& backend);

} // namespace cowgpu::cli

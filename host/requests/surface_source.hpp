// Surface expansions for what rebuilds bodies: of a mesh, or from a result file.
#pragma once

#include "host/backend.hpp"
#include "host/io/surface_file.hpp"
#include "host/mesh/body.hpp"
#include "host/spectrum/reconstruct.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// Where an expansion of a surface comes from.
struct SurfaceChoice {
  std::string input; ///< a mesh, or a result file (FILE.json)
  std::string of;    ///< a map's name, or ""; see load_surface()
  std::string mesh;  ///< the mesh beside a result file, or ""
  int lmax = -1;     ///< degree of a mesh's expansion; below 0: enough for every order, and default_lmax at least
};

/// Degrees beyond the orders that are rebuilt cost little, and the finer grid keeps aliasing out of them.
inline constexpr int default_lmax = 64;

/// An expansion as a file would hold it, whether it comes from one or not.
struct SurfaceSource : SurfaceFile {
  std::optional<Body> body = {}; ///< where the mesh is known; density 1
};

/// Reads a result file (`of` "": read_surface()'s choice) and the mesh beside it, or reads a mesh, maps it (`of` "":
/// stretch) and expands it about its centre of mass as `cowgpu expand` does. Throws Error(bad_argument) for an order
/// beyond the expansion, options that do not go with the input, a map of no known name; and what reading, mapping and
/// expanding throw.
SurfaceSource load_surface(const SurfaceChoice& choice, int largest_order, Backend& backend, Monitor& monitor);

/// The parts of that which need no work: words that mean nothing. Throws Error(bad_argument).
void check_surface_choice(const SurfaceChoice& choice, int largest_order);

/// Degree of the Clenshaw-Curtis grid that a body of this order is triangulated on unless told otherwise.
int default_resolution(int order);

/// What reconstruct() and measure() take at most for this order, beside the expansion.
MemoryNeed rebuild_memory(int order, int resolution, const Backend& backend);

} // namespace cowgpu

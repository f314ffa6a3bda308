#include "host/mesh/cures.hpp"

#include "host/error.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/mend.hpp"
#include "host/mesh/overlap.hpp"
#include "host/mesh/weld.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {

std::optional<double> volume_amiss(const RawMesh& mesh, Monitor& monitor) {
  if (mesh.faces.size() > most_tried_faces) return {};
  const Bvh tree(mesh.vertices, mesh.faces);
  const SelfIntersections pairs = self_intersections(mesh.vertices, mesh.faces, tree, monitor);
  if (!pairs.complete) return {};
  // Few points: a hint is no measurement, and a refusal should not take long.
  const Overlap found = overlap(mesh.vertices, mesh.faces, tree, pairs, monitor, 0, std::size_t(1) << 14);
  const double least = 1e-6 * volume(mesh.vertices, mesh.faces);
  double amiss = 0;
  for (const RegionVolume& region : {found.overlapped, found.inverted})
    if (region.volume > std::max(region.uncertainty, least)) amiss += region.volume;
  return amiss;
}

std::string cure_of_shells(const RawMesh& mesh, Monitor& monitor) {
  if (mesh.faces.size() > most_tried_faces) return {};
  for (const char* option : {"--orient", "--largest-shell"}) {
    const bool turn = option == std::string("--orient");
    if (turn && was_oriented(mesh)) continue;
    RawMesh mended;
    mended.vertices = mesh.vertices;
    mended.faces = mesh.faces;
    try {
      if (turn)
        orient(mended, monitor);
      else
        keep_largest_shell(mended);
    } catch (const Error& error) {
      if (error.fault() == Fault::interrupted) throw;
      continue;
    }
    const double whole = volume(mended.vertices, mended.faces);
    if (!seems_balanced(mended.faces) || !(whole > volume_noise(mended.vertices, mended.faces))) continue;
    if (volume_amiss(mended, monitor) == 0.0) return fmt::format("{} gives the volume {:.6g}", option, whole);
  }
  return {};
}

} // namespace cowgpu

// Surfaces as binary glTF 2.0 (GLB), which browsers, Blender and slide programs show.
//
// Through tinygltf: a file has nine kinds of objects that name each other by number, and a checked library for both
// directions costs one header; none of its code for pictures or foreign files is compiled in.
#pragma once

#include "host/io/atomic_file.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/render.hpp"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace cowgpu {

/// One node of the scene.
struct GlbPart {
  const TriangleSurface* surface = nullptr;              ///< its name becomes the node's and the mesh's
  Vec3 translation = Vec3::Zero();                       ///< where its origin is in the scene, mesh length unit
  std::vector<std::pair<std::string, double>> numbers{}; ///< into the node's extras: {"order", 3}
  std::span<const Colour> colours{};                     ///< linear, one a vertex, in place of the material's; or empty
};

/// What the file says about itself.
struct GlbAbout {
  std::string length_unit = "of the mesh";
  std::vector<std::pair<std::string, std::string>> facts; ///< into the asset's extras
};

/// Writes a scene of one node and one mesh per part; the caller commits the file. Vertices and faces keep their order.
/// Positions and normals are floats (vertex_normals() where a surface has none), indices unsigned 32-bit, scalars the
/// float attributes _NAME; all parts share one buffer and a matt
/// material, those with colours (COLOR_0, 16 bits a channel) another one, which is white. A surface that lies further from its origin
/// than ten times its size is moved to the middle of its bounding box and its node back, so that floats keep its shape.
/// Axes are the mesh's: glTF's convention is y up, and the length unit metres, which extras.length_unit corrects.
/// The asset's extras hold length_unit, the units of the scalars as unit_NAME, and the facts; text that is no UTF-8 is
/// mended. The same input gives the same bytes.
///
/// Throws what check(surface) throws, Error(bad_argument) for colours of another number than the vertices,
/// mesh_empty for a surface without faces or no part at all, mesh_range for
/// what floats cannot hold, too_large beyond 4 GB, cannot_write. Memory: about three times the file.
void write_glb(std::span<const GlbPart> parts, const GlbAbout& about, AtomicFile& file);

} // namespace cowgpu

// Surfaces as PLY (G. Turk, The PLY polygon file format, Stanford 1994), binary little-endian.
#pragma once

#include "host/io/atomic_file.hpp"
#include "host/mesh/triangle_surface.hpp"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

/// Writes the surface; the caller commits the file. Vertices and faces keep their order. Per vertex: x, y, z as doubles,
/// so that they read back bit for bit; normals, if there are any, nx, ny, nz as floats; scalars as doubles under their
/// names. Faces are lists of uchar length and int indices. Comments: the program, the surface's name, `comments`, and the
/// unit of each scalar; line breaks in them become blanks.
///
/// Throws what check(surface) throws, Error(too_large) beyond 2^31 - 1 vertices or faces, cannot_write.
void write_ply(const TriangleSurface& surface, std::span<const std::string> comments, AtomicFile& file);

/// What a PLY file of ours says about a mesh.
struct PlyMesh {
  std::vector<Vec3> vertices;
  std::vector<Face> faces;           ///< empty where the file has no faces
  std::vector<std::string> comments; ///< blanks between words are single
};

/// Reads the bytes of a file that write_ply() has written, or of one like it: binary little-endian; vertices first, x, y
/// and z double or float among any scalar properties; then, optionally, triangles as one list property of uchar lengths
/// and int or uint indices; nothing after them. `name` opens every message.
///
/// Memory: no more than the result, which is allocated only once the file is known to be long enough for it.
///
/// Throws Error with
/// - file_format: no PLY, ASCII or big-endian, or elements that write_ply() does not write;
/// - file_syntax: a header that breaks the grammar (with its line), a face of other than three corners or bytes after the
///   last face (with their offset from the file's beginning);
/// - file_truncated: the file ends before what its header announces;
/// - mesh_index_range: a face names a vertex that does not exist; mesh_not_finite: NaN or infinity among x, y, z.
PlyMesh read_ply_positions(std::string_view bytes, const std::string& name);

} // namespace cowgpu

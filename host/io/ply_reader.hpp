// Reads meshes in PLY files (G. Turk, The PLY polygon file format, Stanford 1994), ASCII and binary of both byte orders.
// The writer, and the stricter reader of maps to the sphere, are in ply.hpp.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <string>
#include <string_view>

namespace cowgpu {

/// Reads the bytes of a PLY file. `name` is what the user called it; it opens every message and becomes RawMesh::name.
///
/// Header: see ply_header.hpp. Elements come in any order. Of `vertex` the properties x, y and z are read, of any scalar
/// type, of `face` and of `tristrips` the list vertex_indices or vertex_index, of any type of whole numbers; every other
/// property and element is skipped, with a note. A property announced twice is read where it is announced first, with a
/// note. Polygons are cut by MeshFaces, faces of one or two corners left out with a note. In `tristrips` -1 ends a strip.
/// Numbers of ASCII files are read as doubles whatever type is announced, and may be spread over lines.
///
/// Fills every field of RawMesh; `sha256` is that of `bytes`; `face_lines` (one entry per triangle) for ASCII only. Notes
/// also say whether data follow the last element. Every index is valid on return.
///
/// Memory: below 4 times the file for triangles with coordinates of 4 bytes and indices of 2 or more, and for strips with
/// indices of 4, whatever the header promises; nowhere more than 16 times, but what cutting one large polygon takes.
///
/// Throws Error with
/// - file_format: no PLY, vertices without x, y and z, faces or strips without their list;
/// - file_syntax: what breaks the grammar, a face of no corners, a polygon that cannot be cut, a list of negative length;
/// - file_truncated: the file ends before what its header announces (says how many vertices and faces were found);
/// - mesh_index_range: a face names a vertex that does not exist.
/// Messages have the line, or in binary data the offset from the file's beginning.
RawMesh parse_ply(std::string_view bytes, const std::string& name);

} // namespace cowgpu

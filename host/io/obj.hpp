// Reads the polygons of Wavefront OBJ files (Wavefront Advanced Visualizer manual, appendix B1, version 3.0).
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <string>
#include <string_view>

namespace cowgpu {

/// Reads the text of an OBJ file. `name` is what the user called it; it opens every message and becomes RawMesh::name.
///
/// Grammar: an optional UTF-8 byte order mark; lines ended by LF, CRLF, LFCR or CR; `#` opens a comment anywhere; a backslash
/// before a line's end, or before blanks there, goes on with the line below in every statement, but not in a comment. Read are
/// - `v x y z`, with a fourth number, the weight w of rational curves and surfaces, or with three or four more, a colour. As
///   the manual has it, w means nothing to polygons: it does not divide x, y, z and may be 0 (a note says where it is not 1);
/// - `f` (and its old name `fo`) of corners `v`, `v/vt`, `v//vn` or `v/vt/vn`: vertices count from 1 over the whole file, those
///   further down too, or backwards from the last one above (-1). Where faces name vertex 0 and all others are there when
///   counted from 0, they are, with a note. Polygons are cut by MeshFaces; faces of one or two corners are left out with a
///   note, but for one that the file ends in. Every group, object and material goes into one mesh.
/// Skipped: vt, vn, vp, g, s, o, mg, usemtl, mtllib and the other words on display and materials; with a note l and p, and
/// statements that begin with a word unknown to OBJ.
/// Vertices keep their order and are never merged: the file's indices are its topology.
///
/// Fills every field of RawMesh; `sha256` is that of `bytes`; `face_lines` has one entry per triangle. Every index is
/// valid on return.
///
/// Memory: below 4 times the file for triangles. The text is gone through twice, the first time to count.
///
/// Throws Error with
/// - file_format: free-form curves and surfaces (cstype, curv, surf ...), statements that call other files, and a file of
///   unknown statements alone;
/// - file_syntax: a line that begins with a number, V or F; a word that is no number, a wrong number of them (with the
///   line), a polygon that cannot be cut;
/// - file_truncated: an empty file, or one that ends within a statement;
/// - mesh_index_range: a face names a vertex that does not exist; too_large: 2^32 vertices.
RawMesh parse_obj(std::string_view bytes, const std::string& name);

/// Whether a word opens a statement of OBJ files.
bool is_obj_statement(std::string_view word);

} // namespace cowgpu

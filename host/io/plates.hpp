// Reads plate models of small bodies: the tables of vertices and triangles in which the Planetary Data System and others
// publish shapes (suffixes .tab, .plt, .txt and others).
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <string>
#include <string_view>

namespace cowgpu {

/// Reads a plate model. `name` is what the user called it; it opens every message and becomes RawMesh::name.
///
/// Grammar: an optional UTF-8 byte order mark; lines ended by LF, CRLF, LFCR or CR; `#` opens a comment anywhere. A line with
/// the counts of vertices and plates, or with that of the vertices, when that of the plates stands on a line of its own above
/// them. A line per vertex: x y z, all of them or none behind the vertex's number. A line per plate: its three vertices, all of
/// them or none behind the plate's number, or behind the 3 that counts its corners. Numbers of rows count from 1 or 0.
/// Vertices are counted from 1; from 0, with a note, where a plate names vertex 0 and all are there.
///
/// Fills every field of RawMesh; `sha256` is that of `bytes`; `face_lines` has one entry per triangle. A note says whether
/// data follow the last plate. Every index is valid on return. Units are not in the file (mostly km).
///
/// Memory: below 4 times the file, whatever the counts promise.
///
/// Throws Error with
/// - file_format: no counts, or rows of other than three or four numbers;
/// - file_syntax: a word that is no number, a row of another length than the first one, a row with another number than its own;
/// - file_truncated: the file ends before what it announces (says how many vertices and plates were found);
/// - mesh_index_range: a plate names a vertex that does not exist.
RawMesh parse_plates(std::string_view bytes, const std::string& name);

/// Whether the text begins as a plate model does: two counts and a row of three or four numbers, or one count and the row of
/// vertex 1 (or 0) with its number.
bool looks_like_plates(std::string_view bytes);

} // namespace cowgpu

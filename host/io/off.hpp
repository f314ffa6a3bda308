// Reads and writes meshes in the Object File Format of Geomview (http://www.geomview.org/docs/html/OFF.html).
#pragma once

#include "host/io/atomic_file.hpp"
#include "host/mesh/raw_mesh.hpp"
#include "host/mesh/triangle_surface.hpp"

#include <span>
#include <string>
#include <string_view>

namespace cowgpu {

/// Reads the text of an OFF file. `name` is what the user called it; it opens every message and becomes RawMesh::name.
///
/// Grammar: an optional UTF-8 byte order mark; lines ended by LF, CRLF, LFCR or CR; `#` opens a comment anywhere; a header
/// `OFF` with the prefixes ST, C and N in any order (COFF, NOFF, CNOFF ...); the counts of vertices and faces and,
/// optionally, of edges (ignored), on the header's line or below; per vertex three coordinates, free over lines, or
/// with a prefix one line with the normal (3 numbers), colour (3 or 4) and texture position (2) after them, which are
/// skipped; per face the number of corners and their vertices from 0, and up to the line's end a colour, which is
/// skipped. Polygons are cut by MeshFaces, faces of one or two corners left out with a note. Words such as "nan" and "inf"
/// are numbers here. A file under the plain header OFF that does not fit it, or ends before its data do, and whose vertex
/// lines all hold as many numbers more as the first one, is read as if the header announced them, with a note.
///
/// Fills every field of RawMesh; `sha256` is that of `bytes`; `face_lines` has one entry per triangle. Notes say how
/// many polygons were cut, what was skipped or left out and whether data follow the last face. Every index is valid on return;
/// nothing else is promised: ClosedSurface::from does the rest.
///
/// Memory: below 4 times the file for triangles, whatever the header promises.
///
/// Throws Error with
/// - file_format: no OFF header, or a kind that is not read (4OFF, nOFF, OFF BINARY, UTF-16);
/// - file_syntax: a word that is no number, a count that is negative or above 2^32 - 1, a face of no corners, a polygon that cannot be cut;
/// - file_truncated: the file ends before what it announces (says how many vertices and faces were found);
/// - mesh_index_range: a face names a vertex that does not exist (line of the file, face from 0).
RawMesh parse_off(std::string_view bytes, const std::string& name);

/// Writes vertices and faces in their order, numbers in as many digits as read back bit for bit; the caller commits the file.
/// The surface's name and `comments` become comments, line breaks in them blanks; normals and scalars are left out. Throws
/// what check(surface) throws, Error(cannot_write).
void write_off(const TriangleSurface& surface, std::span<const std::string> comments, AtomicFile& file);

} // namespace cowgpu

// Reads STL files, ASCII and binary (3D Systems, StereoLithography Interface Specification, 1988).
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <string>
#include <string_view>

namespace cowgpu {

/// Reads the bytes of an STL file. `name` is what the user called it; it opens every message and becomes RawMesh::name.
///
/// ASCII: one or more of `solid [name]`, any number of `facet normal n n n outer loop`, three times `vertex x y z`,
/// `endloop endfacet`, and `endsolid [name]`; the words in either case and with any white space between them, the names to
/// the end of their lines; `end loop`, `end facet` and `end solid` too; an optional UTF-8 byte order mark. Where a word of
/// the grammar belongs, comments (from `#`, `;`, `//` or the word comment) and colours (from the word color or colour) are
/// skipped to the line's end. `endsolid` may be missing behind a facet. Coordinates are read as doubles. Binary: a header
/// of 80 bytes, which may begin with "solid", the number n of facets, 50 bytes each: floats and two attribute bytes, all
/// little endian; where n is 0 and whole facets follow, they are read to the file's end. looks_like_binary_stl() tells
/// them apart.
///
/// STL has no topology: corners of exactly equal coordinates (-0 equals +0) become one vertex, in the order of their first
/// appearance; facets with two corners at one point, which have no area, are left out. Notes say both; and what was
/// skipped (attribute bytes, data after the last facet, comments and colours) and what was missing (the number of facets,
/// `endsolid`), and whether more than a hundredth of the facets' normals
/// contradict the order of the corners, which is what counts.
///
/// Fills every field of RawMesh; `sha256` is that of `bytes`; `face_lines` (of the word `facet`) for ASCII only. Memory:
/// below 4 times the file.
///
/// Throws Error with file_format (neither kind); file_syntax (another word than the grammar's, with the line);
/// file_truncated (the file ends inside a facet or a word, before its first facet, or before the last one announced).
RawMesh parse_stl(std::string_view bytes, const std::string& name);

/// Whether the bytes are no text and not of another kind that is known by its first bytes, or have exactly the length
/// that their number of facets announces.
bool looks_like_binary_stl(std::string_view bytes);

} // namespace cowgpu

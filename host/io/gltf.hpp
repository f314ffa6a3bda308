// Reads the meshes of glTF 2.0 files, .gltf and .glb
// (https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html).
//
// The JSON comes from nlohmann's parser, not through tinygltf, which writes our GLB files: tinygltf recurses over what it
// reads (half a megabyte of nested lists in "extras" ends the program), decodes pictures' and buffers' data before anybody has
// looked at them, and leaves every bound to be checked here anyway.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <string>
#include <string_view>

namespace cowgpu {

/// Reads every mesh of the file's scene (the default one, else the first, else all nodes) into one mesh. `name` is what
/// the user called it; it opens every message and becomes RawMesh::name.
///
/// Nodes' transforms are applied, to every instance of a mesh; where one mirrors (negative determinant) its faces are
/// turned, so that outward stays outward. Axes and unit stay the file's (glTF: y up, metres). Read are triangles, strips
/// and fans with indices of any size, or none, and positions that are floats or, by KHR_mesh_quantization, bytes and
/// shorts, normalized or not; sparse accessors too; in the order of the file, a mesh's primitives that share their
/// positions sharing vertices. Points and lines bound nothing, and triangles of strips that name a vertex twice have no
/// area: they are left out with a note of how many. Data come from the GLB's own chunk and from data: URIs; no other file is
/// opened. Normals, texture, materials, pictures, cameras, animations are ignored; morph targets and skins with a note
/// (a skinned mesh stands as it was bound).
///
/// glTF doubles vertices where normals or texture have seams. A mesh that is not closed as it is indexed is welded where
/// positions are exactly equal (host/mesh/weld.hpp), first each instance by itself, then, if that is not enough, all
/// together; a note says so. A mesh closed as it stands is never welded.
///
/// Fills every field of RawMesh but `face_lines`; `sha256` is that of `bytes`. Every index is valid on return.
///
/// Memory: of the mesh at most 32 MiB plus 4 times the file; instances that would take more, or more than 1,000,000
/// primitives, are refused before they are made.
///
/// Throws Error with
/// - file_format: no glTF 2; other positions, as shorts without the extension;
///   required extensions (KHR_draco_mesh_compression ...), and instances by EXT_mesh_gpu_instancing; outside files;
/// - file_syntax: broken JSON; numbers that lead out of their list, view or buffer; a node that is its own ancestor or has
///   two parents, or lies more than 1000 deep; a transform that is not affine, or has a matrix and its parts too;
/// - file_truncated: a container or buffer shorter than announced;
/// - mesh_index_range: an index beyond the positions; too_large: see above.
RawMesh parse_gltf(std::string_view bytes, const std::string& name);

} // namespace cowgpu

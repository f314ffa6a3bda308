// A triangle mesh as it was found: nothing about it is promised yet.
#pragma once

#include "host/types.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace cowgpu {

/// A mesh as read or made. Vertices are never merged or reordered: the topology is the file's.
struct RawMesh {
  std::string name;           ///< as the user named it: a path, "benchmark", "builtin:cow@3"
  std::string sha256;         ///< hash of the file's bytes; for built-in bodies of the geometry (lower-case hex)
  std::vector<Vec3> vertices; ///< in the mesh's own length unit and axes
  std::vector<Face> faces;    ///< polygons are cut into triangles (host/mesh/polygon.hpp)
  std::vector<std::uint32_t> face_lines; ///< line of the file (from 1) each face came from; empty if made here
  std::vector<std::string> notes;        ///< sentences for the user: "3 polygons were cut into triangles"
};

} // namespace cowgpu

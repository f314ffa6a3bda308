// Maps to the sphere in files.
#pragma once

#include "host/io/atomic_file.hpp"
#include "host/map/sphere_map.hpp"
#include "host/mesh/triangle_surface.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace cowgpu {

enum class MapFormat { ply, glb };

/// By the suffix, .ply or .glb. Throws Error(bad_argument) for another.
MapFormat map_format(const std::filesystem::path& path);

/// Writes the mesh with the map's positions for vertices; the caller commits the file. Vertices and faces keep their
/// order, vertices of no face are written as (0, 0, 0). PLY holds doubles, which read_map() reads back bit for bit, and
/// the facts as comments; GLB holds floats, for viewers. Throws what write_ply() and write_glb() throw.
void write_map(const ManifoldSurface& surface, const SphereMap& map, MapFormat format, AtomicFile& file);

/// Reads a PLY file (read_ply_positions) as a map of this surface, method file. Throws Error with cannot_read and the
/// faults of read_ply_positions(); file_format where vertices or faces are not those of the mesh, in number and order,
/// where the comments that write_map() writes name another mesh's hash or, where `method` is given, another method, or
/// where a vertex of a face is further than 1e-9 from the unit sphere. Whether it is one-to-one, judge() says.
SphereMap read_map(const std::filesystem::path& path, const ManifoldSurface& surface,
                   std::optional<MapMethod> method = {});
/// The same of the bytes of a file; `name` opens every message.
SphereMap read_map(std::string_view bytes, const std::string& name, const ManifoldSurface& surface,
                   std::optional<MapMethod> method = {});

} // namespace cowgpu

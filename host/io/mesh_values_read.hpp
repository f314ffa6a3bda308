// Tables of values that mesh_values_file.hpp writes as CSV, read back.
#pragma once

#include "host/mesh_values.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace cowgpu {

/// Reads FILE.csv and FILE.csv.json. The result has places and columns, but no mesh: vertices are the places of points and empty
/// else, faces are empty; put_on() adds them. Columns NAME_x, NAME_y and NAME_z beside each other are one vector. Throws
/// Error(cannot_read), file_format for a table whose first columns are not id, x, y, z, a JSON of another schema, or one of
/// another table (columns or rows differ), file_syntax, file_truncated, too_large. Memory: some ten times the files.
MeshValues read_mesh_values(const std::filesystem::path& path);

/// The same of the bytes of both; `name` opens every message about the table.
MeshValues parse_mesh_values(std::string_view table, const std::string& about, const std::string& name);

/// Gives values of faces or vertices their mesh. Throws Error(bad_argument) for points, file_format where there are not as
/// many as the mesh has.
void put_on(MeshValues& values, const std::vector<Vec3>& vertices, const std::vector<Face>& faces);

} // namespace cowgpu

#include "host/io/mesh_source.hpp"

#include "host/error.hpp"
#include "host/io/file.hpp"
#include "host/io/mesh_catalogue.hpp"
#include "host/io/mesh_format.hpp"
#include "host/io/sha256.hpp"
#include "host/mesh/builtin.hpp"

#include <fmt/format.h>

namespace cowgpu {

RawMesh load_mesh(const std::string& name) {
  constexpr std::string_view builtin = "builtin:";
  if (name.rfind(builtin, 0) == 0) {
    RawMesh mesh = builtin_mesh(std::string_view(name).substr(builtin.size()));
    mesh.sha256 = sha256_of_geometry(mesh);
    return mesh;
  }
  if (const CatalogueEntry* entry = catalogue_entry(name)) return parse_mesh(read_catalogued(*entry), name);
  if (name.rfind("cgal:", 0) == 0)
    throw Error(Fault::mesh_missing,
                fmt::format("there is no body {}; `cowgpu meshes` lists those that have names", name));
  if (name == "-") return parse_mesh(read_file("/dev/stdin"), "standard input");
  return parse_mesh(read_file(name), name);
}

} // namespace cowgpu

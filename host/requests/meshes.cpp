#include "host/requests/meshes.hpp"

#include "host/io/mesh_format.hpp"
#include "host/mesh/builtin.hpp"

namespace cowgpu {

std::vector<NamedMesh> named_meshes() {
  std::vector<NamedMesh> meshes;
  for (const CatalogueEntry& entry : mesh_catalogue()) meshes.push_back({entry, find_catalogued(entry)});
  return meshes;
}

std::vector<std::string> builtin_usages() {
  std::vector<std::string> usages;
  for (const BuiltinBody& body : builtin_bodies()) usages.push_back("builtin:" + body.usage);
  return usages;
}

std::vector<std::string> mesh_format_names() {
  std::vector<std::string> names;
  for (const MeshFormat& format : mesh_formats()) names.emplace_back(format.name);
  return names;
}

} // namespace cowgpu

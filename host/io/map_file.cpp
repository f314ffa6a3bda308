#include "host/io/map_file.hpp"

#include "host/error.hpp"
#include "host/io/foreign_file.hpp"
#include "host/io/glb.hpp"
#include "host/io/ply.hpp"
#include "host/io/shown.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace cowgpu {
namespace {

constexpr double unit_tolerance = 1e-9;

// How the comments begin that read_map() looks at.
constexpr std::string_view method_word = "map to the unit sphere: ", hash_word = "mesh sha256 ";

std::string face_text(const Face& f) {
  return fmt::format("({}, {}, {})", f[0], f[1], f[2]);
}

void require_faces(const PlyMesh& file, const std::vector<Face>& faces, const std::string& name) {
  const auto advice = "take the file that `cowgpu map` wrote for this very mesh";
  if (file.faces.size() != faces.size())
    throw Error(Fault::file_format, fmt::format("{} has {} faces and the mesh {}: it is not a map of this mesh; {}",
                                                name, file.faces.size(), faces.size(), advice));
  const auto [there, here] = std::mismatch(file.faces.begin(), file.faces.end(), faces.begin());
  if (there != file.faces.end())
    throw Error(Fault::file_format,
                fmt::format("face {} of {} is {} and that of the mesh {}: it is not a map of this mesh; {}",
                            here - faces.begin(), name, face_text(*there), face_text(*here), advice));
}

// What the file's comments say of the mesh and the method, where they do.
void require_story(const PlyMesh& file, const RawMesh& mesh, std::optional<MapMethod> method, const std::string& name) {
  for (const std::string& comment : file.comments) {
    if (comment.starts_with(hash_word) && !mesh.sha256.empty() && comment.substr(hash_word.size()) != mesh.sha256)
      throw Error(
          Fault::file_format,
          fmt::format("{} was made for a mesh of SHA-256 {}, and this one has {}: make the map again, or, where "
                      "only the wording of the mesh's file differs, take that comment out of {}",
                      name, shown(comment.substr(hash_word.size())), mesh.sha256, name));
    if (method && comment.starts_with(method_word) && comment.substr(method_word.size()) != cowgpu::name(*method))
      throw Error(Fault::file_format, fmt::format("{} holds a map by the method {}, not {}", name,
                                                  shown(comment.substr(method_word.size())), cowgpu::name(*method)));
  }
}

} // namespace

MapFormat map_format(const std::filesystem::path& path) {
  if (path.extension() == ".ply") return MapFormat::ply;
  if (path.extension() == ".glb") return MapFormat::glb;
  throw Error(Fault::bad_argument, fmt::format("{}: a map's name must end in .ply or .glb", path.string()));
}

void write_map(const ManifoldSurface& surface, const SphereMap& map, MapFormat format, AtomicFile& file) {
  const RawMesh& mesh = surface.closed().mesh();
  TriangleSurface sphere;
  sphere.name = mesh.name;
  sphere.vertices = map.positions;
  sphere.faces = mesh.faces;
  if (format == MapFormat::ply) {
    std::vector<std::string> comments = {std::string(method_word).append(name(map.method)),
                                         std::string(hash_word) + mesh.sha256};
    comments.insert(comments.end(), map.notes.begin(), map.notes.end());
    write_ply(sphere, comments, file);
    return;
  }
  GlbAbout about;
  about.length_unit = "radius of the sphere";
  about.facts = {{"map", std::string(name(map.method))}, {"mesh_sha256", mesh.sha256}};
  const std::array part = {GlbPart{&sphere}};
  write_glb(part, about, file);
}

SphereMap read_map(const std::filesystem::path& path, const ManifoldSurface& surface, std::optional<MapMethod> method) {
  return read_map(read_input_file(path), path.string(), surface, method);
}

SphereMap read_map(std::string_view bytes, const std::string& name, const ManifoldSurface& surface,
                   std::optional<MapMethod> method) {
  PlyMesh file = read_ply_positions(bytes, name);
  const std::size_t vertices = surface.vertices().size();
  if (file.vertices.size() != vertices)
    throw Error(Fault::file_format, fmt::format("{} has {} vertices and the mesh {}: it is not a map of this mesh",
                                                name, file.vertices.size(), vertices));
  require_faces(file, surface.faces(), name);
  require_story(file, surface.closed().mesh(), method, name);

  std::vector<bool> used(vertices);
  for (const Face& f : surface.faces())
    for (const std::uint32_t v : f) used[v] = true;
  SphereMap map;
  map.method = MapMethod::file;
  for (std::size_t v = 0; v < vertices; ++v) {
    if (!used[v]) {
      file.vertices[v] = Vec3::Zero();
      continue;
    }
    const double length = file.vertices[v].stableNorm();
    if (!(std::abs(length - 1) <= unit_tolerance))
      throw Error(
          Fault::file_format,
          fmt::format("vertex {} of {} has length {:.12g}: a map's vertices lie on the unit sphere to {:.0e}, as "
                      "doubles hold them and floats do not",
                      v, name, length, unit_tolerance));
  }
  map.positions = std::move(file.vertices);
  map.notes.push_back("positions were read from " + name);
  return map;
}

} // namespace cowgpu

#include "host/io/mesh_source.hpp"

#include "host/error.hpp"
#include "host/io/file.hpp"
#include "host/io/mesh_catalogue.hpp"
#include "host/io/mesh_format.hpp"
#include "host/io/sha256.hpp"
#include "host/mesh/builtin.hpp"

#include <fmt/format.h>

namespace cowgpu {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view builtin = "builtin:";

// Somebody who has a file of that name may mean it.
void note_file(const std::string& word, RawMesh& mesh) {
  if (std::error_code none; fs::is_regular_file(word, none))
    mesh.notes.push_back(
        fmt::format("{0} is the mesh of that name, not the file {0} in this folder, which is ./{0}", word));
}

} // namespace

MeshKind mesh_kind(const std::string& word) {
  if (word.starts_with(builtin)) return MeshKind::builtin;
  if (catalogue_entry(word) || word.starts_with("cgal:")) return MeshKind::catalogue;
  return word == "-" ? MeshKind::standard_input : MeshKind::file;
}

std::optional<fs::path> mesh_file(const std::string& word) {
  switch (mesh_kind(word)) {
  case MeshKind::file: return word;
  case MeshKind::catalogue:
    if (const CatalogueEntry* entry = catalogue_entry(word)) return find_catalogued(*entry);
    return {};
  case MeshKind::standard_input: return "/dev/stdin";
  case MeshKind::builtin: break;
  }
  return {};
}

std::string mesh_word_anywhere(const std::string& word) {
  if (mesh_kind(word) != MeshKind::file) return word;
  std::error_code failed;
  const fs::path absolute = fs::absolute(word, failed);
  if (failed) throw Error(Fault::cannot_read, fmt::format("{}: {}", word, failed.message()));
  return absolute;
}

RawMesh load_mesh(const std::string& word) {
  RawMesh mesh;
  switch (mesh_kind(word)) {
  case MeshKind::builtin:
    mesh = builtin_mesh(std::string_view(word).substr(builtin.size()));
    mesh.sha256 = sha256_of_geometry(mesh);
    break;
  case MeshKind::catalogue: {
    const CatalogueEntry* entry = catalogue_entry(word);
    if (!entry)
      throw Error(Fault::mesh_missing,
                  fmt::format("there is no body {}; `cowgpu meshes` lists those that have names", word));
    mesh = parse_mesh(read_catalogued(*entry), word);
    break;
  }
  case MeshKind::standard_input: return parse_mesh(read_file("/dev/stdin"), "standard input");
  case MeshKind::file: return parse_mesh(read_file(word), word);
  }
  note_file(word, mesh);
  return mesh;
}

} // namespace cowgpu

#include "host/io/mesh_source.hpp"

#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"
#include "host/io/file.hpp"
#include "host/io/mesh_catalogue.hpp"
#include "host/io/mesh_format.hpp"
#include "host/io/sha256.hpp"
#include "host/io/shown.hpp"
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

// The name of the schema in a document of ours: "cowgpu.result.v1".
std::string schema_of(std::string_view json) {
  const std::size_t begin = json.find("\"cowgpu.");
  if (begin == std::string_view::npos) return {};
  const std::size_t end = json.find('"', begin + 1);
  return end == std::string_view::npos ? "" : shown(json.substr(begin + 1, end - begin - 1), 60);
}

// Of a file that no reader of meshes takes: that it is one of coefficients, or another document of ours, and what takes it.
std::string other_content(std::string_view bytes) {
  const auto format = coefficient_format_in(bytes);
  if (!format) return {};
  const std::string schema = format == CoefficientFormat::json ? schema_of(bytes) : "";
  if (schema.empty() || schema.starts_with("cowgpu.result.") || schema.starts_with("cowgpu.coefficients."))
    return fmt::format("this file holds coefficients{}, and no mesh: `cowgpu spectrum` and `convert` take them, "
                       "`reconstruct` and `render` those of a surface, `tensors`, `potential`, `radiate` and `tides` "
                       "those of a mass",
                       schema.empty() ? "" : fmt::format(" ({})", schema));
  return fmt::format("this is a document of cowgpu ({}), and no mesh; name the mesh that it is about", schema);
}

RawMesh parse(std::string_view bytes, const std::string& name) {
  try {
    return parse_mesh(bytes, name);
  } catch (const Error& error) {
    if (error.fault() != Fault::file_format && error.fault() != Fault::file_syntax) throw;
    const std::string other = other_content(bytes);
    if (other.empty()) throw;
    throw Error(Fault::file_format, fmt::format("{}: {}", name, other));
  }
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
  case MeshKind::standard_input: return parse(read_file("/dev/stdin"), "standard input");
  case MeshKind::file: return parse(read_file(word), word);
  }
  note_file(word, mesh);
  return mesh;
}

} // namespace cowgpu

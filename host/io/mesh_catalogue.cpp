#include "host/io/mesh_catalogue.hpp"

#include "host/error.hpp"
#include "host/io/atomic_file.hpp"
#include "host/io/file.hpp"
#include "host/io/mesh_catalogue_json.hpp"
#include "host/io/sha256.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdlib>

namespace cowgpu {
namespace {

namespace fs = std::filesystem;

std::optional<fs::path> user_folder() {
  const char* data = std::getenv("XDG_DATA_HOME");
  if (data && *data == '/') return fs::path(data) / "cowgpu" / "meshes"; // relative ones are to be ignored
  const char* home = std::getenv("HOME");
  if (home && *home) return fs::path(home) / ".local" / "share" / "cowgpu" / "meshes";
  return {};
}

std::optional<fs::path> given_folder() {
  const char* given = std::getenv("COWGPU_MESHES");
  if (given && *given) return fs::path(given);
  return {};
}

// Of the folders those that hold a file of that name.
std::vector<fs::path> candidates(const CatalogueEntry& entry) {
  std::vector<fs::path> found;
  for (const fs::path& folder : mesh_folders())
    if (std::error_code none; fs::is_regular_file(folder / entry.file, none)) found.push_back(folder / entry.file);
  return found;
}

} // namespace

const std::vector<CatalogueEntry>& mesh_catalogue() {
  static const std::vector<CatalogueEntry> entries = [] {
    std::vector<CatalogueEntry> all;
    for (const auto& e : nlohmann::json::parse(mesh_catalogue_json))
      all.push_back({e.at("name"), e.at("file"), e.at("sha256"), e.at("vertices"), e.at("triangles"), e.at("what"),
                     e.at("source"), e.at("licence"), e.at("scale"), e.at("axes")});
    return all;
  }();
  return entries;
}

const CatalogueEntry* catalogue_entry(std::string_view name) {
  for (const CatalogueEntry& entry : mesh_catalogue())
    if (entry.name == name) return &entry;
  return nullptr;
}

std::vector<fs::path> mesh_folders() {
  std::vector<fs::path> folders;
  if (const auto given = given_folder()) folders.push_back(*given);
  if (const auto user = user_folder()) folders.push_back(*user);
  std::error_code failed;
  const auto program = fs::read_symlink("/proc/self/exe", failed);
  if (!failed) folders.push_back(program.parent_path().parent_path() / "share" / "cowgpu" / "meshes");
  folders.emplace_back(COWGPU_SOURCE_MESHES);
  return folders;
}

fs::path own_mesh_folder() {
  if (const auto given = given_folder()) return *given;
  if (const auto user = user_folder()) return *user;
  throw Error(Fault::bad_argument,
              "there is no folder for meshes: neither COWGPU_MESHES nor HOME is set; set COWGPU_MESHES");
}

std::string read_catalogued(const CatalogueEntry& entry) {
  std::string looked, other;
  for (const fs::path& folder : mesh_folders()) looked += (looked.empty() ? "" : ", ") + folder.string();
  for (const fs::path& path : candidates(entry)) {
    std::string bytes = read_file(path);
    const std::string hash = sha256_hex(bytes);
    if (hash == entry.sha256) return bytes;
    other += fmt::format("; {} is another mesh (sha256 {})", path.string(), hash);
  }
  throw Error(
      Fault::mesh_missing,
      fmt::format("the mesh {} ({}) is not on this machine: {} with sha256 {} was looked for in {}{}. It is {}. "
                  "`cowgpu meshes add FILE` checks a file and puts it where it is found; COWGPU_MESHES names a folder "
                  "of your own. The built-in cow needs no "
                  "file: builtin:cow",
                  entry.name, entry.what, entry.file, entry.sha256, looked, other, entry.source));
}

std::optional<fs::path> find_catalogued(const CatalogueEntry& entry) {
  for (const fs::path& path : candidates(entry)) {
    try {
      if (sha256_hex(read_file(path)) == entry.sha256) return path;
    } catch (const Error&) { // no permission: perhaps another folder has it
    }
  }
  return {};
}

const CatalogueEntry& add_mesh(const fs::path& file) {
  const std::string bytes = read_file(file);
  const std::string hash = sha256_hex(bytes);
  for (const CatalogueEntry& entry : mesh_catalogue()) {
    if (entry.sha256 != hash) continue;
    const fs::path to = own_mesh_folder() / entry.file;
    std::error_code failed;
    fs::create_directories(to.parent_path(), failed);
    if (failed)
      throw Error(Fault::cannot_write,
                  fmt::format("the folder {} cannot be made: {}; name another one in COWGPU_MESHES",
                              to.parent_path().string(), failed.message()));
    if (fs::exists(to, failed) && sha256_hex(read_file(to)) != hash)
      throw Error(Fault::cannot_write, fmt::format("{} is another mesh, and is left as it is; move it away, or name "
                                                   "another folder in COWGPU_MESHES",
                                                   to.string()));
    AtomicFile out(to);
    out.write(bytes);
    out.commit();
    return entry;
  }
  throw Error(
      Fault::file_format,
      fmt::format("{}: the catalogue has no file of its SHA-256, {}; `cowgpu meshes` lists those it has. A mesh of "
                  "your own needs no name: give its path",
                  file.string(), hash));
}

} // namespace cowgpu

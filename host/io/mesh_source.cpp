#include "host/io/mesh_source.hpp"

#include "host/error.hpp"
#include "host/io/file.hpp"
#include "host/io/mesh_format.hpp"
#include "host/io/off.hpp"
#include "host/io/sha256.hpp"
#include "host/mesh/builtin.hpp"

#include <fmt/format.h>

#include <cstdlib>

namespace cowgpu {
namespace {

RawMesh load_benchmark() {
  std::string looked, other;
  for (const auto& folder : mesh_folders()) {
    const auto path = folder / "cow.off";
    looked += fmt::format("{}{}", looked.empty() ? "" : ", ", folder.string());
    if (std::error_code none; !std::filesystem::is_regular_file(path, none)) continue;
    RawMesh mesh = parse_off(read_file(path), "benchmark");
    if (mesh.sha256 == benchmark_sha256) return mesh;
    other += fmt::format("; {} is another mesh (sha256 {})", path.string(), mesh.sha256);
  }
  throw Error(
      Fault::mesh_missing,
      fmt::format("the benchmark mesh is not on this machine: cow.off with sha256 {} was looked for in {}{}. It is "
                  "cow.off of the libigl tutorial's data (github.com/libigl/libigl-tutorial-data); put it into one "
                  "of these folders or name its folder in COWGPU_MESHES. The built-in cow needs no file: "
                  "builtin:cow",
                  benchmark_sha256, looked, other));
}

} // namespace

std::vector<std::filesystem::path> mesh_folders() {
  std::vector<std::filesystem::path> folders;
  if (const char* own = std::getenv("COWGPU_MESHES"); own && *own) folders.emplace_back(own);
  std::error_code failed;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", failed);
  if (!failed) folders.push_back(program.parent_path().parent_path() / "share" / "cowgpu" / "meshes");
  folders.emplace_back(COWGPU_SOURCE_MESHES);
  return folders;
}

RawMesh load_mesh(const std::string& name) {
  constexpr std::string_view builtin = "builtin:";
  if (name.rfind(builtin, 0) == 0) {
    RawMesh mesh = builtin_mesh(std::string_view(name).substr(builtin.size()));
    mesh.sha256 = sha256_of_geometry(mesh);
    return mesh;
  }
  if (name == "benchmark") return load_benchmark();
  if (name == "-") return parse_mesh(read_file("/dev/stdin"), "standard input");
  return parse_mesh(read_file(name), name);
}

} // namespace cowgpu

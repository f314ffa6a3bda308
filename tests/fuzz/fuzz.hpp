// What the fuzz targets share. A target gives bytes to one reader; the reader returns or throws cowgpu::Error, and
// everything else (another exception, a signal, a sanitizer's finding, too much memory, too long a time) is a finding.
#pragma once

#include "host/error.hpp"
#include "host/mesh/closed_surface.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace cowgpu::fuzz {

inline std::string_view bytes_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// A reader's promise about what it returns, then the checks that every mesh goes through.
inline void take(RawMesh mesh) {
  for (const Face& face : mesh.faces)
    for (const std::uint32_t v : face)
      if (v >= mesh.vertices.size()) std::abort();
  if (!mesh.face_lines.empty() && mesh.face_lines.size() != mesh.faces.size()) std::abort();
  if (mesh.sha256.size() != 64) std::abort();
  ManifoldSurface::from(ClosedSurface::from(std::move(mesh)));
}

template <class Work>
int run(Work&& work) {
  try {
    work();
  } catch (const Error&) {
  }
  return 0;
}

/// Gives the bytes to a reader of paths, as a file in memory; `suffix` is the file's.
template <class Read>
int run_on_file(const std::uint8_t* data, std::size_t size, const std::string& suffix, Read&& read) {
  static const std::string path = "/dev/shm/cowgpu-fuzz-" + std::to_string(getpid()) + suffix;
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes_of(data, size);
  const int result = run([&] { read(path); });
  unlink(path.c_str());
  return result;
}

} // namespace cowgpu::fuzz

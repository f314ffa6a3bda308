#include "host/io/ply.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace cowgpu;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run([&] {
    const PlyMesh mesh = read_ply_positions(fuzz::bytes_of(data, size), "x");
    for (const Face& face : mesh.faces)
      for (const std::uint32_t v : face)
        if (v >= mesh.vertices.size()) std::abort();
  });
}

#include "host/io/gltf.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace cowgpu;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run([&] { fuzz::take(parse_gltf(fuzz::bytes_of(data, size), "x")); });
}

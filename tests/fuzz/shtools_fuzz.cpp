#include "host/io/shtools_text.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace cowgpu;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run_on_file(data, size, ".sh", [](const std::string& path) { read_shtools_text(path); });
}

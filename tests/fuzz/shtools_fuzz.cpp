#include "host/io/shtools_text.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace cowgpu;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run([&] {
    const std::string_view bytes = fuzz::bytes_of(data, size);
    looks_like_shtools_text(bytes);
    parse_shtools_text(bytes, "input.sh");
  });
}

#include "host/io/plates.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace cowgpu;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run([&] { fuzz::take(parse_plates(fuzz::bytes_of(data, size), "x")); });
}

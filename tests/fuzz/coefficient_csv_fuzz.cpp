#include "host/io/coefficient_formats.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace cowgpu;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run([&] {
    const std::string_view bytes = fuzz::bytes_of(data, size);
    parse_csv_coefficients(bytes, "input.csv", "");
  });
}

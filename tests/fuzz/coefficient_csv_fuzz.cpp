#include "host/io/coefficient_formats.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace cowgpu;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run_on_file(data, size, ".csv", [](const std::string& path) { read_csv_coefficients(path, ""); });
}

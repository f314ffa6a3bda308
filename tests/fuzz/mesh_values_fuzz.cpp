#include "host/io/mesh_values_read.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace cowgpu;

// The table, a zero byte, and the JSON beside it.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::bytes_of(data, size);
  const std::size_t end = std::min(bytes.find('\0'), bytes.size());
  const std::string about(bytes.substr(std::min(end + 1, bytes.size())));
  return fuzz::run([&] {
    const MeshValues values = parse_mesh_values(bytes.substr(0, end), about, "x.csv");
    for (const ValueColumn& column : values.columns)
      if (column.values.size() != values.places.size() * std::size_t(column.components)) __builtin_trap();
  });
}

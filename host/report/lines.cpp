#include "host/report/result.hpp"

#include <fmt/format.h>

namespace cowgpu {

std::string mesh_line(const RawMesh& mesh) {
  return fmt::format("mesh {}, sha256 {}, {} triangles", mesh.name, mesh.sha256, mesh.faces.size());
}

std::string device_line(const DeviceFacts& device) {
  if (device.type == "cpu")
    return fmt::format("CPU path on {}, {}, {} thread{}", device.name, device.driver, device.threads,
                       device.threads == 1 ? "" : "s");
  return fmt::format("{} on {}, {}, {}{}", device.api, device.name, device.driver, device.type,
                     device.type == "software" ? " device: no GPU, the CPU runs the shaders" : "");
}

} // namespace cowgpu

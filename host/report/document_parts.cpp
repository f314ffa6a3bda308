#include "host/report/document_parts.hpp"

#include "host/io/document_json.hpp"

#include <fmt/chrono.h>

#include <ctime>

namespace cowgpu {

std::string utc_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

Object opening(const std::string& schema, const std::vector<std::string>& command, const std::string& created) {
  return {{"schema", schema}, {"program", program()}, {"command", command}, {"created", created}};
}

Object members(const RawMesh& mesh) {
  return {
      {"name", mesh.name}, {"sha256", mesh.sha256}, {"vertices", mesh.vertices.size()}, {"faces", mesh.faces.size()}};
}

Object members(const DeviceFacts& device) {
  return {{"path", device.type == "cpu" ? "cpu" : "vulkan"},
          {"name", device.name},
          {"type", device.type},
          {"driver", device.driver},
          {"api", device.api},
          {"threads", device.threads},
          {"subgroup_size", device.subgroup}};
}

List entries(const std::vector<KernelTime>& kernels) {
  List all;
  for (const KernelTime& k : kernels)
    all.push_back(Object{{"kernel", k.kernel}, {"dispatches", k.dispatches}, {"seconds", k.seconds}});
  return all;
}

Object quantiles(std::span<const double> parts, std::span<const double> values) {
  return {{"parts", parts}, {"values", values}};
}

} // namespace cowgpu

#include "host/report/json_parts.hpp"

#include "host/io/shown.hpp"
#include "host/version.hpp"

#include <fmt/chrono.h>
#include <nlohmann/json.hpp>

#include <ctime>

namespace cowgpu {

using nlohmann::ordered_json;

ordered_json device_json(const DeviceFacts& device) {
  return {{"path", device.type == "cpu" ? "cpu" : "vulkan"},
          {"name", device.name},
          {"type", device.type},
          {"driver", device.driver},
          {"api", device.api},
          {"threads", device.threads},
          {"subgroup_size", device.subgroup}};
}

ordered_json program_json() {
  return {{"name", "cowgpu"}, {"version", version}};
}

std::string json_text(const ordered_json& document) {
  return terminal_json(document.dump(1, ' ', false, ordered_json::error_handler_t::replace));
}

std::string json_members(const ordered_json& object) {
  std::string text = json_text(object);
  text.pop_back();
  text.erase(text.find_last_not_of("\n ") + 1);
  return text;
}

ordered_json quantiles_json(std::span<const double> parts, std::span<const double> values) {
  return {{"parts", parts}, {"values", values}}; // the library writes infinity as null
}

std::string utc_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

} // namespace cowgpu

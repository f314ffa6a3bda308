#include "host/map/map_method.hpp"

namespace cowgpu {

std::string_view name(MapMethod method) {
  switch (method) {
  case MapMethod::harmonic: return "harmonic";
  case MapMethod::stretch: return "stretch";
  case MapMethod::smooth: return "smooth";
  case MapMethod::flow: return "flow";
  case MapMethod::file: return "file";
  }
  return "unknown";
}

std::optional<MapMethod> map_method_named(std::string_view word) {
  for (const MapMethod method : made_maps)
    if (word == name(method)) return method;
  return {};
}

} // namespace cowgpu

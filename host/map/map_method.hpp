// The maps to the sphere that there are, by name.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace cowgpu {

/// How a surface is mapped to the unit sphere.
enum class MapMethod {
  harmonic, ///< discrete harmonic functions on a disk (host/map/harmonic.hpp)
  stretch,  ///< least stretch: every part of the body keeps room on the sphere (host/map/stretch.hpp)
  smooth,   ///< discrete conformal, by smoothing (host/map/smooth.hpp)
  flow,     ///< along the gradient of the distance to the body (host/flow/flow_map.hpp)
  file,     ///< read from a file (host/io/map_file.hpp)
};

/// The maps that can be made, in the order in which results list their expansions.
inline constexpr std::array made_maps = {MapMethod::harmonic, MapMethod::stretch, MapMethod::smooth, MapMethod::flow};

/// "harmonic", "stretch", "smooth", "flow", "file".
std::string_view name(MapMethod method);

/// One of made_maps by its name; nothing for another word.
std::optional<MapMethod> map_method_named(std::string_view word);

} // namespace cowgpu

// The words for where `potential` asks for a field: a place, a file of points, a sphere, a plane, a lattice.
#pragma once

#include "host/requests/places.hpp"

#include <string>

namespace cowgpu::cli {

/// As typed.
struct PlaceOptions {
  std::string at, sphere, plane, grid;
  int resolution = 37; ///< rings of the sphere
  bool any() const { return !at.empty() || !sphere.empty() || !plane.empty() || !grid.empty(); }
};

/// Throws Error(bad_argument) where not exactly one of the four is given, and for what cannot be read; what read_points()
/// throws.
PlaceRequest parse_places(const PlaceOptions& options);

} // namespace cowgpu::cli

// Where `potential` asks for a field: a place, a file of points, a sphere, a plane.
#pragma once

#include "host/sphere_grid.hpp"
#include "host/types.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu::cli {

/// As typed.
struct PlaceOptions {
  std::string at, sphere, plane;
  int resolution = 37; ///< rings of the sphere
  bool any() const { return !at.empty() || !sphere.empty() || !plane.empty(); }
};

/// What a body's places are measured by.
struct PlaceFrame {
  Vec3 origin = Vec3::Zero(); ///< in the body's coordinates
  double radius = 1;   ///< 1R: of the sphere that holds it; of a file that does not say that one, its reference radius
  bool metric = false; ///< lengths may have units
};

struct Places {
  std::string name;               ///< "sphere of radius 2"
  std::vector<Vec3> points;       ///< in the body's coordinates
  std::optional<SphereGrid> grid; ///< grid of a sphere, its points ring by ring
  double radius = 0;              ///< radius of that sphere
};

/// How many points they will be, before any is made; 0 where a file says.
std::size_t count_places(const PlaceOptions& options);

/// Throws Error(bad_argument) where not exactly one of the three is given, for what cannot be read, a radius or an extent
/// that is not above 0; what read_points() throws.
Places read_places(const PlaceOptions& options, const PlaceFrame& frame);

} // namespace cowgpu::cli

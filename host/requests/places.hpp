// Where a field is asked for: points, a sphere, a plane, a lattice.
#pragma once

#include "host/sphere_grid.hpp"
#include "host/types.hpp"
#include "host/units.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace cowgpu {

/// A length: in metres where it has a unit, else in the body's unit, or in multiples of the sphere that holds the body.
struct Reach {
  Measure length;
  bool radii = false;
};

/// Points in the body's coordinates.
struct PointsRequest {
  std::vector<Vec3> points;
  std::string name; ///< that results call them
};

/// A sphere about the body's origin, on the rings of a Gauss-Legendre grid.
struct SphereRequest {
  Reach radius;
  int rings = 37;
};

/// Points of a plane across an axis, as far to all four sides of where it cuts that through the body's origin.
struct PlaneRequest {
  int axis = 2; ///< 0: x, 1: y, 2: z
  Reach offset, extent;
  int count = 101; ///< points along each side, 2 at least
};

/// A lattice in a cube about the body's origin along its axes, as far to all six sides.
struct GridRequest {
  Reach extent;
  int count = 51; ///< points along each side, 2 at least
};

using PlaceRequest = std::variant<PointsRequest, SphereRequest, PlaneRequest, GridRequest>;

/// What a body's places are measured by.
struct PlaceFrame {
  Vec3 origin = Vec3::Zero(); ///< in the body's coordinates
  double radius = 1; ///< radius of the sphere that holds it; of a file that does not say that one, its reference radius
  bool metric = false; ///< lengths may have units
};

struct Places {
  std::string name;               ///< "sphere of radius 2"
  std::vector<Vec3> points;       ///< in the body's coordinates
  std::optional<SphereGrid> grid; ///< grid of a sphere, its points ring by ring
  double radius = 0;              ///< radius of that sphere
  std::array<int, 3> lattice{};   ///< points along x, y and z of a lattice, x running fastest; zeros elsewhere
};

/// Upper bound of how many points there will be, before any is made. Throws Error(bad_argument) for an axis or a number of
/// points or rings that there is not.
std::size_t count_places(const PlaceRequest& request);

/// Throws Error(bad_argument) for a radius or an extent that is not above 0, and for a length with a unit where the body has
/// none; what count_places() throws.
Places find_places(const PlaceRequest& request, const PlaceFrame& frame);

} // namespace cowgpu

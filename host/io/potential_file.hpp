// Potentials at points, in files.
//
// CSV: lines "# key value" (cowgpu, input, potential, acceleration, gradient: the units), then the names x,y,z,potential,
//   ax,ay,az,axx,axy,axz,ayy,ayz,azz (of charges: ex ... ezz), of magnets b_x,b_y,b_z and, where some points are the
//   polyhedron's, exact (1 or 0).
// netCDF: the same as variables over `point`, over (lat, lon) for a sphere, whose radius is the attribute `radius`, or over
//   (z, y, x) for a lattice, whose coordinates are the variables z, y and x.
#pragma once

#include "host/io/atomic_file.hpp"
#include "host/io/file_format.hpp"
#include "host/monitor.hpp"
#include "host/potential.hpp"
#include "host/sphere_grid.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

/// What a file of potentials holds. References stay the caller's.
struct PotentialTable {
  std::string input;
  std::span<const Vec3> points;
  const PotentialField& field;         ///< in the units below
  std::span<const std::uint8_t> exact; ///< empty: none is
  bool charge = false;                 ///< ex ... instead of ax ...
  std::string length_unit, potential_unit, force_unit, tensor_unit;
  std::optional<SphereGrid> grid;    ///< where the points are one, ring by ring
  double radius = 0;                 ///< radius of that sphere
  std::span<const Vec3> induction{}; ///< B in tesla; empty: not of a magnet
  std::array<int, 3> lattice{};      ///< points along x, y and z where they are one, x running fastest; zeros elsewhere
};

/// Writes either format; commit() is left to the caller. Throws Error(cannot_write, too_large, interrupted).
void write_potentials(const PotentialTable& table, FileFormat format, AtomicFile& file, const Monitor& monitor);

/// Upper bound of the bytes that takes.
std::uint64_t potential_file_bytes(std::uint64_t points);

} // namespace cowgpu

// What is found out about gravity on the surface of a body.
#pragma once

#include "host/mesh_values.hpp"
#include "host/physics/findings.hpp"
#include "host/physics/surface_gravity.hpp"
#include "host/run_report.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

struct SurfaceGravityResult {
  physics::Subject subject;
  bool si = false;                                    ///< units are stated
  double constant = 1;                                ///< G
  double density = 0, mass = 0, volume = 0, area = 0; ///< density and volume of the surface, mass with the parts
  Vec3 size = Vec3::Zero();                           ///< sides of the surface's box
  Vec3 centre_of_mass = Vec3::Zero();
  double radius = 0;        ///< of the ball of that volume, R
  double gravity_scale = 0; ///< G M/R^2
  std::optional<physics::Spin> spin;
  double height = 0;    ///< of the places above faces or vertices
  std::string places;   ///< what they are, in words
  double tolerance = 0; ///< of GM/R^2; 0: all faces were summed everywhere
  bool guarantee = false;
  double potential_error = 0, gravity_error = 0; ///< estimated, the largest
  std::uint64_t far_points = 0;                  ///< places where the body's series was nearer to the truth
  double mean_geopotential = 0;                  ///< by area; of faces and vertices
  std::vector<double> areas;                     ///< of the places; empty for points
  MeshValues values;
  RunReport run;
  std::string device; ///< what computed it, in words
};

/// Fills `result.values.columns` from these, whose arrays it takes over, and `bound`, empty or one entry a place.
void take_columns(physics::SurfaceGravity gravity, std::vector<double> bound, SurfaceGravityResult& result);

/// How many numbers a place has then.
std::uint64_t surface_gravity_numbers(ValuePlace place, bool guarantee);

/// What `cowgpu surface` shows of it: ranges of all columns, slopes by area, and what the body is.
physics::Findings findings(const SurfaceGravityResult& result);

} // namespace cowgpu

// What is found out about the field outside a body.
#pragma once

#include "host/io/potential_file.hpp"
#include "host/physics/body_field.hpp"
#include "host/physics/findings.hpp"
#include "host/physics/potential.hpp"
#include "host/sphere_grid.hpp"

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// Names of the units that a field is in.
struct FieldUnits {
  std::string length, potential, force, tensor;
};

struct PotentialResult {
  physics::Subject subject;
  bool si = false;       ///< units are stated
  physics::FieldLaw law; ///< gravity, or charges
  Vec3 origin = Vec3::Zero();
  bool origin_known = true; ///< else places are counted from it
  double radius = 0;        ///< radius of the sphere that holds the body; where not known the reference radius
  std::string radius_note;  ///< why it is not known, or empty
  std::optional<double> reference_radius; ///< of a file
  int lmax = 0;
  bool all_exact = false; ///< the polyhedron was asked for everywhere, and no series to degree lmax
  std::string places;     ///< what the points are
  std::vector<Vec3> points;
  std::optional<SphereGrid> grid; ///< grid of a sphere, its points ring by ring
  double sphere_radius = 0;       ///< radius of that sphere
  std::array<int, 3> lattice{};   ///< points along x, y and z of a lattice, x running fastest; zeros elsewhere
  PotentialField field;
  std::optional<Vec3> magnetisation;                         ///< A/m, of a magnet
  std::vector<Vec3> induction;                               ///< its B in tesla
  std::vector<std::uint8_t> exact;                           ///< 1 where it is the closed form's; empty: nowhere
  std::vector<double> density;                               ///< where exact
  std::size_t exact_points = 0, far_points = 0;              ///< by the polyhedron; where its series was better
  physics::FieldSum exact_sum = physics::FieldSum::extended; ///< how the closed form was summed
  double exact_error = 0;                                    ///< estimated, the largest of these points
  double nearest = std::numeric_limits<double>::infinity();  ///< nearest point of the series, in radii
  std::string device;                                        ///< what computed it, in words

  bool radius_known() const { return radius_note.empty(); }
};

/// In SI where units are stated, else with Newton's or Coulomb's constant as 1.
FieldUnits field_units(const PotentialResult& result);

/// What `cowgpu potential` shows of it: rows, tables and notes with their units.
/// With a table of the points where they are no more than `most_points`.
physics::Findings findings(const PotentialResult& result, std::size_t most_points);

/// What a file of it holds; the result must outlive it.
PotentialTable potential_table(const PotentialResult& result);

struct SeriesErrorsResult {
  physics::Subject subject;
  bool si = false;
  Vec3 origin = Vec3::Zero();
  double radius = 0; ///< radius of the sphere that holds the body
  physics::SeriesErrors errors;
};

/// What `cowgpu potential --errors` shows of it: rows, tables and notes with their units.
physics::Findings findings(const SeriesErrorsResult& result);

} // namespace cowgpu

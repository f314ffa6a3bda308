// The bodies that users ask for: a mesh that is mended, placed and weighed, or the coefficients of a mass.
#pragma once

#include "host/backend.hpp"
#include "host/coefficient_set.hpp"
#include "host/mesh/body.hpp"
#include "host/mesh/mend.hpp"
#include "host/physics/findings.hpp"
#include "host/physics/rigid_body.hpp"
#include "host/units.hpp"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// A mesh that adds to the density inside its surface (a negative density digs a hole), in the units and axes of the body.
struct PartRequest {
  std::string mesh;
  double density = 1;
};

struct BodyRequest {
  std::string mesh = "builtin:cow";  ///< as load_mesh() takes it; of load_mass() also a file of coefficients
  Mending mending;                   ///< what mends it, before it is placed
  std::optional<double> length_unit; ///< metres that 1 in the file stands for
  std::optional<double> length;      ///< metres along the longest side of the mesh's box; instead of length_unit
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity(); ///< from the file's axes to the body's
  OriginChoice origin;
  /// kg/m^3 where one of the lengths is given, else in the mesh's unit; 1 where it is not given.
  std::optional<double> density;
  bool charge = false; ///< densities are of charge: C/m^3
  std::vector<PartRequest> parts;
  /// Radius of the sphere about the origin of coefficients that holds the body, where they do not say it.
  std::optional<Measure> brillouin_radius;
  std::vector<std::string> notes; ///< sentences that come before those about the body

  bool units_stated() const { return length_unit || length; }
};

/// Throws Error(bad_argument) where a request places a mesh: for those that are about a file of coefficients.
void refuse_placing(const BodyRequest& request);

/// Reads a mesh and mends it; what was done is in its notes. Throws what load_mesh() and mend() throw.
RawMesh load_mended(const std::string& mesh, const Mending& mending, Monitor& monitor);

/// Reads mesh and parts, places them and measures the body; sentences about what was done go to `notes`. Throws
/// Error(bad_argument) for lengths that do not go together, and what load_mended(), ClosedSurface::from() and make_body()
/// throw; errors of a part begin with its name.
Body load_body(const BodyRequest& request, std::vector<std::string>& notes, Monitor& monitor);

/// A mesh with its parts, or coefficients of a mass: one of both.
struct LoadedMass {
  std::string name; ///< of the input
  std::optional<Body> mesh;
  std::optional<CoefficientSet> coefficients; ///< as in the file, but for a density and a radius that were stated
  Units units;
  std::vector<std::string> notes;
};

/// How a body moves.
enum class Motion {
  held, ///< about its origin
  free, ///< about its centre of mass, which a mesh's origin becomes whatever was asked for
};

/// Reads either. Throws what load_body(), read_coefficient_set() and physics::check_mass_multipoles() throw,
/// Error(bad_argument) where the request places a mesh and the file holds coefficients, for units or a radius that the file
/// says otherwise, and for a free body that weighs nothing.
LoadedMass load_mass(const BodyRequest& request, Motion motion, Monitor& monitor);

/// For what has no meaning without kilograms: throws Error(bad_argument) with what to give where no units are stated, and
/// Error(file_format) for coefficients of no mass, to which no units would help.
void require_units(const LoadedMass& loaded);

/// The least and largest order that free_body() is asked for.
inline constexpr int least_multipole_order = 2, largest_multipole_order = 64;

/// Throws Error(bad_argument) for an order beyond these.
void check_multipole_order(int order);

/// To degree 2 about its origin.
physics::RigidBody rigid_body(const LoadedMass& loaded);

/// About its centre of mass, with degrees to `order`: of a mesh its own exact moments, else those of the file. Throws what
/// physics::free_body() throws.
physics::RigidBody free_body(const LoadedMass& loaded, int order, Monitor& monitor);

/// Moments about its origin to degree `lmax`, or what a file holds of it, in the units of `loaded`: over the sphere that
/// holds the body, or over the file's own radius where nothing says that one. Throws what physics::mass_moments() throws.
Multipoles moments(const LoadedMass& loaded, int lmax, Backend& backend, Monitor& monitor);

/// Name, hash and notes, for the head of a report.
physics::Subject subject(const LoadedMass& loaded);

/// A sentence about a file that does not say the radius of the sphere that holds its body; empty for all other inputs.
std::string unknown_radius_note(const LoadedMass& loaded);

/// A sentence on the density that was taken where units are stated and it was not; empty elsewhere.
std::string density_note(const BodyRequest& request, const Units& units);

} // namespace cowgpu

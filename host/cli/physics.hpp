// The applications of the multipoles: one row of a table each makes subcommand, help, JSON and report.
#pragma once

#include "host/cli/body_options.hpp"
#include "host/cli/commands.hpp"
#include "host/coefficient_set.hpp"
#include "host/physics/findings.hpp"
#include "host/physics/point_mass.hpp"
#include "host/physics/tensors.hpp"

#include <functional>
#include <optional>
#include <string>

namespace cowgpu::cli {

/// What every application has.
struct PhysicsOptions {
  BodyOptions body; ///< body.mesh is MESH|COEFFS
  std::string recipe = "default";
  std::string brillouin_radius; ///< as typed; for files that do not say it
  bool json = false;
  bool density_given = false; ///< by --density or the recipe
  bool paper() const { return recipe == "paper"; }
};

/// A mesh with its parts, or a file of coefficients: one of both.
struct PhysicsInput {
  std::optional<Body> body;
  std::optional<CoefficientSet> coefficients;
  std::vector<std::string> notes;
};

/// Throws Error(bad_argument) for options that place a mesh, where the input is coefficients.
void refuse_placing(const BodyOptions& body);

/// Reads either. Options that place a mesh are refused for coefficients: Error(bad_argument). Throws what load_body() and
/// read_coefficient_set() throw.
PhysicsInput load_input(const PhysicsOptions& options);

/// The same for a body that moves freely, and so turns about its centre of mass: a mesh's origin is that, whatever --origin
/// says, and a note says so. Throws Error(bad_argument) also where body and parts weigh nothing.
PhysicsInput load_free_body(const PhysicsOptions& options);

/// An input's tensors, about its origin; in `unit_m` and `unit_kg` what the unit of length of the mesh (or the file), and its
/// cube times the density, are in SI. Without --length-unit and --length neither is known.
struct PlacedTensors {
  physics::MassTensors tensors;
  std::optional<double> unit_m, unit_kg;
};
PlacedTensors placed_tensors(const PhysicsInput& input, const PhysicsOptions& options);

/// Tensors in SI, for what has no meaning without units. Throws Error(bad_argument) that names the options to give.
PlacedTensors metric_tensors(const PhysicsInput& input, const PhysicsOptions& options);

/// Its body with degrees to `order`, for a point mass outside: of a mesh its own exact moments, else those of the file.
physics::MassiveBody massive_body(const PhysicsInput& input, const PlacedTensors& placed, int order);
/// An input's moments about its origin, in SI where units are stated.
struct PlacedMoments {
  Multipoles moments;
  bool metric = false;
  double metres = 1;        ///< that a file's unit of length was turned into
  bool radius_known = true; ///< the moments are over the sphere that holds the body; else over the file's own radius
};

/// To degree `lmax`, or what a file holds of it. Throws Error(bad_argument) for --charge with a file in kilograms; what
/// mass_moments() throws.
PlacedMoments placed_moments(const PhysicsInput& input, const PhysicsOptions& options, int lmax, Backend& backend,
                             Monitor& monitor);

/// A sentence about a file that does not say the radius of the sphere that holds its body; empty for all other inputs.
std::string unknown_radius_note(const PhysicsInput& input);

/// Name, hash and notes of an input, for the head of a report.
physics::Findings findings_about(const PhysicsInput& input, const PhysicsOptions& options);

/// Where kilograms are the result and nobody said how dense the body is: a note that says what was taken.
void note_density(const PhysicsOptions& options, bool metric, std::vector<std::string>& notes);

/// Computes, once the options are parsed.
using Solve = std::function<physics::Findings(const PhysicsOptions&)>;

/// A subcommand. `add` adds the options that are its own (of one that needs a device, add_common_options() too) and returns
/// what to do; the JSON is cowgpu.NAME.v1.
struct Application {
  const char* name;
  const char* summary;
  const char* footer;
  Solve (*add)(Command& command, Common& common);
  bool paper_of_formulas = false; ///< what it lays beside the paper holds for every body
  bool asks_radius = false;       ///< it takes --brillouin-radius for files that do not say it
};

Solve add_tensors(Command& command, Common& common);
Solve add_potential(Command& command, Common& common);
Solve add_radiate(Command& command, Common& common);
Solve add_tides(Command& command, Common& common);
Solve add_drop(Command& command, Common& common);
Solve add_tip(Command& command, Common& common);

} // namespace cowgpu::cli

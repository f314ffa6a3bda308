// What tips a standing body over onto its side: of the body itself, and of the orders of its surface.
#pragma once

#include "host/report/tip_findings.hpp"
#include "host/requests/load_body.hpp"
#include "host/spectrum/reconstruct.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

struct TipRequest {
  BodyRequest body;                          ///< y is up; a mesh, or a file with the coefficients of a surface
  std::vector<int> orders;                   ///< bodies of these orders of the surface are tipped too
  std::string of;                            ///< map of a mesh, or an expansion of a file; empty: stretch
  SurfaceFields fields = SurfaceFields::xyz; ///< that orders are rebuilt from
  std::string mesh;                          ///< the true body beside coefficients, or empty
  int lmax = -1;                             ///< degree of a mesh's expansion; below 0: enough for the orders
  int resolution = 0;                ///< degree of the grid of rebuilt bodies; 0: four times the order within bounds
  std::optional<physics::Side> side; ///< that it falls to; empty: the one that needs less
  bool smooth = false;               ///< the mesh stands for a smooth surface
  bool as_modelled = false;          ///< it does not settle first
  std::optional<Measure> contact_tolerance;   ///< height of what touches the ground, in metres or the body's own unit
  double gravity = physics::standard_gravity; ///< m/s^2
  std::optional<double> friction;             ///< coefficient of the feet
  PushRequest push;
  bool boundary = false;          ///< that of pushes is what is wanted: a body without units or threshold is refused
  std::vector<std::string> notes; ///< sentences that come after those about the body
};

/// Whether tip() expands or rebuilds a surface for this request, on the backend that it is given.
bool rebuilds_surfaces(const TipRequest& request);

/// The mass is that of load_mass() for a mesh and of physics::smooth_body() for coefficients. Throws what load_mass(),
/// load_surface(), read_coefficient_set() and physics::stand() throw, Error(file_format) for coefficients of a mass, and
/// Error(bad_argument) for orders beyond the expansion, a gravity or weight out of range, and pushes of a body without units.
TipResult tip(const TipRequest& request, Backend& backend, Monitor& monitor);

} // namespace cowgpu

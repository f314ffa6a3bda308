// What `tip` stands on the ground: a mesh, or the surface that coefficients make, and that surface at any order.
#pragma once

#include "host/cli/physics.hpp"
#include "host/physics/tip.hpp"
#include "host/spectrum/reconstruct.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu::cli {

/// What the options say.
struct TipChoice {
  std::vector<std::string> orders; ///< as typed
  std::string of;                  ///< a map, or an expansion of a file; "": stretch
  std::string fields = "xyz";
  std::string mesh;   ///< the true body beside coefficients
  int lmax = -1;      ///< degree of a mesh's expansion; below 0: enough for the orders
  int resolution = 0; ///< degree of the grid of rebuilt bodies; 0: tip_resolution()
  bool paper = false; ///< spherical cow beside the paper
};

struct TipInput {
  physics::Subject head;
  physics::RigidBody full; ///< with its surface; metres and kilograms where metric
  std::string full_is;     ///< "the mesh", or which order stands for it
  std::vector<int> orders; ///< to rebuild
  SurfaceFields fields = SurfaceFields::xyz;
  std::optional<SurfaceExpansion> expansion; ///< in the units of `full`
  std::string expansion_name;
  std::unique_ptr<Backend> backend; ///< where there is an expansion
};

/// Reads the body and, where orders are asked for or coefficients are given, its surface's expansion. Throws what
/// load_body(), load_surface() and read_coefficient_set() throw, and Error(file_format) for coefficients of a mass.
TipInput load_tip_input(const BodyRequest& request, const TipChoice& choice, const Common& common);

/// The body of an order, with the mass of the whole. Throws what reconstruct() and smooth_body() throw.
physics::RigidBody order_body(const TipInput& input, const TipChoice& choice, int order, Monitor& monitor,
                              std::string& note);

/// A ball with this barycentre and mass, smooth, standing on one of its vertices as modelled.
physics::RigidBody ball_like(const physics::RigidBody& body, double volume);

} // namespace cowgpu::cli

// The figures of "Higher multipoles of the cow", and some that it lacks, of any body and its results. Each function draws a
// page, which plot::Canvas::write() puts into a file. Captions are the paper's where it has the figure.
#pragma once

#include "host/backend.hpp"
#include "host/flow/streamlines.hpp"
#include "host/map/sphere_map.hpp"
#include "host/mesh/raw_mesh.hpp"
#include "host/mesh_values.hpp"
#include "host/multipoles.hpp"
#include "host/physics/tip.hpp"
#include "host/plot/canvas.hpp"
#include "host/spectrum/reconstruct.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace cowgpu::figures {

/// What the mesh's length unit is called on axes.
inline constexpr const char* mesh_unit = "mesh units";

/// An expansion of a surface and what it is called in a legend: "gradient flow".
struct NamedExpansion {
  std::string name;
  const SurfaceExpansion* expansion = nullptr;
};

/// Power by degree l >= 1 of f_r, f_dtheta and f_dphi over each map, and of the mass moments over their radius, on
/// logarithmic axes: S_l = sum over m of |a_lm|^2. The panel of a kind that there is nothing of is left out. Throws
/// Error(bad_argument) where there is nothing at all.
plot::Canvas spectra_figure(plot::PictureFormat format, std::span<const NamedExpansion> expansions,
                            const Multipoles* mass, const std::string& unit = mesh_unit);

/// Cow geometry reconstructed with progressively higher multipoles: orders 0 to 7 and the mesh, in nine panels of one
/// scale with their names below. PNG. `title` may be empty. Throws what reconstruct() and Backend::render throw.
plot::Canvas orders_figure(const SurfaceExpansion& expansion, SurfaceFields fields, const RawMesh& mesh,
                           const View& view, const std::string& title, Backend& backend, Monitor& monitor);

/// The homeomorphism between the body and the sphere: in each column colours are the value of one component of f, on the
/// body and, below it, on the sphere in Mollweide's projection (the middle is phi = 0, theta = 0 is up). The means of the
/// two angles are removed, and of f_dphi the absolute value is shown, as in the paper's tables. A scale ends where half a hundredth of the
/// sphere, and of the vertices, is left beyond it, in its last colour. PNG. `origin` as in
/// SurfaceExpansion. Throws what SphereSampler::sample and Backend::render throw.
plot::Canvas components_figure(const RawMesh& mesh, const SphereMap& map, const Vec3& origin, const View& view,
                               const std::string& title, Backend& backend, Monitor& monitor,
                               const std::string& unit = mesh_unit);

/// The choice of f, seen along z: the point (theta, phi) of the sphere goes to F(theta, phi) on the body, which has a radius
/// f_r and another azimuth, by f_dphi. Shown for a vertex near the plane z = origin's z that the map puts near the equator,
/// beside the body's cut with that plane; the circle is what the plane cuts out of a sphere about the body. Throws
/// Error(map_failed) where no vertex does, what cut_by_plane throws.
plot::Canvas definition_figure(plot::PictureFormat format, const RawMesh& mesh, const SphereMap& map,
                               const Vec3& origin);

/// Increasing level sets of the distance: the body, inflated by a tenth and by three times its diagonal, with arrows for the
/// flow between them. PNG. Throws what level_surface and Backend::render throw.
plot::Canvas inflation_figure(const RawMesh& mesh, const View& view, Backend& backend, Monitor& monitor);

/// The gradient flow of the distance as a map to the circle: points where the plane cuts the body (blue), streamlines off
/// them (grey), and the directions of their ends as seen from the origin, on the circle (orange). Streamlines leave the plane; what is shown is
/// their projection, and directions are projected, then brought to the circle. Throws Error(mesh_empty) for a plane that misses
/// the body, what streamlines() throws.
plot::Canvas streamlines_figure(plot::PictureFormat format, const RawMesh& mesh, const Plane& plane, const Vec3& origin,
                                std::size_t lines, Backend& backend, Monitor& monitor,
                                const std::string& unit = mesh_unit);

/// A body on the ground and what begins to tip it.
struct TippedBody {
  const physics::Stance* stance = nullptr;
  const physics::Tipping* tipping = nullptr;
  std::string title;
};

/// The geometry of tipping, one panel a body, each of its own scale, seen from the front: x comes out of the page, z points to
/// its left. The push F_T at p_T, at right angles to the ray q from the pivot p through the barycentre b, and the ground's force
/// F_N at p; arrows say where forces act and where to, not how large they are. PNG. Throws what Backend::render throws.
plot::Canvas tipping_figure(std::span<const TippedBody> bodies, Backend& backend, Monitor& monitor);

/// A quantity on a body, in colours with their scale: shown_column(values, colour), over colour_range() of it. From several sides
/// where no view is named, all to one scale, with the mesh's axes. Of SVG, the bodies are a picture in it. Throws
/// Error(bad_argument) for values at points without faces, what check(values), shown_column() and Backend::render throw.
plot::Canvas surface_values_figure(plot::PictureFormat format, const MeshValues& values, const std::string& colour,
                                   std::span<const View> views, Backend& backend, Monitor& monitor);

/// A place in a plane: along Plane::u() and Plane::v().
struct PlanePoint {
  double u = 0, v = 0;
};
PlanePoint in_plane(const Plane& plane, const Vec3& x);

/// Where the plane meets a closed surface, as closed lines: for drawings of sections. Throws what cut_by_plane throws.
std::vector<std::vector<PlanePoint>> section(const RawMesh& mesh, const Plane& plane);

} // namespace cowgpu::figures

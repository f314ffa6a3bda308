// What the verb `render` shows: surfaces in panels, each seen from far away.
#pragma once

#include "host/types.hpp"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

/// Red, green and blue, linear, 0 to 1.
using Colour = std::array<float, 3>;

/// Where the eye is, in degrees: the azimuth from +z towards +x about the y axis, which points up, the elevation from
/// there towards +y. The projection is parallel.
struct View {
  double azimuth = 0, elevation = 0;

  /// Rows: to the right of the picture, up in the picture, towards the eye; mesh coordinates.
  Eigen::Matrix3d axes() const;
};

/// "side" (from +z: a body that looks along +x looks to the right), "front" (from +x), "back", "left" (the other side),
/// "top", "bottom", "iso" (45, 35.26), or two numbers "AZ,EL", |AZ| <= 360 and |EL| <= 90. Throws Error(bad_argument).
View parse_view(std::string_view text);
/// The words parse_view() knows, for help texts.
std::string view_names();

/// One surface. Faces are seen from both sides; they need not be closed. The spans are the caller's.
struct RenderSurface {
  std::span<const Vec3> vertices; ///< mesh coordinates
  std::span<const Face> faces;
  std::span<const Vec3> normals;               ///< unit vectors, one per vertex: smooth shading; empty: flat
  Colour colour = {0.555F, 0.435F, 0.315F};    ///< reflectance
  std::span<const Colour> vertex_colours = {}; ///< one per vertex, in place of it: linear between; or empty
};

/// Surfaces in common coordinates, and the part of space that is shown.
struct RenderPanel {
  std::vector<RenderSurface> surfaces;
  View view;
  Vec3 centre = Vec3::Zero(); ///< in the middle of the panel
  double height = 1;          ///< mesh length units from the panel's lower to its upper edge
};

/// Panels of one size, row by row from the upper left.
struct RenderScene {
  std::vector<RenderPanel> panels;
  int columns = 1;
  int panel_width = 800, panel_height = 600; ///< pixels
  bool transparent = false;                  ///< else on `background`
  Colour background = {1, 1, 1};

  int rows() const { return (int(panels.size()) + columns - 1) / columns; }
  int width() const { return columns * panel_width; }
  int height() const { return rows() * panel_height; }
};

/// Pixels a side of a picture may have.
inline constexpr int largest_picture = 16384;

/// Chooses centre and height so that all surfaces of the panel are seen with this margin, a part of the panel's smaller
/// side; the middle of their outline is in the middle. Several panels of one scale: the largest height for all.
void fit(RenderPanel& panel, int width, int height, double margin = 0.05);

/// Throws Error(bad_argument) for pictures of no size or sides beyond largest_picture, a view, centre or height that is
/// not finite, normals or colours of another number than the vertices; mesh_empty for a panel without faces; mesh_index_range;
/// mesh_not_finite.
void check(const RenderScene& scene);

} // namespace cowgpu

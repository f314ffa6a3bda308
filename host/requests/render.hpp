// Bodies in a picture, side by side and all to one scale: of meshes, or rebuilt at some orders.
#pragma once

#include "host/backend.hpp"
#include "host/figures/scene.hpp"
#include "host/requests/surface_source.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

struct PictureRequest {
  std::vector<TriangleSurface> bodies; ///< shaded smoothly where they have normals
  std::vector<View> views = {View{}};  ///< a panel for each body from each
  figures::SceneOptions panels;
};

/// Throws what Backend::render throws.
Image draw_picture(const PictureRequest& request, Backend& backend, Monitor& monitor);

struct RenderRequest {
  SurfaceChoice source; ///< with no order and no result file just its mesh, closed or not
  std::vector<std::optional<int>>
      orders; ///< orders to rebuild the body at; nothing: the mesh itself; none of a file: its lmax
  SurfaceFields fields = SurfaceFields::xyz;
  int resolution = 0; ///< degree of the Clenshaw-Curtis grid of vertices; 0: default_resolution() of each order
  bool flat = false;  ///< show the triangles: no smooth shading
  std::vector<View> views = {View{}};
  figures::SceneOptions panels;
  unsigned threads = 0; ///< threads that look for what is odd about a mesh; 0: all

  /// Whether bodies are rebuilt from an expansion.
  bool rebuilds() const { return !orders.empty() || is_result_file(source.input); }
};

struct RenderResult {
  Image image;
  std::vector<std::string> notes;
  std::size_t triangles = 0;
  double seconds = 0; ///< time of the drawing alone
};

/// Throws Error(bad_argument) for what render() refuses and no file need be read for.
void check_render(const RenderRequest& request);

/// Reads the mesh or the file, rebuilds and draws. Throws Error(bad_argument) for the mesh itself of a file without one and for
/// an order beyond the expansion or the resolution, mesh_index_range, too_large, and what load_surface(), reconstruct() and
/// Backend::render throw.
RenderResult render(const RenderRequest& request, Backend& backend, Monitor& monitor);

} // namespace cowgpu

#include "host/figures/scene.hpp"

#include <algorithm>
#include <cmath>

namespace cowgpu::figures {

RenderScene scene_of(std::span<const TriangleSurface> bodies, std::span<const View> views,
                     const SceneOptions& options) {
  RenderScene scene;
  scene.panel_width = options.width;
  scene.panel_height = options.height;
  scene.transparent = options.transparent;
  double height = 0;
  for (const View& view : views) {
    RenderPanel together;
    together.view = view;
    for (const TriangleSurface& body : bodies) together.surfaces.push_back({body.vertices, body.faces, body.normals});
    fit(together, scene.panel_width, scene.panel_height);
    height = std::max(height, together.height);
    for (const RenderSurface& surface : together.surfaces) {
      RenderPanel& panel = scene.panels.emplace_back(together);
      panel.surfaces = {surface};
    }
  }
  for (RenderPanel& panel : scene.panels) panel.height = height;
  const int panels = int(scene.panels.size());
  scene.columns = options.columns > 0                     ? std::min(options.columns, panels)
                  : bodies.size() > 1 && views.size() > 1 ? int(bodies.size())
                  : panels <= 4                           ? panels
                                                          : int(std::ceil(std::sqrt(panels)));
  return scene;
}

} // namespace cowgpu::figures

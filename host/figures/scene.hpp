// Bodies side by side, all to one scale.
#pragma once

#include "host/mesh/triangle_surface.hpp"
#include "host/render.hpp"

#include <span>

namespace cowgpu::figures {

struct SceneOptions {
  int width = 1600, height = 1200; ///< pixels of a panel
  int columns = 0;                 ///< 0: one row up to four panels, then as many rows as columns
  bool transparent = false;
};

/// One panel for each body and view, all to one scale; bodies of a view keep their places in the panel. The spans of the
/// scene are the bodies'.
RenderScene scene_of(std::span<const TriangleSurface> bodies, std::span<const View> views, const SceneOptions& options);

} // namespace cowgpu::figures

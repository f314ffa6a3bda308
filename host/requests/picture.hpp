// Bodies in a picture, side by side and all to one scale.
#pragma once

#include "host/backend.hpp"
#include "host/figures/scene.hpp"

#include <vector>

namespace cowgpu {

struct PictureRequest {
  std::vector<TriangleSurface> bodies; ///< shaded smoothly where they have normals
  std::vector<View> views = {View{}};  ///< a panel for each body from each
  figures::SceneOptions panels;
};

/// Throws what Backend::render throws.
Image draw_picture(const PictureRequest& request, Backend& backend, Monitor& monitor);

} // namespace cowgpu

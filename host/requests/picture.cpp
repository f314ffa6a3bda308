#include "host/requests/picture.hpp"

namespace cowgpu {

Image draw_picture(const PictureRequest& request, Backend& backend, Monitor& monitor) {
  return backend.render(figures::scene_of(request.bodies, request.views, request.panels), monitor);
}

} // namespace cowgpu

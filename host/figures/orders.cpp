#include "host/figures/figures.hpp"
#include "host/figures/scene.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/report/order_names.hpp"
#include "host/spectrum/expand_surface.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu::figures {
namespace {

constexpr double panel_width = 170, panel_height = 128, caption_height = 30, title_height = 26;
constexpr int pixels = 3; // a point

} // namespace

plot::Canvas orders_figure(const SurfaceExpansion& expansion, SurfaceFields fields, const RawMesh& mesh,
                           const View& view, const std::string& title, Backend& backend, Monitor& monitor) {
  constexpr int last = 7, resolution = 128;
  std::vector<TriangleSurface> bodies;
  for (int order = 0; order <= last; ++order)
    bodies.push_back(
        reconstruct(expansion, fields, order, make_grid(GridKind::clenshaw_curtis, resolution), backend, monitor));
  TriangleSurface& whole = bodies.emplace_back();
  whole.vertices = mesh.vertices;
  whole.faces = mesh.faces;
  whole.normals = vertex_normals(mesh.vertices, mesh.faces);
  const Image image = backend.render(
      scene_of(bodies, std::span(&view, 1), {int(panel_width) * pixels, int(panel_height) * pixels, 3, true}), monitor);

  const double top = title.empty() ? 8 : title_height, row = panel_height + caption_height;
  plot::Canvas canvas(plot::PictureFormat::png, 3 * panel_width, top + 3 * row, pixels);
  canvas.text({1.5 * panel_width, 6}, title,
              {.size = 11, .across = plot::Across::middle, .down = plot::Down::top, .bold = true});
  for (int i = 0; i <= last + 1; ++i) {
    const int x = i % 3, y = i / 3;
    const double left = x * panel_width, upper = top + y * row;
    Image part(int(panel_width) * pixels, int(panel_height) * pixels);
    for (int line = 0; line < part.height; ++line)
      std::copy_n(image.pixel(x * part.width, y * part.height + line), 4 * part.width, part.pixel(0, line));
    canvas.picture(part, {left, upper, panel_width, panel_height});
    const std::string name = i <= last ? order_name(i) : "full body";
    canvas.text({left + panel_width / 2, upper + panel_height + 3}, name,
                {.size = 10, .across = plot::Across::middle, .down = plot::Down::top});
    const std::string degrees = i == 0 ? "$l = 0$" : i <= last ? fmt::format("$l ≤ {}$", i) : "";
    canvas.text({left + panel_width / 2, upper + panel_height + 16}, degrees,
                {.size = 8.5, .colour = plot::grey, .across = plot::Across::middle, .down = plot::Down::top});
  }
  return canvas;
}

} // namespace cowgpu::figures

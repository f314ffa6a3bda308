#include "host/figures/figures.hpp"
#include "host/figures/scene.hpp"
#include "host/flow/level_surface.hpp"
#include "host/mesh/triangle_surface.hpp"

#include <fmt/format.h>

#include <array>

namespace cowgpu::figures {
namespace {

constexpr double panel = 190, gap = 36, margin = 26, foot = 20;
constexpr int pixels = 3;                 // a point
constexpr std::array levels = {0.1, 3.0}; // parts of the diagonal
constexpr int cells = 224;

} // namespace

plot::Canvas inflation_figure(const RawMesh& mesh, const View& view, Backend& backend, Monitor& monitor) {
  Vec3 low = mesh.vertices.at(mesh.faces.at(0)[0]), high = low;
  for (const Face& face : mesh.faces)
    for (const std::uint32_t v : face) {
      low = low.cwiseMin(mesh.vertices[v]);
      high = high.cwiseMax(mesh.vertices[v]);
    }
  const double diagonal = (high - low).norm();
  std::vector<TriangleSurface> bodies(1);
  bodies[0].vertices = mesh.vertices;
  bodies[0].faces = mesh.faces;
  bodies[0].normals = vertex_normals(mesh.vertices, mesh.faces);
  const auto field = backend.distance_field(mesh.vertices, mesh.faces);
  for (const double level : levels)
    bodies.push_back(level_surface(*field, low, high, level * diagonal, cells, monitor));

  plot::Canvas canvas(plot::PictureFormat::png, 3 * panel + 2 * gap, panel + 2 * margin + foot, pixels);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    // Each as large as it can be: they differ by a factor of seven.
    const RenderScene scene = scene_of(std::span(bodies).subspan(i, 1), std::span(&view, 1),
                                       {int(panel) * pixels, int(panel) * pixels, 1, true});
    canvas.picture(backend.render(scene, monitor), {double(i) * (panel + gap), margin, panel, panel});
    const std::string label =
        i == 0 ? std::string("$d = 0$")
               : fmt::format("$d = {:.3g}$, {:g} times the diagonal", levels[i - 1] * diagonal, levels[i - 1]);
    canvas.text({double(i) * (panel + gap) + panel / 2, 2 * margin + panel + foot - 8}, label,
                {.size = 9, .across = plot::Across::middle});
  }
  const plot::Pen pen{plot::black, 1.3, plot::Dash::solid};
  for (const double start : {panel - 34, 2 * panel + gap - 34}) {
    const double end = start + gap + 68, middle = (start + end) / 2;
    canvas.arrow({start, margin + 16}, {end, margin + 16}, pen, 0.16);
    canvas.text({middle, margin - 6}, "$φ(·, Δt)$", {.size = 11, .across = plot::Across::middle});
    canvas.arrow({end, margin + panel - 16}, {start, margin + panel - 16}, pen, 0.16);
    canvas.text({middle, margin + panel + 7}, "$φ(·, −Δt)$",
                {.size = 11, .across = plot::Across::middle, .down = plot::Down::top});
  }
  // The mesh's axes, as this view shows them.
  const plot::Point corner = {22, margin + panel + 10};
  const Eigen::Matrix3d axes = view.axes();
  const char* const names[] = {"$x$", "$y$", "$z$"};
  for (int k = 0; k < 3; ++k) {
    const double dx = axes(0, k), dy = -axes(1, k);
    if (std::hypot(dx, dy) < 0.05) continue;
    canvas.arrow(corner, {corner.x + 18 * dx, corner.y + 18 * dy}, {plot::black, 0.9, plot::Dash::solid});
    canvas.text({corner.x + 24 * dx, corner.y + 24 * dy}, names[k],
                {.size = 8.5, .across = plot::Across::middle, .down = plot::Down::middle});
  }
  return canvas;
}

} // namespace cowgpu::figures

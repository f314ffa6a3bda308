#include "host/figures/figures.hpp"

#include "host/colour_scale.hpp"
#include "host/figures/mollweide.hpp"
#include "host/figures/scene.hpp"
#include "host/map/sample_fields.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/spectrum/surface_fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace cowgpu::figures {
namespace {

constexpr double column = 206, body_height = 140, map_width = 182, map_height = map_width / 2, title_height = 26;
constexpr int pixels = 3; // a point
constexpr int map_degree = 256;

/// The mean over the sphere of values on a grid.
double mean_over_sphere(const SphereGrid& grid, std::span<const double> values) {
  double sum = 0;
  for (int i = 0; i < grid.rings; ++i) {
    double ring = 0;
    for (int j = 0; j < grid.ring_length; ++j) ring += values[std::size_t(i * grid.ring_length + j)];
    sum += grid.weights[std::size_t(i)] * ring / grid.ring_length;
  }
  return sum / 2;
}

/// What `part` of the weight lies below; of values that are all finite.
double quantile(std::vector<std::pair<double, double>> weighted, double part) {
  std::sort(weighted.begin(), weighted.end());
  double whole = 0, sum = 0;
  for (const auto& [value, weight] : weighted) whole += weight;
  for (const auto& [value, weight] : weighted) {
    sum += weight;
    if (sum >= part * whole) return value;
  }
  return weighted.back().first;
}

/// Holds all but half a hundredth at either end of the sphere's area and of the body's vertices.
plot::Range range_of(const SphereGrid& grid, std::span<const double> on_sphere, std::span<const double> on_body) {
  std::vector<std::pair<double, double>> sphere, body;
  for (std::size_t p = 0; p < on_sphere.size(); ++p)
    sphere.emplace_back(on_sphere[p], grid.weights[p / std::size_t(grid.ring_length)]);
  for (const double value : on_body) body.emplace_back(value, 1.0);
  constexpr double left_out = 0.005;
  const double low = std::min(quantile(sphere, left_out), quantile(body, left_out));
  const double high = std::max(quantile(sphere, 1 - left_out), quantile(body, 1 - left_out));
  return {low, high > low ? high : low + 1};
}

Colour reflectance(const plot::Ink& ink) {
  // Less than all light, so that what is lit fully does not turn white.
  const auto channel = [](double c) { return float(0.8 * to_linear(c)); };
  return {channel(ink.r), channel(ink.g), channel(ink.b)};
}

} // namespace

plot::Canvas components_figure(const RawMesh& mesh, const SphereMap& map, const Vec3& origin, const View& view,
                               const std::string& title, Backend& backend, Monitor& monitor, const std::string& unit) {
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, map_degree);
  const SphereSamples samples = backend.sphere_sampler(grid)->sample(map.positions, mesh.faces, monitor);
  std::vector<double> fields =
      surface_fields(sample_positions(samples, mesh.faces, mesh.vertices), grid, origin, false);
  std::array<double, 3> means{};
  std::array<plot::Range, 3> ranges;
  const auto on_sphere = [&](std::size_t f) { return std::span(fields).subspan(f * grid.points(), grid.points()); };
  for (std::size_t f = 0; f < 3; ++f) {
    if (f > 0) means[f] = mean_over_sphere(grid, on_sphere(f));
    for (double& value : on_sphere(f)) value -= means[f];
  }
  std::array<std::vector<double>, 3> on_body;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3& p = map.positions[v];
    const auto values = surface_field_values(mesh.vertices[v], origin, std::atan2(std::hypot(p.x(), p.y()), p.z()),
                                             std::atan2(p.y(), p.x()), false);
    for (std::size_t f = 0; f < 3; ++f) on_body[f].push_back(values[f] - means[f]);
  }
  for (std::size_t f = 0; f < 3; ++f) ranges[f] = range_of(grid, on_sphere(f), on_body[f]);

  std::vector<TriangleSurface> bodies(1);
  bodies[0].vertices = mesh.vertices;
  bodies[0].faces = mesh.faces;
  bodies[0].normals = vertex_normals(mesh.vertices, mesh.faces);
  RenderScene scene = scene_of(bodies, std::span(&view, 1), {int(column) * pixels, int(body_height) * pixels, 3, true});
  std::array<std::vector<Colour>, 3> colours;
  scene.columns = 3;
  scene.panels.resize(3, scene.panels[0]);
  for (std::size_t f = 0; f < 3; ++f)
    for (const double value : on_body[f])
      colours[f].push_back(reflectance(plot::viridis(plot::axis_place(value, ranges[f], plot::Scale::linear))));
  for (std::size_t f = 0; f < 3; ++f) scene.panels[f].surfaces[0].vertex_colours = colours[f];
  const Image image = backend.render(scene, monitor);

  const double top = title.empty() ? 4 : title_height;
  plot::Canvas canvas(plot::PictureFormat::png, 3 * column, top + 20 + body_height + map_height + 62, pixels);
  canvas.text({1.5 * column, 6}, title,
              {.size = 11, .across = plot::Across::middle, .down = plot::Down::top, .bold = true});
  canvas.picture(image, {0, top + 18, 3 * column, body_height});
  const std::string names[] = {"$f_r$", "$f_{Δθ}$", "$|f_{Δφ}|$ less its mean"};
  const std::string labels[] = {"$f_r$ (" + unit + ")", "$f_{Δθ}$ (rad)", "$|f_{Δφ}|$ less its mean (rad)"};
  for (std::size_t f = 0; f < 3; ++f) {
    const double left = column * double(f);
    canvas.text({left + column / 2, top + 4}, names[f],
                {.size = 11, .across = plot::Across::middle, .down = plot::Down::top});
    const plot::Box box = {left + (column - map_width) / 2 + 4, top + 26 + body_height, map_width, map_height};
    draw_mollweide(canvas, box, grid, on_sphere(f), ranges[f]);
    plot::draw_flat_colour_bar(canvas, {box.x + 16, box.bottom() + 8, map_width - 32, 8}, ranges[f], labels[f]);
  }
  return canvas;
}

} // namespace cowgpu::figures

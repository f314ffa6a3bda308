#include "host/colour_scale.hpp"
#include "host/error.hpp"
#include "host/figures/figures.hpp"
#include "host/figures/scene.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/plot/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace cowgpu::figures {
namespace {

constexpr double panel_width = 216, panel_height = 168, title_height = 34, bar_room = 78, margin = 14;
constexpr double caption_size = 8, caption_line = 11.5;
constexpr int pixels = 3; // a point

// From two sides, along the third axis, about which bodies mostly spin, and along the second.
constexpr std::array<View, 4> usual_views = {View{28, 14}, View{208, 14}, View{0, 0}, View{0, 90}};

/// Less than all light, so that what is lit fully does not turn white.
Colour reflectance(double place) {
  const auto srgb = viridis_colour(place);
  const auto channel = [&](std::size_t c) { return float(0.85 * to_linear(srgb[c])); };
  return {channel(0), channel(1), channel(2)};
}

/// The surface with a colour at each vertex; where colours are the faces', these share none.
struct Coloured {
  TriangleSurface surface;
  std::vector<Colour> colours;

  Coloured(const MeshValues& values, const std::vector<double>& numbers, const ColourRange& range) {
    std::vector<Vec3> normals = vertex_normals(values.vertices, values.faces);
    if (values.place == ValuePlace::vertices) {
      surface.vertices = values.vertices;
      surface.faces = values.faces;
      surface.normals = std::move(normals);
      for (const double number : numbers) colours.push_back(reflectance(range.place(number)));
      return;
    }
    for (std::size_t f = 0; f < values.faces.size(); ++f) {
      const auto first = std::uint32_t(surface.vertices.size());
      surface.faces.push_back({first, first + 1, first + 2});
      for (const std::uint32_t v : values.faces[f]) {
        surface.vertices.push_back(values.vertices[v]);
        surface.normals.push_back(normals[v]);
        colours.push_back(reflectance(range.place(numbers[f])));
      }
    }
  }
};

/// The text in lines of at most this width.
std::vector<std::string> lines_of(const plot::Canvas& canvas, const std::string& text, double width) {
  std::vector<std::string> lines;
  std::string line, word;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    if (i < text.size() && text[i] != ' ') {
      word += text[i];
      continue;
    }
    const std::string longer = line.empty() ? word : line + " " + word;
    if (!line.empty() && canvas.measure(longer, {.size = caption_size}).width > width) {
      lines.push_back(line);
      line = word;
    } else
      line = longer;
    word.clear();
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

/// Text in which a dollar sign is one.
std::string plain(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '$' ? "$$" : std::string(1, c);
  return safe;
}

std::string name_of_column(const ValueColumn& column) {
  std::string name = plain(column.name);
  std::replace(name.begin(), name.end(), '_', ' ');
  return (column.components == 3 ? "size of " : "") + name;
}

std::string unit_of(const ValueColumn& column) {
  return column.unit.empty() || column.unit == "1" ? "" : column.unit == "deg" ? "°" : column.unit;
}

std::string caption(const MeshValues& values, const ValueColumn& column, const std::vector<double>& numbers,
                    const ColourRange& range) {
  double least = HUGE_VAL, most = -HUGE_VAL;
  std::size_t beyond = 0;
  for (const double number : numbers) {
    if (!std::isfinite(number)) continue;
    least = std::min(least, number);
    most = std::max(most, number);
    beyond += number < range.low || number > range.high;
  }
  const std::string unit = unit_of(column), gap = unit.empty() || unit == "°" ? "" : " ";
  std::string text = fmt::format("{}: {}. ", name_of_column(column), plain(column.meaning));
  if (least <= most)
    text += fmt::format("From {:.4g} to {:.4g}{}{} over {} {}.", least, most, gap, unit, numbers.size(),
                        name_of(values.place));
  if (beyond > 0) text += fmt::format(" Beyond the ends of the scale, in their colours: {} of them.", beyond);
  return text;
}

/// The mesh's axes, as the view shows them.
void draw_axes(plot::Canvas& canvas, const View& view, const plot::Point& at) {
  const Eigen::Matrix3d axes = view.axes();
  constexpr std::array names = {"$x$", "$y$", "$z$"};
  for (int k = 0; k < 3; ++k) {
    const double dx = axes(0, k), dy = -axes(1, k);
    if (std::hypot(dx, dy) < 0.15) continue;
    canvas.arrow(at, {at.x + 15 * dx, at.y + 15 * dy}, {plot::black, 0.8, plot::Dash::solid});
    canvas.text({at.x + 21 * dx, at.y + 21 * dy}, names[std::size_t(k)],
                {.size = 8, .across = plot::Across::middle, .down = plot::Down::middle});
  }
}

} // namespace

plot::Canvas surface_values_figure(plot::PictureFormat format, const MeshValues& values, const std::string& colour,
                                   std::span<const View> views, Backend& backend, Monitor& monitor) {
  check(values);
  if (values.faces.empty())
    throw Error(
        Fault::bad_argument,
        fmt::format("{}: values at points without faces are no surface to show; take those at faces or vertices",
                    values.title));
  if (views.empty()) views = usual_views;
  const ValueColumn& column = shown_column(values, colour);
  const std::vector<double> numbers = numbers_of(column);
  const ColourRange range = colour_range(numbers);
  const Coloured body(values, numbers, range);

  const int columns = views.size() == 1 ? 1 : 2, rows = (int(views.size()) + columns - 1) / columns;
  const double size = views.size() == 1 ? 1.6 : 1; // a lone body is larger
  const double width = columns * size * panel_width, height = rows * size * panel_height;
  const double whole = width + bar_room + 2 * margin;
  const plot::Canvas ruler(plot::PictureFormat::png, 10, 10, 1);
  const std::vector<std::string> lines = lines_of(ruler, caption(values, column, numbers, range), whole - 2 * margin);
  plot::Canvas canvas(format, whole, title_height + height + 16 + caption_line * double(lines.size()) + margin, pixels);

  RenderScene scene = scene_of(std::span(&body.surface, 1), views,
                               {int(size * panel_width) * pixels, int(size * panel_height) * pixels, columns, true});
  for (RenderPanel& panel : scene.panels) panel.surfaces[0].vertex_colours = body.colours;
  canvas.picture(backend.render(scene, monitor), {margin, title_height, width, height});

  canvas.text({margin, 13}, plain(values.title), {.size = 11.5, .down = plot::Down::top, .bold = true});
  for (std::size_t i = 0; i < views.size(); ++i)
    draw_axes(canvas, views[i],
              {margin + double(int(i) % columns) * size * panel_width + 26,
               title_height + double(int(i) / columns + 1) * size * panel_height - 24});
  const double bar = std::min(0.8 * height, 250.0);
  const plot::Range shown = {range.low,
                             range.high > range.low ? range.high : range.low + std::max(1.0, std::abs(range.low))};
  const std::string unit = unit_of(column);
  plot::draw_colour_bar(canvas, {margin + width + 12, title_height + (height - bar) / 2, 13, bar}, shown,
                        name_of_column(column) + (unit.empty() ? "" : " (" + plain(unit) + ")"));
  double y = title_height + height + 16;
  for (const std::string& line : lines) {
    canvas.text({margin, y}, line, {.size = caption_size, .colour = {0.25, 0.25, 0.25}, .down = plot::Down::top});
    y += caption_line;
  }
  return canvas;
}

} // namespace cowgpu::figures

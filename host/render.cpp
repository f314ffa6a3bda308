#include "host/render.hpp"

#include "host/error.hpp"
#include "host/number.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace cowgpu {
namespace {

struct NamedView {
  std::string_view name;
  View view;
};

// 35.264...: the elevation of a cube's diagonal.
constexpr NamedView named_views[] = {{"side", {0, 0}},
                                     {"front", {90, 0}},
                                     {"back", {270, 0}},
                                     {"left", {180, 0}},
                                     {"top", {0, 90}},
                                     {"bottom", {0, -90}},
                                     {"iso", {45, 35.264389682754654}}};

/// cos and sin of an angle in degrees, exact at multiples of 90.
std::pair<double, double> cos_sin(double degrees) {
  const double turns = std::floor(degrees / 90 + 0.5), rest = (degrees - 90 * turns) * M_PI / 180;
  const double c = std::cos(rest), s = std::sin(rest);
  switch (((long(turns) % 4) + 4) % 4) {
  case 0: return {c, s};
  case 1: return {-s, c};
  case 2: return {-c, -s};
  default: return {s, -c};
  }
}

} // namespace

Eigen::Matrix3d View::axes() const {
  const auto [ca, sa] = cos_sin(azimuth);
  const auto [ce, se] = cos_sin(elevation);
  Eigen::Matrix3d rows;
  rows << ca, 0, -sa, -sa * se, ce, -ca * se, sa * ce, se, ca * ce;
  return rows;
}

std::string view_names() {
  std::string names;
  for (const NamedView& known : named_views) names += fmt::format("{}{}", names.empty() ? "" : ", ", known.name);
  return names;
}

View parse_view(std::string_view text) {
  for (const NamedView& known : named_views)
    if (known.name == text) return known.view;
  if (const auto angles = read_numbers<2>(text)) {
    View view;
    view.azimuth = (*angles)[0];
    view.elevation = (*angles)[1];
    if (std::abs(view.azimuth) <= 360 && std::abs(view.elevation) <= 90) return view;
  }
  throw Error(
      Fault::bad_argument,
      fmt::format("the view '{}' must be one of {}, or azimuth and elevation in degrees, AZ,EL, from -360 to 360 "
                  "and from -90 to 90",
                  text, view_names()));
}

void fit(RenderPanel& panel, int width, int height, double margin) {
  const Eigen::Matrix3d axes = panel.view.axes();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3 low = Vec3::Constant(infinity), high = Vec3::Constant(-infinity);
  for (const RenderSurface& surface : panel.surfaces)
    for (const Face& face : surface.faces)
      for (const std::uint32_t v : face) {
        const Vec3 p = axes * surface.vertices[v];
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
  if (!(low.x() <= high.x())) return;
  panel.centre = axes.transpose() * (low / 2 + high / 2);
  const Vec3 size = high - low;
  const double edge = 2 * margin * std::min(width, height);
  // A body seen edge-on, or of one point, still needs a scale.
  const double units_per_pixel = std::max(size.x() / (width - edge), size.y() / (height - edge));
  panel.height = units_per_pixel > 0 ? units_per_pixel * height : std::max(size.z(), 1.0);
}

void check(const RenderScene& scene) {
  if (scene.panels.empty() || scene.columns < 1 || scene.panel_width < 1 || scene.panel_height < 1 ||
      scene.columns > largest_picture || scene.panel_width > largest_picture / scene.columns ||
      scene.panel_height > largest_picture / scene.rows())
    throw Error(
        Fault::bad_argument,
        fmt::format("{} panels of {} x {} pixels in {} columns: a picture needs at least one and may have {} pixels "
                    "a side",
                    scene.panels.size(), scene.panel_width, scene.panel_height, scene.columns, largest_picture));
  for (const RenderPanel& panel : scene.panels) {
    if (!(panel.height > 0) || !std::isfinite(panel.height) || !panel.centre.allFinite() ||
        !panel.view.axes().allFinite())
      throw Error(Fault::bad_argument, "the view of a panel is not finite");
    std::size_t faces = 0;
    for (const RenderSurface& surface : panel.surfaces) {
      faces += surface.faces.size();
      if (!surface.normals.empty() && surface.normals.size() != surface.vertices.size())
        throw Error(Fault::bad_argument, fmt::format("{} normals for {} vertices; there must be one each",
                                                     surface.normals.size(), surface.vertices.size()));
      if (!surface.vertex_colours.empty() && surface.vertex_colours.size() != surface.vertices.size())
        throw Error(Fault::bad_argument, fmt::format("{} colours for {} vertices; there must be one each",
                                                     surface.vertex_colours.size(), surface.vertices.size()));
      for (std::size_t f = 0; f < surface.faces.size(); ++f)
        for (const std::uint32_t v : surface.faces[f]) {
          if (v >= surface.vertices.size())
            throw Error(Fault::mesh_index_range, fmt::format("face {} names vertex {}, but there are {} vertices", f, v,
                                                             surface.vertices.size()));
          if (!surface.vertices[v].allFinite())
            throw Error(Fault::mesh_not_finite, fmt::format("vertex {} has no finite coordinates", v));
        }
    }
    if (faces == 0) throw Error(Fault::mesh_empty, "there is no face to show");
  }
}

} // namespace cowgpu

#include "host/error.hpp"
#include "host/figures/figures.hpp"
#include "host/plot/plot.hpp"

#include <algorithm>
#include <cmath>

namespace cowgpu::figures {
namespace {

constexpr double width = 530, height = 380;

/// The letter of a unit axis of the mesh: "y"; "u" for others.
std::string axis_name(const Vec3& axis, const char* other) {
  for (int k = 0; k < 3; ++k)
    if (axis == Vec3::Unit(k)) return std::string("$") + char('x' + k) + "$";
  return other;
}

} // namespace

plot::Canvas streamlines_figure(plot::PictureFormat format, const RawMesh& mesh, const Plane& plane, const Vec3& origin,
                                std::size_t lines, Backend& backend, Monitor& monitor, const std::string& unit) {
  const std::vector<CutLoop> cut = cut_by_plane(mesh.vertices, mesh.faces, plane);
  if (cut.empty()) throw Error(Fault::mesh_empty, "the plane of the streamlines misses the body");
  const StreamlineStarts starts = starts_along(cut, lines, mesh.vertices, mesh.faces);
  double size = 0;
  for (const Vec3& v : mesh.vertices) size = std::max(size, (v - origin).norm());
  FlowOptions options;
  options.time = size;
  const auto flow = backend.distance_flow(mesh.vertices, mesh.faces);
  const Streamlines found = streamlines(mesh.vertices, mesh.faces, starts, origin, options, *flow, backend, monitor);

  // Up is the plane's v, or u where that is y: bodies stand along y.
  const bool swapped = plane.u() == Vec3::UnitY();
  const PlanePoint centre = in_plane(plane, origin);
  const auto across = [&](const PlanePoint& p) { return swapped ? p.v : p.u; };
  const auto up = [&](const PlanePoint& p) { return swapped ? p.u : p.v; };

  plot::Plot plot;
  plot.equal_scale = true;
  plot.grid = false;
  plot.legend = plot::LegendPlace::outside;
  plot.x = {axis_name(swapped ? plane.v() : plane.u(), "$u$"), unit};
  plot.y = {axis_name(swapped ? plane.u() : plane.v(), "$v$"), unit};
  plot::Series paths{"streamlines", {}, {}};
  paths.colour = plot::Ink{0.62, 0.62, 0.62};
  paths.width = 0.6;
  plot::Series body{"points on the body", {}, {}, plot::blue}, circle{"points on the circle", {}, {}, plot::orange};
  const auto& points = found.lines;
  const auto from_centre = [&](const Vec3& x) {
    const PlanePoint p = in_plane(plane, x);
    return PlanePoint{p.u - centre.u, p.v - centre.v};
  };
  double radius = 0;
  for (const Vec3& x : points.path) radius = std::max(radius, std::hypot(from_centre(x).u, from_centre(x).v));
  radius *= 1.04;
  const auto add = [&](plot::Series& series, const PlanePoint& p) {
    series.x.push_back(across(p));
    series.y.push_back(up(p));
  };
  for (std::size_t i = 0; i + 1 < points.first.size(); ++i) {
    for (std::size_t k = points.first[i]; k < points.first[i + 1]; ++k) add(paths, in_plane(plane, points.path[k]));
    const PlanePoint end = in_plane(plane, found.directions[i]);
    const double length = std::hypot(end.u, end.v);
    if (length > 0) {
      // On from the end as it is seen from the origin.
      const PlanePoint there = {centre.u + radius * end.u / length, centre.v + radius * end.v / length};
      add(paths, there);
      add(circle, there);
    }
    add(paths, {NAN, NAN});
  }
  for (const Vec3& place : starts.places) add(body, in_plane(plane, place));
  for (plot::Series* series : {&body, &circle}) {
    series->line = false;
    series->marker = plot::Marker::disc;
    series->marker_size = 3.2;
  }
  plot::Series rim{"", {}, {}, plot::orange.faded(0.5)};
  rim.width = 0.7;
  for (int i = 0; i <= 360; ++i)
    add(rim, {centre.u + radius * std::cos(i * M_PI / 180), centre.v + radius * std::sin(i * M_PI / 180)});
  plot.series = {paths, rim, body, circle};
  plot::Canvas canvas(format, width, height);
  plot::draw(plot, canvas, {8, 6, width - 16, height - 12});
  return canvas;
}

} // namespace cowgpu::figures

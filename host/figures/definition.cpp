#include "host/error.hpp"
#include "host/figures/figures.hpp"
#include "host/plot/label_places.hpp"

#include <algorithm>
#include <cmath>

namespace cowgpu::figures {
namespace {

constexpr double page = 340, radius = 130; // points; of the circle
constexpr double degree = M_PI / 180;

struct Shown {
  double phi = 0, image = 0; ///< azimuths, the image's within 180 degrees of phi
  double distance = 0;       ///< distance of the image from the origin
};

/// The vertex that shows best what f is: about 35 degrees from where it comes from, far out, near the plane.
Shown choose(const RawMesh& mesh, const SphereMap& map, const Vec3& origin, double size) {
  Shown best;
  double highest = -INFINITY;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3 x = mesh.vertices[v] - origin;
    const Vec3& p = map.positions[v];
    if (std::abs(x.z()) > 0.03 * size || std::abs(p.z()) > 0.15 || p.norm() < 0.5) continue;
    const double phi = std::atan2(p.y(), p.x()), off = std::remainder(std::atan2(x.y(), x.x()) - phi, 2 * M_PI);
    const double r = std::hypot(x.x(), x.y());
    const double score = r / size - 1.5 * std::abs(std::abs(off) / degree - 35) / 35 - std::abs(p.z());
    if (score > highest) highest = score, best = {phi, phi + off, r};
  }
  if (highest == -INFINITY)
    throw Error(Fault::map_failed,
                "no vertex near the plane of the figure comes from near the equator of the sphere; take another "
                "--of, or a mesh with more vertices");
  return best;
}

} // namespace

plot::Canvas definition_figure(plot::PictureFormat format, const RawMesh& mesh, const SphereMap& map,
                               const Vec3& origin) {
  Plane plane;
  plane.normal = Vec3::UnitZ();
  plane.offset = origin.z();
  double size = 0;
  const auto lines = section(mesh, plane);
  for (const auto& line : lines)
    for (const PlanePoint& p : line) size = std::max(size, std::hypot(p.u - origin.x(), p.v - origin.y()));
  if (!(size > 0)) throw Error(Fault::mesh_empty, "the plane z = const through the origin misses the body");
  const Shown shown = choose(mesh, map, origin, size);

  plot::Canvas canvas(format, page, page);
  const plot::Point middle = {page / 2, page / 2};
  const double scale = 0.86 * radius / size;
  const auto place = [&](double u, double v) {
    return plot::Point{middle.x + scale * (u - origin.x()), middle.y - scale * (v - origin.y())};
  };
  const auto polar = [&](double r, double phi) {
    return plot::Point{middle.x + r * std::cos(phi), middle.y - r * std::sin(phi)};
  };
  std::vector<std::vector<plot::Point>> rings;
  for (const auto& line : lines) {
    std::vector<plot::Point>& ring = rings.emplace_back();
    for (const PlanePoint& p : line) ring.push_back(place(p.u, p.v));
  }
  const std::vector<std::span<const plot::Point>> spans(rings.begin(), rings.end());
  canvas.fill(spans, plot::orange.faded(0.22));
  for (const auto& ring : rings) canvas.line(ring, {plot::vermilion, 1.4, plot::Dash::solid}, true);
  canvas.circle(middle, radius, {plot::blue, 1.4, plot::Dash::solid});

  // Axes of the plane.
  const plot::Pen thin{plot::grey, 0.8, plot::Dash::solid};
  canvas.arrow({middle.x - radius - 14, middle.y}, {middle.x + radius + 22, middle.y}, thin);
  canvas.arrow({middle.x, middle.y + radius + 14}, {middle.x, middle.y - radius - 22}, thin);
  canvas.text({middle.x + radius + 25, middle.y}, "$x$", {.down = plot::Down::middle});
  canvas.text({middle.x, middle.y - radius - 25}, "$y$", {.across = plot::Across::middle, .down = plot::Down::bottom});

  const plot::Point from = polar(radius, shown.phi), to = polar(scale * shown.distance, shown.image);
  canvas.line(std::vector<plot::Point>{middle, from}, {plot::black, 0.9, plot::Dash::dashed});
  // The image's direction on to where the arc of the angle ends.
  const double arc = 0.72 * radius;
  if (scale * shown.distance < arc)
    canvas.line(std::vector<plot::Point>{to, polar(arc, shown.image)}, {plot::black, 0.7, plot::Dash::dotted});
  canvas.arrow(middle, to, {plot::green, 1.8, plot::Dash::solid});

  // The azimuth's change, an arrow along an arc: its head by hand.
  const double turn = shown.image - shown.phi;
  canvas.arc(middle, arc, shown.phi / degree, (shown.image - std::copysign(4 / arc, turn)) / degree,
             {plot::purple, 1.6, plot::Dash::solid});
  const double side = turn > 0 ? 1 : -1;
  const plot::Point tip = polar(arc, shown.image), back = polar(arc, shown.image - side * 8 / arc);
  canvas.arrow(back, tip, {plot::purple, 1.6, plot::Dash::solid});
  canvas.disc(middle, 2.4, plot::black);
  canvas.disc(from, 3.6, plot::blue);
  canvas.disc(to, 3.6, plot::vermilion);

  // Names where there is room: beside what they name.
  plot::LabelPlaces places({0, 0, page, page});
  for (const auto& ring : rings)
    for (std::size_t i = 0; i < ring.size(); ++i) places.add_line(ring[i], ring[(i + 1) % ring.size()]);
  places.add_line(middle, from);
  places.add_line(middle, polar(std::max(arc, scale * shown.distance), shown.image));
  places.add_line({middle.x - radius, middle.y}, {middle.x + radius, middle.y});
  places.add_line({middle.x, middle.y - radius}, {middle.x, middle.y + radius});
  for (int i = 0; i <= 200; ++i) {
    places.add_point(polar(radius, 2 * M_PI * i / 200));
    places.add_point(polar(arc, shown.phi + turn * i / 200));
  }
  const auto name = [&](const plot::Point& at, double off, const char* text, const plot::Ink& ink) {
    const plot::TextStyle style{.size = 12, .colour = ink, .halo = plot::white.faded(0.85)};
    const plot::TextSize size_of = canvas.measure(text, style);
    std::vector<plot::Box> candidates;
    for (const double away : {off, off + 6, off + 12, off + 20})
      for (int i = 0; i < 16; ++i) {
        const double x = std::cos(i * M_PI / 8), y = std::sin(i * M_PI / 8);
        const double w = size_of.width, h = size_of.height();
        candidates.push_back({at.x + x * (away + w / 2) - w / 2, at.y - y * (away + h / 2) - h / 2, w, h});
      }
    const plot::Box best = places.best(candidates);
    places.add_box(best);
    canvas.text({best.x, best.y + size_of.ascent}, text, style);
  };
  name(from, 6, "$(θ, φ)$", plot::blue);
  name(to, 6, "$F(θ, φ)$", plot::vermilion);
  name(polar(arc, shown.phi + 0.5 * turn), 2, "$f_{Δφ}$", {0.6, 0.25, 0.45});
  name(polar(0.5 * scale * shown.distance, shown.image), 2, "$f_r$", {0, 0.45, 0.33});
  canvas.text({12, page - 26}, "$S^2$", {.size = 11, .colour = plot::blue});
  canvas.text({12, page - 10}, "$∂C$", {.size = 11, .colour = plot::vermilion});
  return canvas;
}

} // namespace cowgpu::figures

#include "host/figures/figures.hpp"

#include "host/mesh/triangle_surface.hpp"

#include <algorithm>
#include <cmath>

namespace cowgpu::figures {
namespace {

constexpr double panel = 250, title_height = 24, foot = 14;
constexpr int pixels = 3; // a point

// Seen from +x: -z points to the right of the page.
class Panel {
public:
  Panel(const TippedBody& shown, double left) : shown_(shown), left_(left) {
    low_ = high_ = shown.stance->body.vertices.front();
    for (const Vec3& v : shown.stance->body.vertices) {
      low_ = low_.cwiseMin(v);
      high_ = high_.cwiseMax(v);
    }
    centre_ = (low_ + high_) / 2;
    height_ = 1.42 * std::max(high_.y() - low_.y(), high_.z() - low_.z());
  }

  RenderPanel scene(std::span<const Vec3> normals) const {
    RenderPanel scene;
    RenderSurface surface;
    surface.vertices = shown_.stance->body.vertices;
    surface.faces = shown_.stance->body.faces;
    surface.normals = normals;
    scene.surfaces.push_back(surface);
    scene.view = parse_view("front");
    scene.centre = centre_;
    scene.height = height_;
    return scene;
  }

  void draw(plot::Canvas& canvas, const Image& image) const {
    canvas.picture(image, {left_, title_height, panel, panel});
    canvas.text({left_ + panel / 2, 6}, shown_.title,
                {.size = 11, .across = plot::Across::middle, .down = plot::Down::top, .bold = true});
    const physics::Tipping& t = *shown_.tipping;
    const double ground = place(Vec3(0, shown_.stance->contact.ground, 0)).y;
    canvas.line(std::vector<plot::Point>{{left_ + 16, ground}, {left_ + panel - 16, ground}}, {plot::black, 1.4});
    const plot::Point p = place(t.pivot), b = place(shown_.stance->body.centre), top = place(t.point);
    canvas.line(std::vector<plot::Point>{p, top}, {plot::black, 1, plot::Dash::dashed});
    const double arrow = 0.24 * panel;
    const plot::Point push = {top.x - arrow * t.direction.z(), top.y - arrow * t.direction.y()};
    canvas.arrow(top, push, {plot::vermilion, 2.2});
    canvas.arrow(p, {p.x, p.y - arrow}, {plot::blue, 2.2});
    for (const auto& [at, ink] : {std::pair(p, plot::blue), std::pair(b, plot::black), std::pair(top, plot::vermilion)})
      canvas.disc(at, 3.2, ink);
    const auto name = [&](const plot::Point& at, double dx, double dy, const char* text, const plot::Ink& ink) {
      const plot::TextStyle style{.size = 12,
                                  .colour = ink,
                                  .across = dx < 0 ? plot::Across::right : plot::Across::left,
                                  .down = plot::Down::middle,
                                  .halo = plot::white.faded(0.9)};
      canvas.text({at.x + dx, at.y + dy}, text, style);
    };
    // The pivot is to the left of b or below it, the push to the right of the ray or above.
    name(p, -8, 10, "$p$", plot::blue);
    name({p.x, p.y - arrow}, -6, 2, "$F_N$", plot::blue);
    name(b, 9, 6, "$b$", plot::black);
    name(top, 9, 2, "$p_T$", plot::vermilion);
    name({push.x, std::max(push.y, title_height + 20)}, 0, -12, "$F_T$", plot::vermilion);
    name({0.7 * b.x + 0.3 * top.x, 0.7 * b.y + 0.3 * top.y}, 9, 0, "$q$", plot::black);
  }

private:
  plot::Point place(const Vec3& x) const {
    const double scale = panel / height_;
    return {left_ + panel / 2 - scale * (x.z() - centre_.z()),
            title_height + panel / 2 - scale * (x.y() - centre_.y())};
  }

  const TippedBody& shown_;
  double left_, height_ = 1;
  Vec3 low_, high_, centre_;
};

} // namespace

plot::Canvas tipping_figure(std::span<const TippedBody> bodies, Backend& backend, Monitor& monitor) {
  plot::Canvas canvas(plot::PictureFormat::png, double(bodies.size()) * panel, title_height + panel + foot, pixels);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const physics::RigidBody& body = bodies[i].stance->body;
    const std::vector<Vec3> normals = vertex_normals(body.vertices, body.faces);
    const Panel shown(bodies[i], double(i) * panel);
    RenderScene scene;
    scene.panel_width = scene.panel_height = int(panel) * pixels;
    scene.panels.push_back(shown.scene(normals));
    shown.draw(canvas, backend.render(scene, monitor));
  }
  return canvas;
}

} // namespace cowgpu::figures

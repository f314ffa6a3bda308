#include "tests/support/compare_renders.hpp"

#include "host/plan/render.hpp"
#include "host/reference/render.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>

namespace cowgpu::test {

Image reference_picture(const RenderScene& scene) {
  Image image = plan::blank_picture(scene);
  for (std::size_t p = 0; p < scene.panels.size(); ++p) {
    const plan::RenderedPanel panel(scene.panels[p], scene);
    for (plan::RenderTile& tile : plan::render_tiles(panel, scene, 0, plan::render_tile_count(scene))) {
      while (!tile.rays().empty()) {
        std::vector<RayHit> hits;
        for (const Ray& ray : tile.rays()) {
          const auto hit =
              reference::first_hit<long double>(panel.vertices(), panel.faces(), ray.origin, ray.direction, ray.limit);
          hits.push_back({hit.face, double(hit.t), double(hit.u), double(hit.v)});
        }
        tile.take(hits);
      }
      tile.put(image, int(p) % scene.columns * scene.panel_width, int(p) / scene.columns * scene.panel_height, scene);
    }
  }
  return image;
}

void compare_renders(Paths& paths, const RenderScene& scene, int levels) {
  const Image truth = reference_picture(scene);
  Image first;
  paths.each([&](Backend& backend) {
    INFO(backend.facts().type << ": " << scene.width() << " x " << scene.height());
    Monitor silent;
    const Image image = backend.render(scene, silent);
    REQUIRE(image.rgba.size() == truth.rgba.size());
    CHECK(image.opaque == truth.opaque);
    int worst = 0;
    for (std::size_t i = 0; i < image.rgba.size(); ++i)
      worst = std::max(worst, std::abs(int(image.rgba[i]) - int(truth.rgba[i])));
    CHECK(worst <= levels);
    if (first.rgba.empty()) first = image;
    CHECK(image.rgba == first.rgba);
  });
}

} // namespace cowgpu::test

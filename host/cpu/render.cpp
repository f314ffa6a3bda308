#include "host/cpu/render.hpp"

#include "host/parallel.hpp"
#include "host/plan/render.hpp"

#include <atomic>
#include <vector>

namespace cowgpu::cpu {

Image render(const RenderScene& scene, unsigned threads, Monitor& monitor) {
  check(scene);
  Image image = plan::blank_picture(scene);
  const std::size_t tiles = plan::render_tile_count(scene);
  for (std::size_t p = 0; p < scene.panels.size(); ++p) {
    const plan::RenderedPanel panel(scene.panels[p], scene);
    check_stop(monitor);
    const int left = int(p) % scene.columns * scene.panel_width, top = int(p) / scene.columns * scene.panel_height;
    std::atomic<std::size_t> done{0};
    parallel_for(threads, tiles, [&](std::size_t task, unsigned thread) {
      check_stop(monitor);
      plan::RenderTile tile = plan::render_tiles(panel, scene, task, 1)[0];
      for (std::vector<RayHit> hits; !tile.rays().empty();) {
        hits.resize(tile.rays().size());
        for (std::size_t i = 0; i < hits.size(); ++i)
          if (!panel.tree().first_hit(tile.rays()[i], hits[i])) hits[i].face = plan::no_face_hit;
        tile.take(hits);
      }
      tile.put(image, left, top, scene);
      ++done;
      if (thread == 0)
        monitor.progress("render", (double(p) + double(done) / double(tiles)) / double(scene.panels.size()));
    });
  }
  return image;
}

} // namespace cowgpu::cpu

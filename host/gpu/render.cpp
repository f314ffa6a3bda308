#include "host/gpu/render.hpp"

#include "engine/kernels/render.hpp"
#include "host/parallel.hpp"
#include "host/plan/render.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

namespace cowgpu::gpu {
namespace {

constexpr std::size_t tiles_at_once = 8;

static_assert(sizeof(Bvh::Node) == 64 && offsetof(Bvh::Node, high) == 24 && offsetof(Bvh::Node, first) == 48 &&
              offsetof(Bvh::Node, count) == 52);
static_assert(sizeof(Ray) == sizeof(engine::RenderRay) && offsetof(Ray, direction) == 24 && offsetof(Ray, limit) == 48);
static_assert(engine::render_nothing == plan::no_face_hit);

/// As shaders/render.h has them.
struct Triangle {
  double a[3], ab[3], ac[3];
  std::uint32_t face, unused;
};
static_assert(sizeof(Triangle) == 80);

std::vector<Triangle> triangles_of(const plan::RenderedPanel& panel) {
  std::vector<Triangle> triangles;
  triangles.reserve(panel.faces().size());
  for (const std::uint32_t f : panel.tree().faces()) {
    const Face& face = panel.faces()[f];
    const Vec3& a = panel.vertices()[face[0]];
    const Vec3 ab = panel.vertices()[face[1]] - a, ac = panel.vertices()[face[2]] - a;
    triangles.push_back({{a.x(), a.y(), a.z()}, {ab.x(), ab.y(), ab.z()}, {ac.x(), ac.y(), ac.z()}, f, 0});
  }
  return triangles;
}

/// The rays of all tiles' steps, in batches of the device's.
class Casting {
public:
  Casting(engine::Device& device, std::uint32_t iteration_budget, const plan::RenderedPanel& panel)
      : panel_(panel), triangles_(triangles_of(panel)),
        render_(device, {std::as_bytes(panel.tree().nodes()), std::as_bytes(std::span(triangles_)), iteration_budget}) {
    triangles_ = {};
  }

  /// The next step of all of them; false at the end.
  bool step(std::span<plan::RenderTile> tiles, Monitor& monitor) {
    std::vector<std::vector<RayHit>> hits(tiles.size());
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      hits[i].resize(tiles[i].rays().size());
      for (std::size_t first = 0; first < hits[i].size();) {
        const std::size_t room = engine::Render::most_rays - count_;
        const std::size_t number = std::min(room, hits[i].size() - first);
        const std::span<const Ray> rays = tiles[i].rays().subspan(first, number);
        std::memcpy(static_cast<void*>(render_.rays().data() + count_), rays.data(), rays.size_bytes());
        parts_.push_back({rays, std::span(hits[i]).subspan(first, number)});
        count_ += number;
        first += number;
        if (count_ == engine::Render::most_rays) cast(monitor);
      }
    }
    cast(monitor);
    parallel_for(0, tiles.size(), [&](std::size_t i, unsigned) {
      if (!hits[i].empty()) tiles[i].take(hits[i]);
    });
    return std::any_of(tiles.begin(), tiles.end(), [](const plan::RenderTile& tile) { return !tile.rays().empty(); });
  }

private:
  struct Part {
    std::span<const Ray> rays;
    std::span<RayHit> hits;
  };

  void cast(Monitor& monitor) {
    if (count_ == 0) return;
    check_stop(monitor);
    const engine::RenderHit* from = render_.cast(std::uint32_t(count_)).data();
    for (const Part& part : parts_)
      for (std::size_t i = 0; i < part.hits.size(); ++i, ++from) {
        RayHit& hit = part.hits[i];
        hit = {from->face, from->t, from->u, from->v};
        if (from->face == engine::render_left && !panel_.tree().first_hit(part.rays[i], hit))
          hit.face = plan::no_face_hit;
      }
    parts_.clear();
    count_ = 0;
  }

  const plan::RenderedPanel& panel_;
  std::vector<Triangle> triangles_; ///< until the device has them
  engine::Render render_;
  std::vector<Part> parts_; ///< parts of the batch
  std::size_t count_ = 0;
};

} // namespace

Image render(engine::Gpu& gpu, std::uint32_t iteration_budget, const RenderScene& scene, Monitor& monitor) {
  check(scene);
  Image image = plan::blank_picture(scene);
  const std::size_t tiles = plan::render_tile_count(scene);
  for (std::size_t p = 0; p < scene.panels.size(); ++p) {
    const plan::RenderedPanel panel(scene.panels[p], scene);
    check_stop(monitor);
    Casting casting(gpu.device(), iteration_budget, panel);
    const int left = int(p) % scene.columns * scene.panel_width, top = int(p) / scene.columns * scene.panel_height;
    for (std::size_t first = 0; first < tiles; first += tiles_at_once) {
      std::vector<plan::RenderTile> some = plan::render_tiles(panel, scene, first, tiles_at_once);
      while (casting.step(some, monitor)) {
      }
      for (const plan::RenderTile& tile : some) tile.put(image, left, top, scene);
      monitor.progress("render",
                       (double(p) + double(first + some.size()) / double(tiles)) / double(scene.panels.size()));
    }
  }
  return image;
}

} // namespace cowgpu::gpu

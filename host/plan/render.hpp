// What the paths of the stage `render` share: everything but the casting of rays.
//
// A picture is made in tiles. In each, rays through the pixels' middles; from what they hit, rays in 16 directions out of
// 256 for the light that surroundings take away, averaged over neighbours of the same surface so that all 256 count (Keller
// and Heidrich, Interleaved sampling, Rendering Techniques 2001); 16 rays through each pixel that an edge crosses. A tile
// hands out the rays of one step after the other and takes what they hit, so that a path may cast the rays of many tiles
// together. The same hits give the same pixels.
#pragma once

#include "host/geometry/bvh.hpp"
#include "host/image.hpp"
#include "host/render.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// RayHit::face of a ray that hits nothing.
inline constexpr std::uint32_t no_face_hit = 0xffffffffU;

/// What a ray meets: the picture's coordinates, in pixels, z towards the eye.
struct RenderSample {
  std::uint32_t face = no_face_hit;
  Colour colour{}; ///< reflectance
  double z = 0;
  Vec3 normal, flat; ///< for shading; of the triangle: both towards the eye
  double light = 1;  ///< part of the surrounding light that arrives
};

/// Light towards the eye, linear, times the part of a pixel that it covers.
struct Radiance {
  double r = 0, g = 0, b = 0, coverage = 0;
};

/// A panel in the picture's coordinates: x to the right and y down from its upper left corner, in pixels, z towards the
/// eye. (Mirrored, so cross products look inwards; normals are turned towards the eye anyway.)
class RenderedPanel {
public:
  /// The scene must have passed check(), and outlive this.
  RenderedPanel(const RenderPanel& panel, const RenderScene& scene);

  const Bvh& tree() const { return tree_; }
  /// What the tree was built over.
  std::span<const Vec3> vertices() const { return vertices_; }
  std::span<const Face> faces() const { return faces_; }

  Ray towards(double x, double y) const { return {{x, y, front_}, {0, 0, -1}}; }
  RenderSample sample(const RayHit& hit) const;
  /// Rays for the surrounding light at a sample that hit something, by one of the 16 patterns; their number.
  int add_light_rays(const RenderSample& sample, double x, double y, int pattern, std::vector<Ray>& rays) const;
  /// Part of the light that arrives, from what those rays hit.
  double light(std::span<const RayHit> hits) const;
  Radiance shade(const RenderSample& sample) const;

private:
  Bvh transform();
  std::size_t surface_of(std::uint32_t face) const;

  const RenderPanel& panel_;
  const RenderScene& scene_;
  std::vector<Vec3> vertices_;
  std::vector<Face> faces_;
  std::vector<Vec3> normals_, flat_;
  std::vector<std::uint32_t> first_face_;   ///< number of each surface's first face
  std::vector<std::uint32_t> first_vertex_; ///< number of each surface's first vertex
  double front_ = 0, reach_ = 1;
  Bvh tree_;
  std::vector<Vec3> directions_;
};

/// A square of pixels of a panel, with a rim that it shares with its neighbours.
class RenderTile {
public:
  static constexpr int size = 64; ///< pixels a side
  /// From the panel's pixel (x, y) on; `width` and `height` are what the panel has of it.
  RenderTile(const RenderedPanel& panel, int x, int y, int width, int height);

  /// The rays of this step; empty at the end.
  std::span<const Ray> rays() const { return rays_; }
  /// What they hit, in their order; goes to the next step that has rays.
  void take(std::span<const RayHit> hits);

  /// Writes the pixels, with the panel's upper left corner at (left, top). After the last step.
  void put(Image& image, int left, int top, const RenderScene& scene) const;

private:
  enum class Step { middles, lights, edges, edge_lights, done };
  struct EdgeSample {
    int x, y; ///< pixel
    RenderSample sample;
    int rays; ///< rays of ambient light; 0: known
  };

  void take_middles(std::span<const RayHit> hits);
  void take_lights(std::span<const RayHit> hits);
  void take_edges(std::span<const RayHit> hits);
  void take_edge_lights(std::span<const RayHit> hits);
  const RenderSample& at(int x, int y) const;
  bool on_edge(int x, int y) const;
  /// The mean of the light at the neighbours of a sample at (fx, fy) from the middle of a pixel; false where too few are on
  /// its surface.
  bool smoothed(const RenderSample& sample, int x, int y, double fx, double fy, double& light) const;

  const RenderedPanel& panel_;
  int x0_, y0_, width_, height_;
  Step step_ = Step::middles;
  std::vector<Ray> rays_;
  std::vector<RenderSample> cells_; ///< the pixels' middles, rim included
  std::vector<int> light_rays_;     ///< rays of ambient light at each of the pixels' middles
  std::vector<EdgeSample> edges_;   ///< in the order of pixels
  std::vector<std::uint32_t> edge_pixels_;
  std::vector<Radiance> radiance_;
};

/// The tiles of a panel, row by row.
std::vector<RenderTile> render_tiles(const RenderedPanel& panel, const RenderScene& scene, std::size_t first,
                                     std::size_t count);
std::size_t render_tile_count(const RenderScene& scene);

/// A picture without surfaces.
Image blank_picture(const RenderScene& scene);

} // namespace cowgpu::plan

#include "host/plan/render.hpp"

#include "host/plan/sobol.hpp"

#include <algorithm>
#include <cmath>

namespace cowgpu::plan {
namespace {

constexpr int apron = 2, side = RenderTile::size + 2 * apron; // pixels
constexpr int samples = 16;                                   // samples of a pixel on an edge

int pattern_of(int x, int y) {
  return (x & 3) + 4 * (y & 3);
}

void add(Radiance& sum, const Radiance& c, double weight) {
  sum.r += weight * c.r;
  sum.g += weight * c.g;
  sum.b += weight * c.b;
  sum.coverage += weight * c.coverage;
}

std::uint8_t to_srgb(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  const double s = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
  return std::uint8_t(255 * s + 0.5);
}

void put_pixel(std::uint8_t* pixel, const Radiance& c, const RenderScene& scene) {
  if (scene.transparent) {
    const double scale = c.coverage > 0 ? 1 / c.coverage : 0;
    pixel[0] = to_srgb(scale * c.r);
    pixel[1] = to_srgb(scale * c.g);
    pixel[2] = to_srgb(scale * c.b);
    pixel[3] = std::uint8_t(255 * std::min(c.coverage, 1.0) + 0.5);
    return;
  }
  const double rest = 1 - c.coverage;
  pixel[0] = to_srgb(c.r + rest * double(scene.background[0]));
  pixel[1] = to_srgb(c.g + rest * double(scene.background[1]));
  pixel[2] = to_srgb(c.b + rest * double(scene.background[2]));
  pixel[3] = 255;
}

/// Whether b, (dx, dy) pixels from a, belongs to a surface that passes a smoothly.
bool neighbours(const RenderSample& a, const RenderSample& b, double dx, double dy) {
  if (a.normal.dot(b.normal) < 0.93) return false;
  const double expected = std::max(std::abs(a.flat.x() * dx + a.flat.y() * dy) / std::max(a.flat.z(), 0.02),
                                   std::abs(b.flat.x() * dx + b.flat.y() * dy) / std::max(b.flat.z(), 0.02));
  return std::abs(a.z - b.z) <= 2 * expected + 1;
}

} // namespace

RenderTile::RenderTile(const RenderedPanel& panel, int x, int y, int width, int height)
    : panel_(panel), x0_(x), y0_(y), width_(width), height_(height) {
  rays_.reserve(std::size_t(side * side));
  for (int cy = 0; cy < side; ++cy)
    for (int cx = 0; cx < side; ++cx) rays_.push_back(panel_.towards(x0_ + cx - apron + 0.5, y0_ + cy - apron + 0.5));
}

void RenderTile::take(std::span<const RayHit> hits) {
  do {
    rays_.clear();
    switch (step_) {
    case Step::middles: take_middles(hits); break;
    case Step::lights: take_lights(hits); break;
    case Step::edges: take_edges(hits); break;
    case Step::edge_lights: take_edge_lights(hits); break;
    case Step::done: return;
    }
    step_ = Step(int(step_) + 1);
    hits = {};
  } while (rays_.empty() && step_ != Step::done);
}

void RenderTile::take_middles(std::span<const RayHit> hits) {
  cells_.resize(hits.size());
  light_rays_.assign(hits.size(), 0);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    cells_[i] = panel_.sample(hits[i]);
    if (cells_[i].face == no_face_hit) continue;
    const int x = x0_ + int(i) % side, y = y0_ + int(i) / side;
    light_rays_[i] = panel_.add_light_rays(cells_[i], x - apron + 0.5, y - apron + 0.5, pattern_of(x, y), rays_);
  }
}

void RenderTile::take_lights(std::span<const RayHit> hits) {
  std::size_t first = 0;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (cells_[i].face == no_face_hit) continue;
    cells_[i].light = panel_.light(hits.subspan(first, std::size_t(light_rays_[i])));
    first += std::size_t(light_rays_[i]);
  }
  light_rays_ = {};
  radiance_.assign(std::size_t(width_ * height_), {});
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      if (on_edge(x, y)) {
        edge_pixels_.push_back(std::uint32_t(y * width_ + x));
        for (std::uint32_t i = 0; i < samples; ++i) {
          const SobolPoint p = sobol(i);
          rays_.push_back(panel_.towards(x0_ + x + p.x, y0_ + y + p.y));
        }
        continue;
      }
      RenderSample sample = at(x, y);
      if (sample.face == no_face_hit) continue;
      double light = sample.light;
      // Where too few neighbours are on the surface, what its own rays brought.
      if (smoothed(sample, x, y, 0, 0, light)) sample.light = light;
      add(radiance_[std::size_t(y * width_ + x)], panel_.shade(sample), 1);
    }
}

void RenderTile::take_edges(std::span<const RayHit> hits) {
  for (std::size_t i = 0; i < hits.size(); ++i) {
    EdgeSample edge{int(edge_pixels_[i / samples]) % width_, int(edge_pixels_[i / samples]) / width_,
                    panel_.sample(hits[i]), 0};
    if (edge.sample.face == no_face_hit) continue;
    const SobolPoint p = sobol(std::uint32_t(i % samples));
    const int x = edge.x, y = edge.y;
    if (!smoothed(edge.sample, x, y, p.x - 0.5, p.y - 0.5, edge.sample.light))
      edge.rays = panel_.add_light_rays(edge.sample, x0_ + x + 0.5 + (p.x - 0.5), y0_ + y + 0.5 + (p.y - 0.5),
                                        pattern_of(x0_ + x, y0_ + y), rays_);
    edges_.push_back(edge);
  }
}

void RenderTile::take_edge_lights(std::span<const RayHit> hits) {
  std::size_t first = 0;
  for (EdgeSample& edge : edges_) {
    if (edge.rays > 0) edge.sample.light = panel_.light(hits.subspan(first, std::size_t(edge.rays)));
    first += std::size_t(edge.rays);
    add(radiance_[std::size_t(edge.y * width_ + edge.x)], panel_.shade(edge.sample), 1.0 / samples);
  }
  edges_ = {};
  cells_ = {};
}

const RenderSample& RenderTile::at(int x, int y) const {
  return cells_[std::size_t((y + apron) * side + x + apron)];
}

bool RenderTile::on_edge(int x, int y) const {
  const RenderSample& here = at(x, y);
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const RenderSample& there = at(x + dx, y + dy);
      if ((here.face == no_face_hit) != (there.face == no_face_hit)) return true;
      if (here.face != no_face_hit && !neighbours(here, there, dx, dy)) return true;
    }
  return false;
}

bool RenderTile::smoothed(const RenderSample& sample, int x, int y, double fx, double fy, double& light) const {
  // Weights 1/2 1 1 1 1/2 count each of the 4 x 4 patterns once.
  double sum = 0, weights = 0;
  for (int dy = -apron; dy <= apron; ++dy)
    for (int dx = -apron; dx <= apron; ++dx) {
      const RenderSample& there = at(x + dx, y + dy);
      if (there.face == no_face_hit || !neighbours(sample, there, dx - fx, dy - fy)) continue;
      const double weight = (std::abs(dx) == apron ? 0.5 : 1) * (std::abs(dy) == apron ? 0.5 : 1);
      sum += weight * there.light;
      weights += weight;
    }
  if (weights < 2) return false;
  light = sum / weights;
  return true;
}

void RenderTile::put(Image& image, int left, int top, const RenderScene& scene) const {
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x)
      put_pixel(image.pixel(left + x0_ + x, top + y0_ + y), radiance_[std::size_t(y * width_ + x)], scene);
}

std::size_t render_tile_count(const RenderScene& scene) {
  const auto along = [](int pixels) { return std::size_t((pixels + RenderTile::size - 1) / RenderTile::size); };
  return along(scene.panel_width) * along(scene.panel_height);
}

std::vector<RenderTile> render_tiles(const RenderedPanel& panel, const RenderScene& scene, std::size_t first,
                                     std::size_t count) {
  const auto across = std::size_t((scene.panel_width + RenderTile::size - 1) / RenderTile::size);
  std::vector<RenderTile> tiles;
  for (std::size_t i = first; i < std::min(first + count, render_tile_count(scene)); ++i) {
    const int x = int(i % across) * RenderTile::size, y = int(i / across) * RenderTile::size;
    tiles.emplace_back(panel, x, y, std::min(RenderTile::size, scene.panel_width - x),
                       std::min(RenderTile::size, scene.panel_height - y));
  }
  return tiles;
}

Image blank_picture(const RenderScene& scene) {
  Image image(scene.width(), scene.height());
  image.opaque = !scene.transparent;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) put_pixel(image.pixel(x, y), {}, scene);
  return image;
}

} // namespace cowgpu::plan

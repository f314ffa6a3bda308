// Ray casting in tiles. In each, rays through the pixels' middles; from what they hit, rays in 16 directions out of 256
// for the light that surroundings take away, averaged over neighbours of the same surface so that all 256 count (Keller
// and Heidrich, Interleaved sampling, Rendering Techniques 2001); 16 rays through each pixel that an edge crosses.
#include "host/cpu/render.hpp"

#include "host/error.hpp"
#include "host/parallel.hpp"
#include "host/plan/bvh.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace cowgpu::cpu {
namespace {

constexpr int tile = 64, apron = 2, side = tile + 2 * apron; // pixels
constexpr int samples = 16;                                  // of a pixel on an edge
constexpr int patterns = 16, rays = 16;                      // of ambient light: in a block of 4 x 4 pixels; at each
constexpr double reach = 0.3; // how far surroundings darken, of the panel's largest extent

struct Point2 {
  double x, y;
};

/// Point i of Sobol's sequence in two dimensions: any 16 that start at a multiple of 16 fall into all 16 strips of
/// either direction and all boxes of 4 x 4.
Point2 sobol(std::uint32_t i) {
  std::uint32_t x = 0, y = 0;
  for (std::uint32_t bit = 0x80000000U, v = 0x80000000U; i; i >>= 1, bit >>= 1, v ^= v >> 1)
    if (i & 1) x ^= bit, y ^= v;
  return {(x + 0.5) * 0x1p-32, (y + 0.5) * 0x1p-32};
}

/// Around +z with density cos / pi.
std::vector<Vec3> hemisphere() {
  std::vector<Vec3> directions;
  for (std::uint32_t i = 0; i < patterns * rays; ++i) {
    const Point2 p = sobol(i);
    const double r = std::sqrt(p.x), phi = 2 * M_PI * p.y;
    directions.emplace_back(r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - p.x));
  }
  return directions;
}

/// What a ray meets: the picture's coordinates, in pixels, z towards the eye.
struct Sample {
  static constexpr std::uint32_t nothing = 0xffffffffU;
  std::uint32_t face = nothing;
  double z = 0;
  Vec3 normal, flat; ///< for shading; of the triangle: both towards the eye
  double light = 1;  ///< part of the surrounding light that arrives
};

Vec3 towards_eye(Vec3 n) {
  if (n.z() < 0) n = -n;
  return n;
}

struct Rgb {
  double r = 0, g = 0, b = 0, coverage = 0;
  void add(const Rgb& c, double weight) {
    r += weight * c.r;
    g += weight * c.g;
    b += weight * c.b;
    coverage += weight * c.coverage;
  }
};

std::uint8_t to_srgb(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  const double s = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
  return std::uint8_t(255 * s + 0.5);
}

/// A panel in the picture's coordinates: x to the right and y down from its upper left corner, in pixels, z towards the
/// eye. (Mirrored, so cross products look inwards; normals are turned towards the eye anyway.)
class Panel {
public:
  Panel(const RenderPanel& panel, const RenderScene& scene)
      : panel_(panel), scene_(scene), tree_(transform()), directions_(hemisphere()) {
    vertices_ = {};
  }

  Sample cast(double x, double y) const {
    plan::RayHit hit;
    Sample sample;
    if (!tree_.first_hit({{x, y, front_}, {0, 0, -1}}, hit)) return sample;
    sample.face = hit.face;
    sample.z = front_ - hit.t;
    sample.flat = flat_[hit.face];
    sample.normal = sample.flat;
    if (!normals_.empty()) {
      const Face& f = faces_[hit.face];
      const Vec3 n = (1 - hit.u - hit.v) * normals_[f[0]] + hit.u * normals_[f[1]] + hit.v * normals_[f[2]];
      // Zero: the surface is to be flat. An interpolated normal may look away at an outline.
      if (n.squaredNorm() > 1e-12) {
        Vec3 turned = n.dot(sample.flat) < 0 ? Vec3(-n) : n;
        turned.z() = std::max(turned.z(), 0.0);
        sample.normal = turned.normalized();
      }
    }
    return sample;
  }

  /// The part of the surrounding light that reaches a sample, by one of the patterns.
  double light(const Sample& sample, double x, double y, int pattern) const {
    const Vec3& n = sample.normal;
    // Frame of Duff et al., JCGT 6 (2017) 1; n.z >= 0.
    const double a = -1 / (1 + n.z()), b = n.x() * n.y() * a;
    const Vec3 s(1 + n.x() * n.x() * a, b, -n.x()), t(b, 1 + n.y() * n.y() * a, -n.y());
    const Vec3 origin = Vec3(x, y, sample.z) + 1e-4 * reach_ * sample.flat;
    double arrived = 0, sent = 0;
    for (int i = pattern * rays; i < (pattern + 1) * rays; ++i) {
      const Vec3& d = directions_[std::size_t(i)];
      const Vec3 direction = d.x() * s + d.y() * t + d.z() * n;
      if (direction.dot(sample.flat) < 0.02) continue; // below the triangle, where the interpolated normal does not fit
      plan::RayHit hit;
      sent += 1;
      arrived += tree_.first_hit({origin, direction, reach_}, hit) ? hit.t / reach_ : 1;
    }
    return sent > 0 ? arrived / sent : 1;
  }

  Rgb shade(const Sample& sample) const {
    const Vec3& n = sample.normal;
    // y is down. A warm key light from the upper left, the sky above, the ground's reflection below, and a weak light
    // from the right so that shadows keep their shape.
    static const Vec3 key = Vec3(-0.52, -0.66, 0.54).normalized(), fill = Vec3(0.75, 0.05, 0.40).normalized();
    static const Vec3 half = (key + Vec3(0, 0, 1)).normalized();
    const double up = 0.5 - 0.5 * n.y();
    const double lit = std::max(0.0, n.dot(key)) * (0.35 + 0.65 * sample.light);
    const double soft = std::max(0.0, n.dot(fill)) * sample.light;
    const double gloss = 0.055 * std::pow(std::max(0.0, n.dot(half)), 24.0) * sample.light;
    const double rim = 0.72 + 0.28 * std::sqrt(n.z()); // outlines darken a little, and stand out from white
    const Colour& colour = panel_.surfaces[surface_of(sample.face)].colour;
    const auto channel = [&](float reflectance, double sky, double ground, double sun) {
      const double ambient = (ground + (sky - ground) * up) * sample.light * (0.4 + 0.6 * sample.light);
      return reflectance * rim * (ambient + sun * lit + 0.14 * soft) + gloss;
    };
    return {channel(colour[0], 0.38, 0.19, 1.20), channel(colour[1], 0.41, 0.18, 1.14),
            channel(colour[2], 0.46, 0.17, 1.05), 1};
  }

private:
  std::size_t surface_of(std::uint32_t face) const {
    return std::size_t(std::upper_bound(first_face_.begin(), first_face_.end(), face) - first_face_.begin()) - 1;
  }

  plan::Bvh transform() {
    const double scale = scene_.panel_height / panel_.height;
    Eigen::Matrix3d axes = panel_.view.axes();
    axes.row(1) *= -1;
    const Vec3 middle(scene_.panel_width / 2.0, scene_.panel_height / 2.0, 0);
    const bool smooth = std::any_of(panel_.surfaces.begin(), panel_.surfaces.end(),
                                    [](const RenderSurface& s) { return !s.normals.empty(); });
    for (const RenderSurface& surface : panel_.surfaces) {
      const auto base = std::uint32_t(vertices_.size());
      first_face_.push_back(std::uint32_t(faces_.size()));
      for (const Vec3& v : surface.vertices) vertices_.push_back(scale * (axes * (v - panel_.centre)) + middle);
      if (smooth) normals_.resize(vertices_.size(), Vec3::Zero());
      for (std::size_t v = 0; v < surface.normals.size(); ++v) normals_[base + v] = axes * surface.normals[v];
      for (const Face& f : surface.faces) faces_.push_back({base + f[0], base + f[1], base + f[2]});
    }
    Vec3 low = vertices_[faces_[0][0]], high = low;
    flat_.reserve(faces_.size());
    for (const Face& f : faces_) {
      const Vec3 &a = vertices_[f[0]], &b = vertices_[f[1]], &c = vertices_[f[2]];
      low = low.cwiseMin(a).cwiseMin(b).cwiseMin(c);
      high = high.cwiseMax(a).cwiseMax(b).cwiseMax(c);
      flat_.push_back(towards_eye((b - a).cross(c - a).stableNormalized()));
    }
    const double extent = (high - low).maxCoeff();
    front_ = high.z() + 1e-6 * extent + 1;
    reach_ = std::max(reach * extent, 1e-9);
    return plan::Bvh(vertices_, faces_);
  }

  const RenderPanel& panel_;
  const RenderScene& scene_;
  std::vector<Vec3> vertices_; ///< until the tree holds them
  std::vector<Face> faces_;
  std::vector<Vec3> normals_, flat_;
  std::vector<std::uint32_t> first_face_; ///< of each surface
  double front_ = 0, reach_ = 1;
  plan::Bvh tree_;
  std::vector<Vec3> directions_;
};

/// A tile with its apron, one sample a pixel.
class Tile {
public:
  Tile(const Panel& panel, int x0, int y0) : panel_(panel), x0_(x0), y0_(y0), cells_(std::size_t(side * side)) {
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        Sample& sample = cells_[std::size_t(y * side + x)];
        const double px = x0 + x - apron + 0.5, py = y0 + y - apron + 0.5;
        sample = panel.cast(px, py);
        if (sample.face != Sample::nothing) sample.light = panel.light(sample, px, py, pattern(x0 + x, y0 + y));
      }
  }

  /// Colour and coverage of the pixel (x, y) of the tile.
  Rgb pixel(int x, int y) const {
    Rgb sum;
    if (!on_edge(x, y)) {
      Sample sample = at(x, y);
      if (sample.face == Sample::nothing) return sum;
      sample.light = smoothed(sample, x, y, 0, 0);
      sum.add(panel_.shade(sample), 1);
      return sum;
    }
    for (std::uint32_t i = 0; i < samples; ++i) {
      const Point2 p = sobol(i);
      Sample sample = panel_.cast(x0_ + x + p.x, y0_ + y + p.y);
      if (sample.face == Sample::nothing) continue;
      sample.light = smoothed(sample, x, y, p.x - 0.5, p.y - 0.5);
      sum.add(panel_.shade(sample), 1.0 / samples);
    }
    return sum;
  }

private:
  static int pattern(int x, int y) { return (x & 3) + 4 * (y & 3); }

  const Sample& at(int x, int y) const { return cells_[std::size_t((y + apron) * side + x + apron)]; }

  /// Whether b, (dx, dy) pixels from a, belongs to a surface that passes a smoothly.
  static bool neighbours(const Sample& a, const Sample& b, double dx, double dy) {
    if (a.normal.dot(b.normal) < 0.93) return false;
    const double expected = std::max(std::abs(a.flat.x() * dx + a.flat.y() * dy) / std::max(a.flat.z(), 0.02),
                                     std::abs(b.flat.x() * dx + b.flat.y() * dy) / std::max(b.flat.z(), 0.02));
    return std::abs(a.z - b.z) <= 2 * expected + 1;
  }

  bool on_edge(int x, int y) const {
    const Sample& here = at(x, y);
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const Sample& there = at(x + dx, y + dy);
        if ((here.face == Sample::nothing) != (there.face == Sample::nothing)) return true;
        if (here.face != Sample::nothing && !neighbours(here, there, dx, dy)) return true;
      }
    return false;
  }

  /// The mean of the light at the neighbours of a sample at (fx, fy) from the middle of the pixel (x, y). Weights
  /// 1/2 1 1 1 1/2 count each of the 4 x 4 patterns once.
  double smoothed(const Sample& sample, int x, int y, double fx, double fy) const {
    double sum = 0, weights = 0;
    for (int dy = -apron; dy <= apron; ++dy)
      for (int dx = -apron; dx <= apron; ++dx) {
        const Sample& there = at(x + dx, y + dy);
        if (there.face == Sample::nothing || !neighbours(sample, there, dx - fx, dy - fy)) continue;
        const double weight = (std::abs(dx) == apron ? 0.5 : 1) * (std::abs(dy) == apron ? 0.5 : 1);
        sum += weight * there.light;
        weights += weight;
      }
    if (weights >= 2) return sum / weights;
    return panel_.light(sample, x0_ + x + 0.5 + fx, y0_ + y + 0.5 + fy, pattern(x0_ + x, y0_ + y));
  }

  const Panel& panel_;
  int x0_, y0_;
  std::vector<Sample> cells_;
};

void put(std::uint8_t* pixel, const Rgb& c, const RenderScene& scene) {
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

} // namespace

Image render(const RenderScene& scene, unsigned threads, Monitor& monitor) {
  check(scene);
  Image image(scene.width(), scene.height());
  image.opaque = !scene.transparent;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) put(image.pixel(x, y), {}, scene);

  const int across = (scene.panel_width + tile - 1) / tile, down = (scene.panel_height + tile - 1) / tile;
  for (std::size_t p = 0; p < scene.panels.size(); ++p) {
    const Panel panel(scene.panels[p], scene);
    check_stop(monitor);
    const int left = int(p) % scene.columns * scene.panel_width, top = int(p) / scene.columns * scene.panel_height;
    std::atomic<int> done{0};
    parallel_for(threads, std::size_t(across) * std::size_t(down), [&](std::size_t task, unsigned thread) {
      check_stop(monitor);
      const int x0 = int(task) % across * tile, y0 = int(task) / across * tile;
      const Tile cells(panel, x0, y0);
      for (int y = 0; y < std::min(tile, scene.panel_height - y0); ++y)
        for (int x = 0; x < std::min(tile, scene.panel_width - x0); ++x)
          put(image.pixel(left + x0 + x, top + y0 + y), cells.pixel(x, y), scene);
      ++done;
      if (thread == 0)
        monitor.progress("render", (double(p) + double(done) / (across * down)) / double(scene.panels.size()));
    });
  }
  return image;
}

} // namespace cowgpu::cpu

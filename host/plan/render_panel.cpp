#include "host/plan/render.hpp"

#include "host/plan/sobol.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace cowgpu::plan {
namespace {

constexpr int patterns = 16, rays_each = 16; // ambient light: patterns in a block of 4 x 4 pixels; rays at each pixel
constexpr double reach = 0.3;                // how far surroundings darken, of the panel's largest extent

/// Around +z with density cos / pi.
std::vector<Vec3> hemisphere() {
  std::vector<Vec3> directions;
  for (std::uint32_t i = 0; i < patterns * rays_each; ++i) {
    const SobolPoint p = sobol(i);
    const double r = std::sqrt(p.x), phi = 2 * M_PI * p.y;
    directions.emplace_back(r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - p.x));
  }
  return directions;
}

Vec3 towards_eye(Vec3 n) {
  if (n.z() < 0) n = -n;
  return n;
}

} // namespace

RenderedPanel::RenderedPanel(const RenderPanel& panel, const RenderScene& scene)
    : panel_(panel), scene_(scene), tree_(transform()), directions_(hemisphere()) {}

Bvh RenderedPanel::transform() {
  const double scale = scene_.panel_height / panel_.height;
  Eigen::Matrix3d axes = panel_.view.axes();
  axes.row(1) *= -1;
  const Vec3 middle(scene_.panel_width / 2.0, scene_.panel_height / 2.0, 0);
  const bool smooth = std::any_of(panel_.surfaces.begin(), panel_.surfaces.end(),
                                  [](const RenderSurface& s) { return !s.normals.empty(); });
  for (const RenderSurface& surface : panel_.surfaces) {
    const auto base = std::uint32_t(vertices_.size());
    first_face_.push_back(std::uint32_t(faces_.size()));
    first_vertex_.push_back(base);
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
  return Bvh(vertices_, faces_);
}

std::size_t RenderedPanel::surface_of(std::uint32_t face) const {
  return std::size_t(std::upper_bound(first_face_.begin(), first_face_.end(), face) - first_face_.begin()) - 1;
}

RenderSample RenderedPanel::sample(const RayHit& hit) const {
  RenderSample sample;
  if (hit.face == no_face_hit) return sample;
  const Face& f = faces_[hit.face];
  sample.face = hit.face;
  sample.z = front_ - hit.t;
  sample.flat = flat_[hit.face];
  sample.normal = sample.flat;
  if (!normals_.empty()) {
    const Vec3 n = (1 - hit.u - hit.v) * normals_[f[0]] + hit.u * normals_[f[1]] + hit.v * normals_[f[2]];
    // Zero: the surface is to be flat. An interpolated normal may look away at an outline.
    if (n.squaredNorm() > 1e-12) {
      Vec3 turned = n.dot(sample.flat) < 0 ? Vec3(-n) : n;
      turned.z() = std::max(turned.z(), 0.0);
      sample.normal = turned.normalized();
    }
  }
  const std::size_t s = surface_of(hit.face);
  const RenderSurface& surface = panel_.surfaces[s];
  sample.colour = surface.colour;
  if (!surface.vertex_colours.empty()) {
    const auto weight = [](double w) { return float(std::clamp(w, 0.0, 1.0)); };
    const float weights[3] = {weight(1 - hit.u - hit.v), weight(hit.u), weight(hit.v)};
    sample.colour = {};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 3; ++c)
        sample.colour[c] += weights[k] * surface.vertex_colours[f[k] - first_vertex_[s]][c];
  }
  return sample;
}

int RenderedPanel::add_light_rays(const RenderSample& sample, double x, double y, int pattern,
                                  std::vector<Ray>& rays) const {
  const Vec3& n = sample.normal;
  // Frame of Duff et al., JCGT 6 (2017) 1; n.z >= 0.
  const double a = -1 / (1 + n.z()), b = n.x() * n.y() * a;
  const Vec3 s(1 + n.x() * n.x() * a, b, -n.x()), t(b, 1 + n.y() * n.y() * a, -n.y());
  const Vec3 origin = Vec3(x, y, sample.z) + 1e-4 * reach_ * sample.flat;
  int added = 0;
  for (int i = pattern * rays_each; i < (pattern + 1) * rays_each; ++i) {
    const Vec3& d = directions_[std::size_t(i)];
    const Vec3 direction = d.x() * s + d.y() * t + d.z() * n;
    if (direction.dot(sample.flat) < 0.02) continue; // below the triangle, where the interpolated normal does not fit
    rays.push_back({origin, direction, reach_});
    ++added;
  }
  return added;
}

double RenderedPanel::light(std::span<const RayHit> hits) const {
  double arrived = 0;
  for (const RayHit& hit : hits) arrived += hit.face == no_face_hit ? 1 : hit.t / reach_;
  return hits.empty() ? 1 : arrived / double(hits.size());
}

Radiance RenderedPanel::shade(const RenderSample& sample) const {
  const Vec3& n = sample.normal;
  // y is down. A warm key light from the upper left, the sky above, the ground's reflection below, and a weak light from
  // the right so that shadows keep their shape.
  static const Vec3 key = Vec3(-0.52, -0.66, 0.54).normalized(), fill = Vec3(0.75, 0.05, 0.40).normalized();
  static const Vec3 half = (key + Vec3(0, 0, 1)).normalized();
  const double up = 0.5 - 0.5 * n.y();
  const double lit = std::max(0.0, n.dot(key)) * (0.35 + 0.65 * sample.light);
  const double soft = std::max(0.0, n.dot(fill)) * sample.light;
  const double gloss = 0.055 * std::pow(std::max(0.0, n.dot(half)), 24.0) * sample.light;
  const double rim = 0.72 + 0.28 * std::sqrt(n.z()); // outlines darken a little, and stand out from white
  const auto channel = [&](float reflectance, double sky, double ground, double sun) {
    const double ambient = (ground + (sky - ground) * up) * sample.light * (0.4 + 0.6 * sample.light);
    return reflectance * rim * (ambient + sun * lit + 0.14 * soft) + gloss;
  };
  return {channel(sample.colour[0], 0.38, 0.19, 1.20), channel(sample.colour[1], 0.41, 0.18, 1.14),
          channel(sample.colour[2], 0.46, 0.17, 1.05), 1};
}

} // namespace cowgpu::plan

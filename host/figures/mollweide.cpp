#include "host/figures/mollweide.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace cowgpu::figures {
namespace {

constexpr double pixels = 3; // a point
constexpr int samples = 2;   // a pixel, each way
constexpr double degree = M_PI / 180;

double value_at(const SphereGrid& grid, std::span<const double> values, double theta, double phi) {
  const double ring = std::clamp(theta / M_PI * (grid.rings - 1), 0.0, grid.rings - 1.0);
  const double turn = phi / (2 * M_PI) - std::floor(phi / (2 * M_PI)), place = turn * grid.ring_length;
  const int i = std::min(int(ring), std::max(grid.rings - 2, 0)), j = int(place) % grid.ring_length;
  const int i1 = std::min(i + 1, grid.rings - 1), j1 = (j + 1) % grid.ring_length;
  const double s = ring - i, t = place - std::floor(place);
  const auto at = [&](int a, int b) { return values[std::size_t(a) * std::size_t(grid.ring_length) + std::size_t(b)]; };
  return (1 - s) * ((1 - t) * at(i, j) + t * at(i, j1)) + s * ((1 - t) * at(i1, j) + t * at(i1, j1));
}

plot::Point on_page(const plot::Box& box, const MapPoint& p) {
  return {box.middle().x + p.x * box.width / 4, box.middle().y - p.y * box.height / 2};
}

} // namespace

MapPoint mollweide(double theta, double phi) {
  // Newton's iteration; t for the poles themselves, where it stalls.
  const double target = M_PI * std::cos(theta);
  double t = M_PI / 2 - theta;
  for (int i = 0; i < 60 && std::abs(2 * t + std::sin(2 * t) - target) > 1e-15; ++i) {
    const double slope = 2 + 2 * std::cos(2 * t);
    if (slope < 1e-12) break;
    t = std::clamp(t - (2 * t + std::sin(2 * t) - target) / slope, -M_PI / 2, M_PI / 2);
  }
  return {2 * phi / M_PI * std::cos(t), std::sin(t)};
}

bool from_mollweide(const MapPoint& at, double& theta, double& phi) {
  if (!(at.x * at.x / 4 + at.y * at.y <= 1)) return false;
  const double t = std::asin(at.y), c = std::cos(t);
  theta = std::acos(std::clamp((2 * t + std::sin(2 * t)) / M_PI, -1.0, 1.0));
  phi = c > 0 ? std::clamp(M_PI * at.x / (2 * c), -M_PI, M_PI) : 0;
  return true;
}

void draw_mollweide(plot::Canvas& canvas, const plot::Box& box, const SphereGrid& grid, std::span<const double> values,
                    const plot::Range& range) {
  Image image(int(std::lround(box.width * pixels)), int(std::lround(box.height * pixels)));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      double sum[3] = {}, inside = 0;
      for (int k = 0; k < samples * samples; ++k) {
        const MapPoint at = {4 * (x + (k % samples + 0.5) / samples) / image.width - 2,
                             1 - 2 * (y + (k / samples + 0.5) / samples) / image.height};
        double theta = 0, phi = 0;
        // A little beyond the rim, so that the line round it has colour under it.
        if (!from_mollweide({at.x * 0.998, at.y * 0.998}, theta, phi)) continue;
        const plot::Ink ink =
            plot::viridis(plot::axis_place(value_at(grid, values, theta, phi), range, plot::Scale::linear));
        sum[0] += ink.r, sum[1] += ink.g, sum[2] += ink.b;
        inside += 1;
      }
      if (inside == 0) continue;
      std::uint8_t* const p = image.pixel(x, y);
      for (int c = 0; c < 3; ++c) p[c] = std::uint8_t(255 * sum[c] / inside + 0.5);
      p[3] = std::uint8_t(255 * inside / (samples * samples) + 0.5);
    }
  canvas.picture(image, box);

  const plot::Pen line{plot::white.faded(0.55), 0.5, plot::Dash::solid};
  for (int meridian = -150; meridian <= 150; meridian += 30) {
    std::vector<plot::Point> points;
    for (int theta = 0; theta <= 180; theta += 3)
      points.push_back(on_page(box, mollweide(theta * degree, meridian * degree)));
    canvas.line(points, line);
  }
  for (int parallel = 30; parallel <= 150; parallel += 30) {
    const MapPoint end = mollweide(parallel * degree, M_PI);
    const plot::Point points[] = {on_page(box, {-end.x, end.y}), on_page(box, end)};
    canvas.line(points, line);
    canvas.text({points[0].x - 2, points[0].y}, fmt::format("{}°", parallel),
                {.size = 6, .across = plot::Across::right, .down = plot::Down::middle});
  }
  for (int meridian = -90; meridian <= 90; meridian += 90)
    canvas.text(
        on_page(box, mollweide(M_PI / 2, meridian * degree)),
        meridian < 0 ? fmt::format("−{}°", -meridian) : fmt::format("{}°", meridian),
        {.size = 6, .across = plot::Across::middle, .down = plot::Down::middle, .halo = plot::white.faded(0.75)});
  std::vector<plot::Point> rim;
  for (int i = 0; i < 180; ++i) rim.push_back(on_page(box, {2 * std::cos(2 * i * degree), std::sin(2 * i * degree)}));
  canvas.line(rim, {plot::black, 0.8, plot::Dash::solid}, true);
}

} // namespace cowgpu::figures

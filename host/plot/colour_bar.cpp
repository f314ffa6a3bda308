#include "host/plot/plot.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu::plot {
namespace {

constexpr double tick_size = 8, label_size = 9, tick_length = 3;
constexpr int steps = 256;

std::string with_power(const std::string& label, int power) {
  return power == 0 ? label : fmt::format("{} · 10$^{{{}{}}}$", label, power < 0 ? "−" : "", std::abs(power));
}

} // namespace

void draw_colour_bar(Canvas& canvas, const Box& box, const Range& range, const std::string& label) {
  for (int i = 0; i < steps; ++i) {
    // Each lies over the next, so that no seam shows.
    const double top = box.bottom() - box.height * (i + 1) / steps;
    canvas.fill(Box{box.x, top, box.width, std::min(2 * box.height / steps, box.bottom() - top)},
                viridis((i + 0.5) / steps));
  }
  canvas.frame(box, {black, 0.6, Dash::solid});
  const Ticks ticks = axis_ticks(range, Scale::linear, std::max(2, int(box.height / 26)));
  double widest = 0;
  for (const Tick& tick : ticks.ticks) {
    const double y = box.bottom() - axis_place(tick.at, range, Scale::linear) * box.height;
    const Point line[] = {{box.right(), y}, {box.right() + tick_length, y}};
    canvas.line(line, {black, 0.6, Dash::solid});
    canvas.text({box.right() + tick_length + 2, y}, tick.label, {.size = tick_size, .down = Down::middle});
    widest = std::max(widest, canvas.measure(tick.label, {.size = tick_size}).width);
  }
  canvas.text({box.right() + tick_length + widest + 6, box.middle().y}, with_power(label, ticks.power),
              {.size = label_size, .across = Across::middle, .down = Down::top, .angle = 90});
}

void draw_flat_colour_bar(Canvas& canvas, const Box& box, const Range& range, const std::string& label) {
  for (int i = steps - 1; i >= 0; --i) {
    const double left = box.x + box.width * i / steps;
    canvas.fill(Box{left, box.y, std::min(2 * box.width / steps, box.right() - left), box.height},
                viridis((i + 0.5) / steps));
  }
  canvas.frame(box, {black, 0.6, Dash::solid});
  const Ticks ticks = axis_ticks(range, Scale::linear, std::max(2, int(box.width / 34)));
  for (const Tick& tick : ticks.ticks) {
    const double x = box.x + axis_place(tick.at, range, Scale::linear) * box.width;
    const Point line[] = {{x, box.bottom()}, {x, box.bottom() + tick_length}};
    canvas.line(line, {black, 0.6, Dash::solid});
    canvas.text({x, box.bottom() + tick_length + 1}, tick.label,
                {.size = tick_size, .across = Across::middle, .down = Down::top});
  }
  canvas.text({box.middle().x, box.bottom() + tick_length + 1.4 * tick_size + 2}, with_power(label, ticks.power),
              {.size = label_size, .across = Across::middle, .down = Down::top});
}

} // namespace cowgpu::plot

#include "host/plot/colours.hpp"

#include "host/colour_scale.hpp"

#include <iterator>

namespace cowgpu::plot {

Ink line_colour(std::size_t i) {
  static constexpr Ink inks[] = {blue, vermilion, green, orange, purple, sky, black};
  return inks[i % std::size(inks)];
}

Ink viridis(double t) {
  const auto [r, g, b] = viridis_colour(t);
  return {r, g, b};
}

} // namespace cowgpu::plot

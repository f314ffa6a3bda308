// Colours that the colour-blind tell apart.
#pragma once

#include <cstddef>

namespace cowgpu::plot {

/// Red, green and blue as sRGB (not linear), and opacity, all 0 to 1.
struct Ink {
  double r = 0, g = 0, b = 0, opacity = 1;
  Ink faded(double by) const { return {r, g, b, opacity * by}; }
};

inline constexpr Ink black = {0, 0, 0}, white = {1, 1, 1}, grey = {0.55, 0.55, 0.55}, pale_grey = {0.87, 0.87, 0.87};

/// Okabe and Ito's (Color Universal Design, 2008), the darkest first: no two of them look alike to any of the colour-blind.
inline constexpr Ink blue = {0, 114 / 255.0, 178 / 255.0}, vermilion = {213 / 255.0, 94 / 255.0, 0},
                     green = {0, 158 / 255.0, 115 / 255.0}, orange = {230 / 255.0, 159 / 255.0, 0},
                     purple = {204 / 255.0, 121 / 255.0, 167 / 255.0}, sky = {86 / 255.0, 180 / 255.0, 233 / 255.0};

/// Of the i-th line of a plot: the above and black, over and over.
Ink line_colour(std::size_t i);

/// The scale viridis (host/colour_scale.hpp).
Ink viridis(double t);

} // namespace cowgpu::plot

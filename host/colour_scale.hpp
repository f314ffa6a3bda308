// Colours of numbers on bodies and maps.
#pragma once

#include <array>
#include <span>

namespace cowgpu {

/// The scale viridis (S. van der Walt and N. Smith, 2015; CC0), perceptually uniform and rising in lightness, to 1/255 of a
/// channel, as sRGB (not linear), 0 to 1: 0 dark violet, 1 yellow. Beyond 0 and 1 the ends go on; grey for NaN.
std::array<double, 3> viridis_colour(double t);

/// The linear value (0 to 1) of a channel in sRGB, IEC 61966-2-1.
double to_linear(double srgb);

/// Numbers from the first colour of a scale to the last.
struct ColourRange {
  double low = 0, high = 0;

  /// 0 at low, 1 at high, NaN for NaN; 0.5 where both are the same.
  double place(double value) const;
};

/// From the least to the greatest finite number, but for one in two hundred at each end, so that a few outliers do not take all
/// colours; 0 to 0 where there is none. Beyond the ends their colours go on.
ColourRange colour_range(std::span<const double> values);

} // namespace cowgpu

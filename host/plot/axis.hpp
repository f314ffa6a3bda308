// An axis of a plot: its range and where its ticks stand.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

namespace cowgpu::plot {

enum class Scale { linear, logarithmic };

inline constexpr double free_end = std::numeric_limits<double>::quiet_NaN();

struct Axis {
  std::string label, unit; ///< shown as "label (unit)"; markup as in canvas.hpp
  Scale scale = Scale::linear;
  double low = free_end, high = free_end; ///< NaN: what the data need, and a margin
};

struct Range {
  double low = 0, high = 1;
};

/// Numbers are shown from -1e300 to 1e300 on linear axes and from 1e-300 to 1e300 on logarithmic ones. Others, 0 on a
/// logarithmic axis among them, are gaps.
bool shown(double value, Scale scale);

/// low < high, both shown and far enough apart for ticks: of the values that are shown, with a margin of 4 % (of the
/// decades on a logarithmic axis); an end that the axis names stays, if it is shown and the other one is beyond it. 0 to 1 or 1
/// to 10 where there is nothing; equal values stand in the middle.
Range axis_range(const Axis& axis, std::span<const std::span<const double>> values);

/// 0 at low, 1 at high; along the logarithm where the scale is.
double axis_place(double value, const Range& range, Scale scale);

struct Tick {
  double at = 0;
  std::string label; ///< "" for a small tick between
};

struct Ticks {
  std::vector<Tick> ticks; ///< rising, inside the range
  int power = 0;           ///< the labels are to be taken times 10^power
};

/// Multiples of 1, 2 or 5 times a power of ten, about `most` of them and no more; on logarithmic axes the decades, or every
/// second, third ... of them, with 2, 5 or linear ticks where there are too few.
Ticks axis_ticks(const Range& range, Scale scale, int most);

} // namespace cowgpu::plot

// Plots of lines and points on one pair of axes.
#pragma once

#include "host/plot/axis.hpp"
#include "host/plot/canvas.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu::plot {

enum class Marker { none, disc, circle, square, triangle, diamond, cross };

/// A line through points, or the points alone. NaN, infinity, and what a logarithmic axis cannot show, are gaps; a point
/// between two gaps is shown as a dot.
struct Series {
  std::string name; ///< in the legend; "": not there
  std::vector<double> x, y;
  std::optional<Ink> colour = {}; ///< the next of line_colour()
  bool line = true;
  Dash dash = Dash::solid;
  double width = 1.4;
  Marker marker = Marker::none;
  double marker_size = 4.5; ///< points across
};

/// A point that is named beside it, where there is room.
struct PointMark {
  double x = 0, y = 0;
  std::string label;
  Ink colour = black;
  Marker marker = Marker::disc;
};

/// A line across the whole plot at a value of x (vertical) or y, named along it.
struct LineMark {
  bool vertical = false;
  double at = 0;
  std::string label;
  Ink colour = grey;
  Dash dash = Dash::dashed;
};

/// What lies between two curves over x; infinities mean the edge of the plot.
struct Region {
  std::string name; ///< in the legend; "": not there
  std::vector<double> x, low, high;
  Ink colour = sky.faded(0.3);
};

enum class LegendPlace { automatic, outside, none };

struct Plot {
  std::string title;
  Axis x, y;
  std::vector<Series> series;
  std::vector<PointMark> points;
  std::vector<LineMark> lines;
  std::vector<Region> regions;
  /// Automatic: in the corner or at the edge where nothing lies under it; outside where there is no such place.
  LegendPlace legend = LegendPlace::automatic;
  bool equal_scale = false; ///< a unit is as long along x as along y; linear axes; grows the range that has room
  bool grid = true;
};

/// Where a plot was drawn, for what is drawn on top of it.
struct PlotFrame {
  Box box; ///< inside the axes
  Range x, y;
  Scale x_scale = Scale::linear, y_scale = Scale::linear;

  /// The place on the page; of values that are shown only.
  Point at(double px, double py) const;
};

/// Draws into the box, axes and labels included. Throws Error(bad_argument) where x and y, or the curves of a region,
/// differ in length, or for equal_scale with a logarithmic axis.
PlotFrame draw(const Plot& plot, Canvas& canvas, const Box& box);

/// Size of a plot's page unless told otherwise, in points.
inline constexpr double plot_width = 460, plot_height = 320;

/// A page with this plot alone, as PNG (three pixels a point) or SVG by the name's end, whole or not at all. Throws what
/// draw(), picture_format() and AtomicFile throw.
void write_plot(const Plot& plot, const std::filesystem::path& path, double width = plot_width,
                double height = plot_height);

/// A scale of colours with its ticks and its name, from the box's lower to its upper edge, labels to the right of it.
void draw_colour_bar(Canvas& canvas, const Box& box, const Range& range, const std::string& label);

/// The same from left to right, labels below.
void draw_flat_colour_bar(Canvas& canvas, const Box& box, const Range& range, const std::string& label);

} // namespace cowgpu::plot

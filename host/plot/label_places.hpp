// Where labels and legends find room.
#pragma once

#include "host/plot/canvas.hpp"

#include <span>
#include <vector>

namespace cowgpu::plot {

/// What is drawn inside a box, as points a few apart.
class LabelPlaces {
public:
  explicit LabelPlaces(const Box& frame) : frame_(frame) {}

  void add_point(const Point& p) { points_.push_back(p); }
  /// Points along the line, closer than a letter's height.
  void add_line(const Point& a, const Point& b);
  void add_box(const Box& box) { boxes_.push_back(box); }

  /// How much a label there would cover: 0 for nothing, parts outside the frame included.
  double cost(const Box& label) const;
  /// The first of the candidates with the least cost.
  Box best(std::span<const Box> candidates, double* cost = nullptr) const;

private:
  Box frame_;
  std::vector<Point> points_;
  std::vector<Box> boxes_;
};

/// The part of the line from a to b inside the box; false where there is none.
bool clip_line(Point& a, Point& b, const Box& box);

} // namespace cowgpu::plot

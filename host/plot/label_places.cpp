#include "host/plot/label_places.hpp"

#include <algorithm>
#include <cmath>

namespace cowgpu::plot {

void LabelPlaces::add_line(const Point& a, const Point& b) {
  constexpr double spacing = 3;
  Point from = a, to = b;
  if (!clip_line(from, to, frame_)) return;
  const int steps = std::max(1, int(std::hypot(to.x - from.x, to.y - from.y) / spacing));
  for (int i = 0; i <= steps; ++i) {
    const double t = double(i) / steps;
    points_.push_back({from.x + t * (to.x - from.x), from.y + t * (to.y - from.y)});
  }
}

double LabelPlaces::cost(const Box& label) const {
  double sum = 0;
  for (const Point& p : points_)
    if (label.holds(p)) sum += 1;
  for (const Box& box : boxes_) {
    const double across = std::min(label.right(), box.right()) - std::max(label.x, box.x);
    const double down = std::min(label.bottom(), box.bottom()) - std::max(label.y, box.y);
    if (across > 0 && down > 0) sum += 3 + across * down / 10;
  }
  const double inside = std::max(0.0, std::min(label.right(), frame_.right()) - std::max(label.x, frame_.x)) *
                        std::max(0.0, std::min(label.bottom(), frame_.bottom()) - std::max(label.y, frame_.y));
  const double outside = label.width * label.height - inside;
  return outside > 1e-6 ? sum + 100 + outside : sum;
}

Box LabelPlaces::best(std::span<const Box> candidates, double* least) const {
  Box found;
  double lowest = INFINITY;
  for (const Box& candidate : candidates) {
    const double here = cost(candidate);
    if (here < lowest) {
      lowest = here;
      found = candidate;
    }
  }
  if (least) *least = lowest;
  return found;
}

bool clip_line(Point& a, Point& b, const Box& box) {
  // Liang and Barsky, ACM Transactions on Graphics 3 (1984) 1.
  double from = 0, to = 1;
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double slopes[] = {-dx, dx, -dy, dy};
  const double rooms[] = {a.x - box.x, box.right() - a.x, a.y - box.y, box.bottom() - a.y};
  for (int i = 0; i < 4; ++i) {
    if (slopes[i] == 0) {
      if (rooms[i] < 0) return false;
      continue;
    }
    const double t = rooms[i] / slopes[i];
    if (slopes[i] < 0)
      from = std::max(from, t);
    else
      to = std::min(to, t);
  }
  if (from > to) return false;
  b = {a.x + to * dx, a.y + to * dy};
  a = {a.x + from * dx, a.y + from * dy};
  return true;
}

} // namespace cowgpu::plot

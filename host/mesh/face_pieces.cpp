#include "host/mesh/face_pieces.hpp"

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

constexpr double least_fraction = 1e-14;

double across(const Vec2& u, const Vec2& v) {
  return u.x() * v.y() - u.y() * v.x();
}

/// A segment from below to above, not horizontal.
struct Riser {
  Vec2 low, high;
  bool own; ///< an edge of the triangle

  double x(double y) const {
    const double t = std::clamp((y - low.y()) / (high.y() - low.y()), 0.0, 1.0);
    return low.x() + t * (high.x() - low.x());
  }
};

void add(std::vector<Riser>& risers, Vec2 from, Vec2 to, bool own) {
  if (from.y() > to.y()) std::swap(from, to);
  if (from.y() < to.y()) risers.push_back({from, to, own});
}

/// The height where two segments cross, if they do between their ends.
void add_crossing(const Riser& p, const Riser& q, std::vector<double>& heights) {
  const Vec2 u = p.high - p.low, v = q.high - q.low, w = q.low - p.low;
  const double turn = across(u, v);
  if (turn == 0) return;
  const double s = across(w, v) / turn, t = across(w, u) / turn;
  if (s > 0 && s < 1 && t > 0 && t < 1) heights.push_back(p.low.y() + s * u.y());
}

} // namespace

void for_each_piece(const Vec2& a, const Vec2& b, const Vec2& c, std::span<const Segment2> segments,
                    const std::function<void(const FacePiece& piece)>& each) {
  const double bottom = std::min({a.y(), b.y(), c.y()}), top = std::max({a.y(), b.y(), c.y()});
  const double area = std::abs(across(b - a, c - a)) / 2;
  std::vector<double> heights = {a.y(), b.y(), c.y()};
  std::vector<Riser> risers;
  add(risers, a, b, true);
  add(risers, b, c, true);
  add(risers, c, a, true);
  for (const auto& [from, to] : segments) {
    add(risers, from, to, false);
    for (const double y : {from.y(), to.y()})
      if (y > bottom && y < top) heights.push_back(y);
  }
  std::sort(risers.begin(), risers.end(), [](const Riser& p, const Riser& q) { return p.low.y() < q.low.y(); });
  for (std::size_t i = 0; i < risers.size(); ++i)
    for (std::size_t j = i + 1; j < risers.size() && risers[j].low.y() < risers[i].high.y(); ++j)
      add_crossing(risers[i], risers[j], heights);
  std::sort(heights.begin(), heights.end());
  heights.erase(std::unique(heights.begin(), heights.end()), heights.end());

  struct Place {
    double x;
    const Riser* riser;
  };
  std::vector<Place> row;
  std::vector<const Riser*> active;
  std::size_t next = 0;
  for (std::size_t h = 0; h + 1 < heights.size(); ++h) {
    const double low = heights[h], high = heights[h + 1], middle = low / 2 + high / 2;
    if (high <= bottom || low >= top) continue;
    while (next < risers.size() && risers[next].low.y() <= low) active.push_back(&risers[next++]);
    std::erase_if(active, [&](const Riser* riser) { return riser->high.y() <= low; });
    row.clear();
    Place left{INFINITY, nullptr}, right{-INFINITY, nullptr}; // where the triangle begins and ends
    for (const Riser* riser : active) {
      const Place place{riser->x(middle), riser};
      row.push_back(place);
      if (!riser->own) continue;
      if (place.x < left.x) left = place;
      if (place.x > right.x) right = place;
    }
    std::sort(row.begin(), row.end(), [](const Place& p, const Place& q) { return p.x < q.x; });
    for (std::size_t i = 0; i + 1 < row.size(); ++i) {
      const Place &from = row[i].x < left.x ? left : row[i], &to = row[i + 1].x > right.x ? right : row[i + 1];
      const double fraction = (to.x - from.x) * (high - low) / area;
      if (to.x > from.x && fraction > least_fraction)
        each({{from.x / 2 + to.x / 2, middle},
              fraction,
              {Vec2(from.riser->x(low), low), Vec2(to.riser->x(low), low), Vec2(to.riser->x(high), high),
               Vec2(from.riser->x(high), high)}});
    }
  }
}

} // namespace cowgpu

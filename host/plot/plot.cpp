#include "host/plot/plot.hpp"

#include "host/error.hpp"
#include "host/plot/label_places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace cowgpu::plot {
namespace {

constexpr double title_size = 11, label_size = 10, tick_size = 8.5, note_size = 8.5;
constexpr double tick_length = 4, small_tick = 2.2, gap = 4;
constexpr double legend_line = 22, legend_row = 13.5, legend_pad = 6;
const Pen axis_pen{black, 0.8, Dash::solid};

std::string axis_title(const Axis& axis, int power) {
  std::string unit = axis.unit;
  if (power != 0)
    unit = fmt::format("10$^{{{}{}}}${}{}", power < 0 ? "−" : "", std::abs(power), unit.empty() ? "" : " ", unit);
  return unit.empty() ? axis.label : axis.label.empty() ? unit : fmt::format("{} ({})", axis.label, unit);
}

void draw_marker(Canvas& canvas, const Point& p, Marker marker, double size, const Ink& ink) {
  const double r = size / 2;
  switch (marker) {
  case Marker::none: break;
  case Marker::disc: canvas.disc(p, r, ink); break;
  case Marker::circle:
    canvas.disc(p, r, white);
    canvas.circle(p, r, {ink, 1, Dash::solid});
    break;
  case Marker::square: canvas.fill(Box{p.x - 0.9 * r, p.y - 0.9 * r, 1.8 * r, 1.8 * r}, ink); break;
  case Marker::triangle: {
    const Point corners[] = {{p.x, p.y - 1.15 * r}, {p.x + 1.05 * r, p.y + 0.75 * r}, {p.x - 1.05 * r, p.y + 0.75 * r}};
    canvas.fill(corners, ink);
    break;
  }
  case Marker::diamond: {
    const Point corners[] = {{p.x, p.y - 1.2 * r}, {p.x + 1.2 * r, p.y}, {p.x, p.y + 1.2 * r}, {p.x - 1.2 * r, p.y}};
    canvas.fill(corners, ink);
    break;
  }
  case Marker::cross:
    for (const double s : {1.0, -1.0}) {
      const Point stroke[] = {{p.x - r, p.y - s * r}, {p.x + r, p.y + s * r}};
      canvas.line(stroke, {ink, 1.2, Dash::solid});
    }
    break;
  }
}

/// Work on one plot, step by step.
class Drawing {
public:
  Drawing(const Plot& plot, Canvas& canvas, const Box& box) : plot_(plot), canvas_(canvas), outer_(box) {}

  PlotFrame run() {
    check();
    find_ranges();
    lay_out();
    LabelPlaces places(frame_.box);
    note_places(places);
    std::vector<Box> legend;
    if (!legend_outside_) legend = find_legend(places);
    if (legend_outside_) {
      // No place inside: the plot gives way.
      outer_.width -= legend_width_;
      lay_out();
      places = LabelPlaces(frame_.box);
      note_places(places);
      legend = {{outer_.right(), frame_.box.y, legend_width_, legend_height_}};
      outer_.width += legend_width_;
    } else if (!legend.empty())
      places.add_box(legend[0]);
    if (plot_.grid) draw_grid();
    canvas_.clip(frame_.box.grown(0.4));
    draw_regions();
    draw_lines();
    draw_series();
    canvas_.end_clip();
    draw_axes();
    if (!legend.empty()) draw_legend(legend[0]);
    draw_notes(places);
    return frame_;
  }

private:
  void check() const {
    for (const Series& s : plot_.series)
      if (s.x.size() != s.y.size())
        throw Error(Fault::bad_argument, fmt::format("the line '{}' of a plot has {} values of x and {} of y", s.name,
                                                     s.x.size(), s.y.size()));
    for (const Region& r : plot_.regions)
      if (r.x.size() != r.low.size() || r.x.size() != r.high.size())
        throw Error(Fault::bad_argument, fmt::format("the region '{}' of a plot has {} values of x, {} and {} of y",
                                                     r.name, r.x.size(), r.low.size(), r.high.size()));
    if (plot_.equal_scale && (plot_.x.scale != Scale::linear || plot_.y.scale != Scale::linear))
      throw Error(Fault::bad_argument, "axes of equal scale cannot be logarithmic");
  }

  void find_ranges() {
    std::vector<double> mark_x, mark_y;
    for (const PointMark& p : plot_.points) mark_x.push_back(p.x), mark_y.push_back(p.y);
    for (const LineMark& l : plot_.lines) (l.vertical ? mark_x : mark_y).push_back(l.at);
    std::vector<std::span<const double>> xs = {mark_x}, ys = {mark_y};
    for (const Series& s : plot_.series) xs.emplace_back(s.x), ys.emplace_back(s.y);
    for (const Region& r : plot_.regions) xs.emplace_back(r.x), ys.emplace_back(r.low), ys.emplace_back(r.high);
    data_x_ = axis_range(plot_.x, xs);
    data_y_ = axis_range(plot_.y, ys);
    frame_.x_scale = plot_.x.scale;
    frame_.y_scale = plot_.y.scale;
    for (const Series& s : plot_.series)
      if (!s.name.empty()) add_legend_width(s.name);
    for (const Region& r : plot_.regions)
      if (!r.name.empty()) add_legend_width(r.name);
    legend_height_ = legend_rows_ * legend_row + 2 * legend_pad - 2;
    if (plot_.legend == LegendPlace::none) legend_rows_ = 0;
    legend_outside_ = legend_rows_ > 0 && plot_.legend == LegendPlace::outside;
  }

  void add_legend_width(const std::string& name) {
    ++legend_rows_;
    legend_width_ =
        std::max(legend_width_, canvas_.measure(name, {.size = note_size}).width + legend_line + gap + 2 * legend_pad);
  }

  void lay_out() {
    frame_.x = data_x_;
    frame_.y = data_y_;
    const double top = plot_.title.empty() ? tick_size / 2 + 2 : 1.9 * title_size;
    const bool named = !plot_.x.label.empty() || !plot_.x.unit.empty() ||
                       axis_ticks(data_x_, frame_.x_scale, int(outer_.width / 48) + 1).power != 0;
    const double bottom = tick_length + 2 + 1.15 * tick_size + (named ? 1.5 * label_size : 0);
    const double height = std::max(outer_.height - top - bottom, 10.0);
    y_ticks_ = axis_ticks(frame_.y, frame_.y_scale, int(height / 32) + 1);
    double left = 0;
    for (int pass = 0; pass < 2; ++pass) { // equal scales change the range, the range the ticks' labels
      tick_width_ = 0;
      for (const Tick& tick : y_ticks_.ticks)
        tick_width_ = std::max(tick_width_, canvas_.measure(tick.label, {.size = tick_size}).width);
      left = tick_length + gap + tick_width_ + (y_title().empty() ? 0 : 1.9 * label_size);
      const double right = 14;
      frame_.box = {outer_.x + left, outer_.y + top, std::max(outer_.width - left - right, 10.0), height};
      if (plot_.equal_scale) equalise();
      y_ticks_ = axis_ticks(frame_.y, frame_.y_scale, int(height / 32) + 1);
    }
    x_ticks_ = axis_ticks(frame_.x, frame_.x_scale, int(frame_.box.width / 48) + 1);
    // Wide labels need fewer ticks.
    for (int most = int(frame_.box.width / 48); most > 2; --most) {
      double needed = 0;
      int labels = 0;
      for (const Tick& tick : x_ticks_.ticks)
        if (!tick.label.empty()) {
          ++labels;
          needed = std::max(needed, canvas_.measure(tick.label, {.size = tick_size}).width + 8);
        }
      if (needed * labels <= frame_.box.width) break;
      x_ticks_ = axis_ticks(frame_.x, frame_.x_scale, most);
    }
  }

  void equalise() {
    frame_.x = data_x_;
    frame_.y = data_y_;
    const double per_x = (frame_.x.high - frame_.x.low) / frame_.box.width;
    const double per_y = (frame_.y.high - frame_.y.low) / frame_.box.height;
    Range& loose = per_x < per_y ? frame_.x : frame_.y;
    const double size = per_x < per_y ? per_y * frame_.box.width : per_x * frame_.box.height;
    const double middle = loose.low / 2 + loose.high / 2;
    loose = {middle - size / 2, middle + size / 2};
  }

  std::string y_title() const { return axis_title(plot_.y, y_ticks_.power); }

  bool visible(double x, double y) const { return shown(x, frame_.x_scale) && shown(y, frame_.y_scale); }

  /// The parts of a series between its gaps.
  std::vector<std::vector<Point>> parts(const Series& series) const {
    std::vector<std::vector<Point>> found(1);
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (visible(series.x[i], series.y[i]))
        found.back().push_back(frame_.at(series.x[i], series.y[i]));
      else if (!found.back().empty())
        found.emplace_back();
    }
    if (found.back().empty()) found.pop_back();
    return found;
  }

  void note_places(LabelPlaces& places) const {
    for (const Series& series : plot_.series)
      for (const std::vector<Point>& part : parts(series)) {
        for (std::size_t i = 0; i < part.size(); ++i) {
          if (!series.line || part.size() == 1) places.add_point(part[i]);
          if (series.line && i + 1 < part.size()) places.add_line(part[i], part[i + 1]);
        }
      }
    for (const PointMark& mark : plot_.points)
      if (visible(mark.x, mark.y)) {
        const Point p = frame_.at(mark.x, mark.y);
        places.add_box({p.x - 3, p.y - 3, 6, 6});
      }
    for (const LineMark& line : plot_.lines)
      if (const auto ends = ends_of(line)) places.add_line(ends->first, ends->second);
    for (const Region& region : plot_.regions) {
      const auto [low, high] = curves(region);
      for (const auto* curve : {&low, &high})
        for (std::size_t i = 0; i + 1 < curve->size(); ++i) places.add_line((*curve)[i], (*curve)[i + 1]);
    }
  }

  std::vector<Box> find_legend(const LabelPlaces& places) {
    if (legend_rows_ == 0) return {};
    const Box& f = frame_.box;
    const double inset = 6, w = legend_width_, h = legend_height_;
    const double x[] = {f.right() - w - inset, f.x + inset, f.x + (f.width - w) / 2};
    const double y[] = {f.y + inset, f.bottom() - h - inset, f.y + (f.height - h) / 2};
    std::vector<Box> candidates;
    for (const double top : y)
      for (const double left : x) candidates.push_back({left, top, w, h});
    double cost = 0;
    const Box best = places.best(candidates, &cost);
    if (cost == 0) return {best};
    legend_outside_ = true;
    return {};
  }

  void draw_grid() {
    for (const Tick& tick : x_ticks_.ticks)
      if (!tick.label.empty()) {
        const double x = frame_.box.x + axis_place(tick.at, frame_.x, frame_.x_scale) * frame_.box.width;
        const Point line[] = {{x, frame_.box.y}, {x, frame_.box.bottom()}};
        canvas_.line(line, {pale_grey, 0.5, Dash::solid});
      }
    for (const Tick& tick : y_ticks_.ticks)
      if (!tick.label.empty()) {
        const double y = frame_.box.bottom() - axis_place(tick.at, frame_.y, frame_.y_scale) * frame_.box.height;
        const Point line[] = {{frame_.box.x, y}, {frame_.box.right(), y}};
        canvas_.line(line, {pale_grey, 0.5, Dash::solid});
      }
  }

  std::pair<std::vector<Point>, std::vector<Point>> curves(const Region& region) const {
    std::vector<Point> low, high;
    const auto place = [&](double x, double y) {
      // The edge of the plot where a curve goes beyond all numbers.
      if (!shown(y, frame_.y_scale)) y = y > 0 ? frame_.y.high : frame_.y.low;
      Point p = frame_.at(x, y);
      p.y = std::clamp(p.y, frame_.box.y - 10, frame_.box.bottom() + 10);
      p.x = std::clamp(p.x, frame_.box.x - 10, frame_.box.right() + 10);
      return p;
    };
    for (std::size_t i = 0; i < region.x.size(); ++i) {
      if (!shown(region.x[i], frame_.x_scale) || std::isnan(region.low[i]) || std::isnan(region.high[i])) continue;
      low.push_back(place(region.x[i], region.low[i]));
      high.push_back(place(region.x[i], region.high[i]));
    }
    return {low, high};
  }

  void draw_regions() {
    for (const Region& region : plot_.regions) {
      auto [ring, high] = curves(region);
      ring.insert(ring.end(), high.rbegin(), high.rend());
      canvas_.fill(ring, region.colour);
    }
  }

  std::optional<std::pair<Point, Point>> ends_of(const LineMark& line) const {
    const Scale scale = line.vertical ? frame_.x_scale : frame_.y_scale;
    const Range& range = line.vertical ? frame_.x : frame_.y;
    if (!shown(line.at, scale)) return {};
    const double place = axis_place(line.at, range, scale);
    if (place < -1e-9 || place > 1 + 1e-9) return {};
    const Box& f = frame_.box;
    if (line.vertical) return std::pair{Point{f.x + place * f.width, f.y}, Point{f.x + place * f.width, f.bottom()}};
    return std::pair{Point{f.x, f.bottom() - place * f.height}, Point{f.right(), f.bottom() - place * f.height}};
  }

  void draw_lines() {
    for (const LineMark& line : plot_.lines)
      if (const auto ends = ends_of(line)) {
        const Point both[] = {ends->first, ends->second};
        canvas_.line(both, {line.colour, 1, line.dash});
      }
  }

  Ink colour_of(std::size_t i) const { return plot_.series[i].colour.value_or(line_colour(i)); }

  void draw_series() {
    const Box room = frame_.box.grown(50);
    for (std::size_t i = 0; i < plot_.series.size(); ++i) {
      const Series& series = plot_.series[i];
      for (const std::vector<Point>& part : parts(series)) {
        if (series.line) draw_line(part, room, {colour_of(i), series.width, series.dash});
        const bool alone = series.line && part.size() == 1 && series.marker == Marker::none;
        for (const Point& p : part)
          if (room.holds(p))
            draw_marker(canvas_, p, alone ? Marker::disc : series.marker, alone ? 2.4 : series.marker_size,
                        colour_of(i));
      }
    }
  }

  void draw_line(const std::vector<Point>& part, const Box& room, const Pen& pen) {
    std::vector<Point> seen;
    for (std::size_t k = 0; k + 1 < part.size(); ++k) {
      Point a = part[k], b = part[k + 1];
      const bool in = clip_line(a, b, room);
      if (in && seen.empty()) seen.push_back(a);
      if (in) seen.push_back(b);
      // Outside the room the line is broken, so that no coordinate is too large for Cairo.
      if (!in || b.x != part[k + 1].x || b.y != part[k + 1].y) {
        canvas_.line(seen, pen);
        seen.clear();
      }
    }
    canvas_.line(seen, pen);
  }

  void draw_axes() {
    const Box& f = frame_.box;
    canvas_.frame(f, axis_pen);
    for (const Tick& tick : x_ticks_.ticks) {
      const double x = f.x + axis_place(tick.at, frame_.x, frame_.x_scale) * f.width;
      const Point line[] = {{x, f.bottom()}, {x, f.bottom() + (tick.label.empty() ? small_tick : tick_length)}};
      canvas_.line(line, axis_pen);
      canvas_.text({x, f.bottom() + tick_length + 2}, tick.label,
                   {.size = tick_size, .across = Across::middle, .down = Down::top});
    }
    for (const Tick& tick : y_ticks_.ticks) {
      const double y = f.bottom() - axis_place(tick.at, frame_.y, frame_.y_scale) * f.height;
      const Point line[] = {{f.x - (tick.label.empty() ? small_tick : tick_length), y}, {f.x, y}};
      canvas_.line(line, axis_pen);
      canvas_.text({f.x - tick_length - 3, y}, tick.label,
                   {.size = tick_size, .across = Across::right, .down = Down::middle});
    }
    canvas_.text({f.middle().x, outer_.bottom() - 2}, axis_title(plot_.x, x_ticks_.power),
                 {.size = label_size, .across = Across::middle, .down = Down::bottom});
    canvas_.text({f.x - tick_length - gap - tick_width_ - 5, f.middle().y}, y_title(),
                 {.size = label_size, .across = Across::middle, .down = Down::baseline, .angle = 90});
    canvas_.text({f.middle().x, outer_.y + 1}, plot_.title,
                 {.size = title_size, .across = Across::middle, .down = Down::top, .bold = true});
  }

  void draw_legend(const Box& box) {
    canvas_.fill(box, white.faded(0.9));
    canvas_.frame(box, {pale_grey, 0.7, Dash::solid});
    double y = box.y + legend_pad + legend_row / 2 - 1;
    const double left = box.x + legend_pad;
    const auto name = [&](const std::string& text) {
      canvas_.text({left + legend_line + gap, y}, text, {.size = note_size, .down = Down::middle});
      y += legend_row;
    };
    for (std::size_t i = 0; i < plot_.series.size(); ++i) {
      const Series& s = plot_.series[i];
      if (s.name.empty()) continue;
      const Point line[] = {{left, y}, {left + legend_line, y}};
      if (s.line) canvas_.line(line, {colour_of(i), s.width, s.dash});
      draw_marker(canvas_, {left + legend_line / 2, y}, s.marker, s.marker_size, colour_of(i));
      name(s.name);
    }
    for (const Region& r : plot_.regions) {
      if (r.name.empty()) continue;
      canvas_.fill(Box{left + 2, y - 4, legend_line - 4, 8}, r.colour);
      name(r.name);
    }
  }

  void draw_notes(LabelPlaces& places) {
    for (const PointMark& mark : plot_.points) {
      if (!visible(mark.x, mark.y) || !frame_.box.grown(1).holds(frame_.at(mark.x, mark.y))) continue;
      draw_marker(canvas_, frame_.at(mark.x, mark.y), mark.marker, 5, mark.colour);
    }
    for (const PointMark& mark : plot_.points) {
      if (mark.label.empty() || !visible(mark.x, mark.y)) continue;
      const Point p = frame_.at(mark.x, mark.y);
      if (!frame_.box.grown(1).holds(p)) continue;
      const TextSize size = canvas_.measure(mark.label, {.size = note_size});
      const double w = size.width, h = size.height();
      std::vector<Box> candidates;
      for (const double off : {5.0, 10.0, 18.0, 30.0})
        for (const auto& [dx, dy] : {std::pair{1, -1}, {1, 1}, {-1, -1}, {-1, 1}, {1, 0}, {-1, 0}, {0, -1}, {0, 1}})
          candidates.push_back({p.x + (dx > 0   ? off
                                       : dx < 0 ? -off - w
                                                : -w / 2),
                                p.y + (dy > 0   ? off - 2
                                       : dy < 0 ? -off - h + 2
                                                : -h / 2),
                                w, h});
      put_note(mark.label, mark.colour, candidates, places);
    }
    for (const LineMark& line : plot_.lines) {
      const auto ends = ends_of(line);
      if (!ends || line.label.empty()) continue;
      const TextSize size = canvas_.measure(line.label, {.size = note_size});
      const double w = size.width, h = size.height();
      std::vector<Box> candidates;
      const auto& [a, b] = *ends;
      for (int i = 0; i <= 12; ++i) {
        const double t = i / 12.0;
        if (line.vertical)
          for (const double x : {a.x + 4, a.x - 4 - w})
            candidates.push_back({x, a.y + 4 + t * (b.y - a.y - 8 - h), w, h});
        else
          for (const double y : {a.y - h - 1, a.y + 2})
            candidates.push_back({b.x - 5 - w - t * (b.x - a.x - 10 - w), y, w, h});
      }
      put_note(line.label, line.colour, candidates, places);
    }
  }

  void put_note(const std::string& label, const Ink& colour, std::span<const Box> candidates, LabelPlaces& places) {
    const Box best = places.best(candidates);
    const TextSize size = canvas_.measure(label, {.size = note_size});
    const Ink dark = {0.75 * colour.r, 0.75 * colour.g, 0.75 * colour.b};
    canvas_.text({best.x, best.y + size.ascent}, label, {.size = note_size, .colour = dark, .halo = white.faded(0.8)});
    places.add_box(best);
  }

  const Plot& plot_;
  Canvas& canvas_;
  Box outer_;
  PlotFrame frame_;
  Range data_x_, data_y_;
  Ticks x_ticks_, y_ticks_;
  double tick_width_ = 0;
  int legend_rows_ = 0;
  double legend_width_ = 0, legend_height_ = 0;
  bool legend_outside_ = false;
};

} // namespace

Point PlotFrame::at(double px, double py) const {
  return {box.x + axis_place(px, x, x_scale) * box.width, box.bottom() - axis_place(py, y, y_scale) * box.height};
}

PlotFrame draw(const Plot& plot, Canvas& canvas, const Box& box) {
  return Drawing(plot, canvas, box).run();
}

void write_plot(const Plot& plot, const std::filesystem::path& path, double width, double height) {
  Canvas canvas(picture_format(path), width, height);
  AtomicFile file(path);
  draw(plot, canvas, {8, 6, width - 16, height - 12});
  canvas.write(file);
  file.commit();
}

} // namespace cowgpu::plot

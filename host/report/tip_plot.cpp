#include "host/report/tip_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace cowgpu {

plot::Plot tip_plot(const PushOutcome& outcome, const Monitor& monitor) {
  const PushRequest& plan = outcome.asked;
  const physics::Rocker& rocker = outcome.rocker;
  const double threshold = rocker.threshold();
  plot::Plot picture;
  picture.x = {.label = "force", .unit = "N", .scale = plot::Scale::logarithmic};
  picture.y = {.label = "duration", .unit = "s", .scale = plot::Scale::logarithmic};
  plot::Series boundary{.name = "just tips", .x = {}, .y = {}};
  plot::Series blow{.name = fmt::format("smallest impulse, {:.4g} N s", rocker.least_impulse()), .x = {}, .y = {}};
  blow.dash = plot::Dash::dotted;
  const double last = 3 * std::max(10 * threshold, plan.punch);
  for (double over = 1e-4; (1 + over) * threshold < last; over *= 1.08) boundary.x.push_back((1 + over) * threshold);
  boundary.x.push_back(last);
  for (const double force : boundary.x) {
    boundary.y.push_back(rocker.least_duration(force, monitor));
    blow.y.push_back(rocker.least_impulse() / force);
  }
  blow.x = boundary.x;
  plot::Region tips{.name = "tips over", .x = boundary.x, .low = boundary.y, .high = {}};
  tips.high.assign(boundary.x.size(), std::numeric_limits<double>::infinity());
  picture.regions = {tips};
  picture.series = {boundary, blow};
  picture.lines = {{true, threshold, fmt::format("threshold, {:.4g} N", threshold)},
                   {true, plan.sustained, plan.sustained_name + " sustained"}};
  picture.x.high = last;
  picture.x.low = 0.7 * std::min(threshold, plan.sustained);
  const double least = outcome.punch_least_duration;
  if (std::isfinite(least))
    picture.points = {{plan.punch, least, fmt::format("{} punch: {:.3g} s", plan.punch_name, least)}};
  if (plan.punch_duration)
    picture.points.push_back({plan.punch, *plan.punch_duration,
                              fmt::format("{} for {}", plan.punch_name, plan.punch_duration_name), plot::black,
                              plot::Marker::cross});
  return picture;
}

} // namespace cowgpu

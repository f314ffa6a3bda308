#include "host/report/potential_plot.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {
constexpr double farthest_shown = 100, least_shown = 1e-14;
}

plot::Plot series_errors_plot(const physics::SeriesErrors& errors, const std::string& title) {
  plot::Plot plot;
  plot.title = title;
  plot.x = {"distance", "Brillouin radii", plot::Scale::logarithmic, 1, farthest_shown};
  plot.y = {"largest error of potential or acceleration", "relative", plot::Scale::logarithmic};
  plot.y.low = least_shown;
  for (std::size_t i = 0; i < errors.good_from.size(); ++i) {
    plot::Series line;
    line.name = fmt::format("order {}", errors.good_from[i].order);
    // Beyond the first error at the level of rounding there is nothing but rounding.
    for (std::size_t k = 0; k < errors.ladder.size() && errors.ladder[k] <= farthest_shown * (1 + 1e-9); ++k) {
      line.x.push_back(errors.ladder[k]);
      line.y.push_back(errors.worst[i][k]);
      if (errors.worst[i][k] < least_shown) break;
    }
    line.dash = i % 2 ? plot::Dash::dashed : plot::Dash::solid; // 0 and 1 are alike about the centre of mass
    plot.series.push_back(line);
  }
  for (const double tolerance : physics::good_tolerances) plot.lines.push_back({false, tolerance, ""});
  return plot;
}

} // namespace cowgpu

#include "host/error.hpp"
#include "host/figures/figures.hpp"
#include "host/plot/plot.hpp"
#include "host/spectrum/power.hpp"

#include <iterator>

namespace cowgpu::figures {
namespace {

constexpr plot::Marker markers[] = {plot::Marker::disc, plot::Marker::square, plot::Marker::triangle,
                                    plot::Marker::diamond, plot::Marker::circle};
constexpr plot::Dash dashes[] = {plot::Dash::solid, plot::Dash::dashed, plot::Dash::dash_dot, plot::Dash::dotted};

/// Of degrees 1 and more. Markers only where there is room for them.
plot::Series curve(const std::string& name, const std::vector<double>& power, std::size_t number) {
  plot::Series series{name, {}, {}};
  for (std::size_t l = 1; l < power.size(); ++l) {
    series.x.push_back(double(l));
    series.y.push_back(power[l]);
  }
  series.dash = dashes[number % std::size(dashes)];
  if (power.size() <= 40) series.marker = markers[number % std::size(markers)];
  series.marker_size = 3.6;
  series.colour = plot::line_colour(number);
  return series;
}

plot::Plot panel(const std::string& title, const std::string& unit) {
  plot::Plot plot;
  plot.title = title;
  plot.x = {"degree $l$", "", plot::Scale::logarithmic};
  plot.y = {"power $S_l$", unit, plot::Scale::logarithmic};
  return plot;
}

} // namespace

plot::Canvas spectra_figure(plot::PictureFormat format, std::span<const NamedExpansion> expansions,
                            const Multipoles* mass, const std::string& unit) {
  std::vector<plot::Plot> plots;
  if (!expansions.empty()) {
    const std::string titles[] = {"radius $f_r$", "polar angle $f_{Δθ}$", "azimuth $f_{Δφ}$"};
    for (int field = 0; field < 3; ++field) {
      plot::Plot& plot = plots.emplace_back(panel(titles[field], field == 0 ? unit + "$^2$" : "rad$^2$"));
      if (field > 0) plot.legend = plot::LegendPlace::none; // that of the first panel
      for (std::size_t i = 0; i < expansions.size(); ++i)
        plot.series.push_back(curve(expansions[i].name, power(expansions[i].expansion->coefficients, field), i));
    }
  }
  if (mass) {
    std::vector<double> values;
    const double monopole = degree_norm(*mass, 0);
    for (int l = 0; l <= mass->lmax; ++l) {
      const double relative = degree_norm(*mass, l) / monopole;
      values.push_back(relative * relative);
    }
    plot::Plot& plot = plots.emplace_back(panel("mass moments", ""));
    plot.y.label = "$Σ_m |Q_{lm} / (Q_{00} R^l)|^2$";
    // About the centre of mass the dipole is 0 but for rounding.
    for (double& value : values)
      if (value < 1e-26) value = 0;
    plot.series.push_back(curve("", values, 6));
    plot.series.back().dash = plot::Dash::solid;
  }
  if (plots.empty()) throw Error(Fault::bad_argument, "there is no expansion to show the power of");
  constexpr double width = 310, height = 240;
  const std::size_t columns = plots.size() > 1 ? 2 : 1, rows = (plots.size() + columns - 1) / columns;
  plot::Canvas canvas(format, width * double(columns), height * double(rows));
  for (std::size_t i = 0; i < plots.size(); ++i)
    plot::draw(plots[i], canvas,
               {width * double(i % columns) + 8, height * double(i / columns) + 6, width - 16, height - 12});
  return canvas;
}

} // namespace cowgpu::figures

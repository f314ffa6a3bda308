// How good the multipoles are, as a picture.
#pragma once

#include "host/physics/potential.hpp"
#include "host/plot/plot.hpp"

#include <string>

namespace cowgpu {

/// Largest relative error by distance, a line for each order, to a hundred Brillouin radii; the tolerances as marks.
plot::Plot series_errors_plot(const physics::SeriesErrors& errors, const std::string& title);

} // namespace cowgpu

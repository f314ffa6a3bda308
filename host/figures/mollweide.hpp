// Mollweide's projection of the sphere: equal areas in an ellipse twice as wide as high.
#pragma once

#include "host/plot/plot.hpp"
#include "host/sphere_grid.hpp"

#include <span>

namespace cowgpu::figures {

/// Where a direction lies, x from -2 to 2 (phi from -180 to 180 degrees) and y from -1 to 1 (theta from 180 to 0):
/// 2 t + sin 2 t = pi sin(latitude), y = sin t, x = 2 phi / pi cos t.
struct MapPoint {
  double x = 0, y = 0;
};
MapPoint mollweide(double theta, double phi);

/// The direction there; false outside the ellipse.
bool from_mollweide(const MapPoint& at, double& theta, double& phi);

/// Values on a Clenshaw-Curtis grid ([ring][longitude]), interpolated linearly in theta and phi, in colours of the range, with
/// meridians and parallels every 30 degrees and some of their numbers, into a box twice as wide as high. PNG pages.
void draw_mollweide(plot::Canvas& canvas, const plot::Box& box, const SphereGrid& grid, std::span<const double> values,
                    const plot::Range& range);

} // namespace cowgpu::figures

#include "host/physics/potential.hpp"

#include "host/error.hpp"
#include "host/physics/polyhedron.hpp"
#include "host/physics/tensors.hpp"
#include "host/spectrum/convert.hpp"
#include "host/spectrum/verify.hpp"
#include "host/sphere_directions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cowgpu::physics {
namespace {

constexpr int grid_degree = 12;
constexpr int least_truth_degree = 40;
constexpr double truth_from = 10; // radii: a series to degree 40 ends 1e-41 below the first term
constexpr int steps_per_decade = 16;

// A sphere of directions with the weights of their parts, which add up to 1.
struct Directions {
  std::vector<Vec3> to;
  std::vector<double> weights;
};

Directions directions() {
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, grid_degree);
  const SphereDirections at(grid);
  Directions all;
  for (int i = 0; i < grid.rings; ++i)
    for (int j = 0; j < grid.ring_length; ++j) {
      all.to.push_back(at(i, j));
      all.weights.push_back(grid.weights[std::size_t(i)] / (2 * grid.ring_length));
    }
  return all;
}

// Progress of one of several steps.
class StepMonitor final : public Monitor {
public:
  StepMonitor(Monitor& outer, double first, double part) : outer_(outer), first_(first), part_(part) {}
  void progress(const char*, double fraction) override {
    outer_.progress("errors of the series", std::min(1.0, first_ + part_ * fraction));
  }
  bool stopped() const override { return outer_.stopped(); }

private:
  Monitor& outer_;
  double first_, part_;
};

class Comparison {
public:
  Comparison(const Body& body, Backend& backend, unsigned threads, Monitor& monitor, int lmax, double steps)
      : body_(body), backend_(backend), threads_(threads), monitor_(monitor), all_(directions()), steps_(steps),
        moments_(cowgpu::mass_moments(mass_problems(body, lmax, default_cut_off), backend, monitor)) {}

  std::size_t count() const { return all_.to.size(); }

  PotentialField exact(double distance) {
    StepMonitor step(monitor_, std::min(1.0, done_ / steps_), 1 / steps_);
    done_ += 1;
    std::vector<Vec3> points = relative(distance);
    for (Vec3& p : points) p += body_.origin;
    return exact_field(body_, points, Derivatives::first, threads_, step).field;
  }

  // The polyhedron loses digits like the square of the distance.
  PotentialField truth(double distance) {
    return distance <= truth_from ? exact(distance) : series(distance, moments_.lmax);
  }

  PotentialField series(double distance, int order) {
    StepMonitor step(monitor_, std::min(1.0, done_ / steps_), 0);
    return backend_.potential({moments_, relative(distance), order, Derivatives::first}, step);
  }

  SeriesError error(double distance, int order, const PotentialField& truth) {
    const PotentialField found = series(distance, order);
    SeriesError e{distance, order};
    for (std::size_t i = 0; i < count(); ++i) {
      const double v = std::abs(found.value[i] - truth.value[i]) / std::abs(truth.value[i]);
      const double g = (found.gradient[i] - truth.gradient[i]).norm() / truth.gradient[i].norm();
      e.potential_max = std::max(e.potential_max, v);
      e.acceleration_max = std::max(e.acceleration_max, g);
      e.potential_rms += all_.weights[i] * v * v;
      e.acceleration_rms += all_.weights[i] * g * g;
    }
    e.potential_rms = std::sqrt(e.potential_rms);
    e.acceleration_rms = std::sqrt(e.acceleration_rms);
    return e;
  }

private:
  std::vector<Vec3> relative(double distance) const {
    std::vector<Vec3> points = all_.to;
    for (Vec3& p : points) p *= distance * body_.brillouin_radius;
    return points;
  }

  const Body& body_;
  Backend& backend_;
  unsigned threads_;
  Monitor& monitor_;
  Directions all_;
  double steps_, done_ = 0;
  Coefficients moments_;
};

// From the far end inwards: where the error first rises above the tolerance, and between there and the distance before by a
// power law.
std::optional<double> good_from(const std::vector<double>& distances, const std::vector<double>& errors,
                                double tolerance) {
  std::size_t i = distances.size();
  while (i > 0 && errors[i - 1] <= tolerance) --i;
  if (i == distances.size()) return {};
  if (i == 0) return distances[0];
  const double slope = std::log(errors[i] / errors[i - 1]) / std::log(distances[i] / distances[i - 1]);
  if (!(slope < 0) || !std::isfinite(slope)) return distances[i];
  return distances[i - 1] * std::exp(std::log(tolerance / errors[i - 1]) / slope);
}

} // namespace

Coefficients mass_moments(const CoefficientSet& set, int lmax) {
  check_mass_multipoles(set);
  ConversionTarget target;
  target.kind = CoefficientKind::multipoles;
  target.lmax = std::min(lmax, set.lmax);
  const CoefficientSet low = converted(set, target);
  if (!low.reference_radius || !(*low.reference_radius > 0))
    throw Error(Fault::file_format, "these coefficients do not say their reference radius");
  const SphereCoefficients q = orthonormal(low);
  Coefficients moments;
  moments.lmax = low.lmax;
  moments.origin = set.origin.value_or(Vec3::Zero());
  moments.reference_radius = *low.reference_radius;
  moments.density = set.density.value_or(1);
  moments.values.resize(Coefficients::count(low.lmax));
  for (int l = 0; l <= low.lmax; ++l)
    for (int m = 0; m <= l; ++m) moments.values[Coefficients::index(l, m)] = q.at(0, l, m);
  return moments;
}

Coefficients in_si(Coefficients moments, double metres, double kilograms) {
  moments.origin *= metres;
  moments.reference_radius *= metres;
  for (auto& q : moments.values) q *= kilograms;
  return moments;
}

SeriesErrors series_errors(const Body& body, const std::vector<int>& orders, const std::vector<double>& distances,
                           Backend& backend, unsigned threads, Monitor& monitor) {
  if (orders.empty() || distances.empty())
    throw Error(Fault::bad_argument, "errors of a series: at least one order and one distance are needed");
  for (const double d : distances)
    if (!(d >= 1) || !(d <= farthest_good))
      throw Error(Fault::bad_argument,
                  fmt::format("a distance of {} Brillouin radii: the series is for 1 to {}", d, farthest_good));
  const int highest = *std::max_element(orders.begin(), orders.end());
  SeriesErrors result;
  result.truth_degree = std::max(least_truth_degree, highest);
  result.truth_from = truth_from;
  Comparison comparison(body, backend, threads, monitor, result.truth_degree,
                        double(distances.size()) + steps_per_decade + 1);
  result.directions = comparison.count();
  for (const double d : distances) {
    const PotentialField truth = comparison.truth(d);
    for (const int order : orders) result.rows.push_back(comparison.error(d, order, truth));
  }

  std::vector<double>& ladder = result.ladder;
  const int steps = int(std::lround(std::log10(farthest_good))) * steps_per_decade;
  for (int k = 0; k <= steps; ++k)
    ladder.push_back(k == steps_per_decade ? truth_from : std::pow(10.0, double(k) / steps_per_decade));
  std::vector<std::vector<double>>& errors = result.worst;
  errors.resize(orders.size());
  for (int k = 0; k <= steps; ++k) {
    const double d = ladder[std::size_t(k)];
    check_stop(monitor);
    const PotentialField truth = comparison.truth(d);
    if (k == steps_per_decade) {
      const SeriesError e = comparison.error(d, result.truth_degree, truth);
      result.truth_error = std::max(e.potential_max, e.acceleration_max);
    }
    for (std::size_t i = 0; i < orders.size(); ++i) {
      const SeriesError e = comparison.error(d, orders[i], truth);
      errors[i].push_back(std::max(e.potential_max, e.acceleration_max));
    }
  }
  for (std::size_t i = 0; i < orders.size(); ++i) {
    GoodFrom good{orders[i], {}};
    for (std::size_t t = 0; t < good_tolerances.size(); ++t)
      good.distance[t] = good_from(ladder, errors[i], good_tolerances[t]);
    result.good_from.push_back(good);
  }
  return result;
}

} // namespace cowgpu::physics

#include "host/error.hpp"
#include "host/mass/mass_moments.hpp"
#include "host/parallel.hpp"
#include "host/physics/body_field.hpp"
#include "host/physics/potential.hpp"
#include "host/physics/potential_terms.hpp"
#include "host/sphere_directions.hpp"
#include "host/sphere_transform.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

namespace cowgpu::physics {
namespace {

constexpr int mean_degree = 12; // degree of the grid for root mean squares
constexpr int steps_per_decade = 16;
constexpr int usual_truth_degree = 256;
constexpr int largest_scan_degree = 256;
constexpr int scanned_degrees = 96; // at most, beyond the order
constexpr int points_per_wave = 6;  // points per wave of the highest degree, along the rings of a scan
constexpr std::size_t axis_ends = 6;
constexpr std::size_t outermost = 64;  // vertices whose directions are tried
constexpr double vertices_matter = 2;  // radii: farther out peaks over vertices are as wide as the scan sees
constexpr double worth_climbing = 0.7; // part of the highest point of a scan

double truth_begins() {
  return std::pow(10.0, 1.0 / steps_per_decade); // 1.15^-257 is 1e-16
}

// Relative errors of one order at one direction: of V, of its gradient.
using Errors = std::array<double, 2>;

double quotient(double a, double b) {
  return a == 0 ? 0 : a / b;
}

struct Peak {
  Vec3 to = Vec3::UnitZ();
  double error = 0;
  double step = 0; // radians
};

using BothPeaks = std::array<std::vector<Peak>, 2>;

void keep_best(std::vector<Peak>& peaks, std::size_t most) {
  std::stable_sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.error > b.error; });
  // Mirror images of symmetric bodies are as high to rounding, and one stands for all.
  std::vector<Peak> kept;
  for (const Peak& peak : peaks) {
    if (kept.size() == most || peak.error < worth_climbing * peaks.front().error) break;
    const bool image = !kept.empty() && peak.error > kept.back().error * (1 - 1e-9);
    if (!image) kept.push_back(peak);
  }
  peaks = std::move(kept);
}

class ErrorSearch {
public:
  ErrorSearch(const Body& body, Backend& backend, unsigned threads, Monitor& monitor, int truth_degree)
      : body_(body), threads_(threads), monitor_(monitor),
        terms_(cowgpu::mass_moments(mass_problems(body, truth_degree, default_cut_off), backend, monitor)) {
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, mean_degree);
    const SphereDirections to(grid);
    for (int i = 0; i < grid.rings; ++i)
      for (int j = 0; j < grid.ring_length; ++j) {
        mean_.push_back(to(i, j));
        weights_.push_back(grid.weights[std::size_t(i)] / (2 * grid.ring_length));
      }
    marked_ = {Vec3::UnitX(), -Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitY(), Vec3::UnitZ(), -Vec3::UnitZ()};
    add_vertices();
  }

  std::size_t mean_directions() const { return mean_.size(); }

  // All orders at a distance; the polyhedron is the truth where the series to its highest degree is not.
  std::vector<SeriesError> at(double d, const std::vector<int>& orders) {
    const bool exact = d < truth_begins();
    std::vector<Vec3> to = mean_;
    for (const int order : orders)
      for (const std::vector<Peak>& peaks : climbed(d, order, exact))
        for (const Peak& peak : peaks) to.push_back(peak.to);
    if (exact) to.insert(to.end(), marked_.begin(), marked_.end());
    const std::vector<Errors> errors =
        exact ? against_polyhedron(to, d, orders) : by_series(to, d, orders, terms_.lmax());
    std::vector<SeriesError> rows;
    for (std::size_t o = 0; o < orders.size(); ++o) {
      const auto error = [&](std::size_t i, std::size_t which) { return errors[i * orders.size() + o][which]; };
      std::array<double, 2> most{}, mean{};
      for (std::size_t which = 0; which < 2; ++which) {
        Peak best;
        for (std::size_t i = 0; i < to.size(); ++i)
          if (error(i, which) > best.error) best = {to[i], error(i, which), 0};
        for (std::size_t i = 0; i < mean_.size(); ++i) mean[which] += weights_[i] * error(i, which) * error(i, which);
        if (exact) polish(d, orders[o], which, best);
        most[which] = best.error;
      }
      rows.push_back({d, orders[o], most[0], std::sqrt(mean[0]), most[1], std::sqrt(mean[1])});
    }
    return rows;
  }

  // The larger of both errors of one order, by series.
  double worst(double d, int order) {
    double worst = 0;
    for (const std::vector<Peak>& peaks : climbed(d, order))
      for (const Peak& peak : peaks) worst = std::max(worst, peak.error);
    return worst;
  }

  // How far the series to its highest degree is off the polyhedron at a distance, over the grid of the mean.
  double truth_error(double d) {
    const int order = terms_.lmax();
    double worst = 0;
    for (const Errors& e : against_polyhedron(mean_, d, std::span(&order, 1))) worst = std::max({worst, e[0], e[1]});
    return worst;
  }

private:
  void add_vertices() {
    std::vector<std::pair<double, Vec3>> all;
    const auto add = [&](const ClosedSurface& surface) {
      for (const Face& face : surface.faces())
        for (const std::uint32_t corner : face) {
          const Vec3 from = surface.vertices()[corner] - body_.origin;
          if (const double r = from.norm(); r > 0) all.emplace_back(-r, from / r);
        }
    };
    add(body_.surface);
    for (const Part& part : body_.parts) add(part.surface);
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
      return a.first != b.first
                 ? a.first < b.first
                 : std::lexicographical_compare(a.second.begin(), a.second.end(), b.second.begin(), b.second.end());
    });
    const std::size_t most = axis_ends + outermost;
    for (const auto& [r, to] : all)
      if (marked_.size() < most && to != marked_.back()) marked_.push_back(to);
  }

  // Up to which degree terms count beside those of degree `order` + 1, which fall like d^-l.
  int needed(double d, int order) const {
    const double more = d > 1 ? std::ceil(14 / std::log(d)) : usual_truth_degree;
    return std::min(terms_.lmax(), order + 1 + int(std::clamp(more, 8.0, double(usual_truth_degree))));
  }

  std::vector<Errors> evaluated(std::span<const Vec3> to, double d, std::span<const int> orders,
                                const PotentialField* truth, int most) {
    const int lmax = truth ? *std::max_element(orders.begin(), orders.end())
                           : std::min(most, needed(d, *std::max_element(orders.begin(), orders.end())));
    std::vector<Errors> errors(to.size() * orders.size());
    constexpr std::size_t group = PotentialTerms::group;
    const double radius = body_.brillouin_radius;
    // Small work is done before another thread has woken.
    const bool small = double(to.size()) * lmax * lmax < 1e6;
    parallel_for(small ? 1 : threads_, (to.size() + group - 1) / group, [&](std::size_t task, unsigned) {
      check_stop(monitor_);
      const std::size_t begin = task * group, count = std::min(group, to.size() - begin);
      std::array<Vec3, group> points;
      for (std::size_t p = 0; p < count; ++p) points[p] = to[begin + p] * d;
      std::vector<DegreeTerm> terms;
      terms_.at(std::span(points).first(count), lmax, terms);
      for (std::size_t p = 0; p < count; ++p) {
        const auto sum = [&](int first, int last) {
          DegreeTerm all;
          for (int l = last; l >= first; --l) { // small ones first
            all.value += terms[std::size_t(l) * group + p].value;
            all.gradient += terms[std::size_t(l) * group + p].gradient;
          }
          return all;
        };
        DegreeTerm whole;
        if (truth)
          whole = {truth->value[begin + p] * radius, truth->gradient[begin + p] * radius * radius};
        else
          whole = sum(0, lmax);
        for (std::size_t o = 0; o < orders.size(); ++o) {
          DegreeTerm rest = truth ? sum(0, orders[o]) : sum(orders[o] + 1, lmax);
          if (truth) rest = {rest.value - whole.value, rest.gradient - whole.gradient};
          errors[(begin + p) * orders.size() + o] = {quotient(std::abs(rest.value), std::abs(whole.value)),
                                                     quotient(rest.gradient.norm(), whole.gradient.norm())};
        }
      }
    });
    return errors;
  }

  std::vector<Errors> by_series(std::span<const Vec3> to, double d, std::span<const int> orders, int most) {
    return evaluated(to, d, orders, nullptr, most);
  }

  std::vector<Errors> against_polyhedron(std::span<const Vec3> to, double d, std::span<const int> orders) {
    std::vector<Vec3> points;
    for (const Vec3& n : to) points.emplace_back(body_.origin + n * (d * body_.brillouin_radius));
    struct Stops final : Monitor {
      explicit Stops(const Monitor& m) : outer(m) {}
      bool stopped() const override { return outer.stopped(); }
      const Monitor& outer;
    } stops(monitor_);
    const PotentialField truth = exact_field(body_, points, Derivatives::first, threads_, stops).field;
    return evaluated(to, d, orders, &truth, terms_.lmax());
  }

  // Local maxima over a grid that is fine enough for the degrees that count, by one synthesis.
  BothPeaks scanned(double d, int order) {
    BothPeaks peaks;
    const int top = std::min(terms_.lmax(), needed(d, order));
    const int most = std::min({top, largest_scan_degree, order + 1 + scanned_degrees});
    if (most <= order) return peaks;
    const int lmax = most + 1, grid_degree = (points_per_wave * lmax / 2 + 15) / 16 * 16;
    std::unique_ptr<SphereTransform>& transform = transforms_[grid_degree];
    if (!transform)
      transform = make_cpu_backend(grid_degree < 100 ? 1 : threads_)
                      ->sphere_transform(make_grid(GridKind::gauss_legendre, grid_degree), grid_degree);
    const SphereGrid& grid = transform->grid();
    const std::size_t points = grid.points();
    const auto synthesised = [&](int least) {
      const SphereCoefficients small = terms_.on_sphere(d, least, most);
      SphereCoefficients fields(grid_degree, 4);
      for (int f = 0; f < 4; ++f)
        for (int m = 0; m <= lmax; ++m)
          for (int l = m; l <= lmax; ++l) fields.at(f, l, m) = small.at(f, l, m);
      std::vector<double> values(4 * points);
      Monitor silent;
      transform->synthesise(4, fields.values, values, silent);
      return values;
    };
    const std::vector<double> rest = synthesised(order + 1), all = synthesised(0);
    std::array<std::vector<double>, 2> errors = {std::vector<double>(points), std::vector<double>(points)};
    for (std::size_t i = 0; i < points; ++i) {
      const auto gradient = [&](const std::vector<double>& f) {
        return Vec3(f[points + i], f[2 * points + i], f[3 * points + i]).norm();
      };
      errors[0][i] = quotient(std::abs(rest[i]), std::abs(all[i]));
      errors[1][i] = quotient(gradient(rest), gradient(all));
    }
    for (std::size_t which = 0; which < 2; ++which) peaks[which] = peaks_of(errors[which], grid);
    return peaks;
  }

  static std::vector<Peak> peaks_of(const std::vector<double>& errors, const SphereGrid& grid) {
    std::vector<Peak> peaks;
    const double highest = *std::max_element(errors.begin(), errors.end());
    const SphereDirections to(grid);
    const int length = grid.ring_length;
    for (int i = 0; i < grid.rings; ++i)
      for (int j = 0; j < length; ++j) {
        const double here = errors[std::size_t(i) * std::size_t(length) + std::size_t(j)];
        if (here < worth_climbing * highest) continue;
        bool peak = true;
        for (int a = std::max(0, i - 1); a <= std::min(grid.rings - 1, i + 1); ++a)
          for (int b = j - 1; b <= j + 1; ++b) {
            const int column = (b + length) % length;
            peak = peak && errors[std::size_t(a) * std::size_t(length) + std::size_t(column)] <= here;
          }
        if (peak) peaks.push_back({to(i, j), here, 0});
      }
    return peaks;
  }

  // Local maxima of both errors of one order by series, from the best starts there are. As starts of a search with another truth
  // they need no more degrees than a scan has.
  BothPeaks climbed(double d, int order, bool starts_only = false) {
    const std::span orders(&order, 1);
    const bool near = d < vertices_matter;
    BothPeaks peaks = scanned(d, order);
    std::vector<Vec3> starts;
    for (std::vector<Peak>& some : peaks) {
      keep_best(some, near ? 8 : 4);
      for (const Peak& peak : some) starts.push_back(peak.to);
    }
    starts.insert(starts.end(), marked_.begin(), near ? marked_.end() : marked_.begin() + axis_ends);
    if (const auto last = last_.find(order); last != last_.end())
      starts.insert(starts.end(), last->second.begin(), last->second.end());
    const int most = starts_only ? order + 1 + scanned_degrees : terms_.lmax();
    const std::vector<Errors> errors = by_series(starts, d, orders, most);
    for (std::size_t which = 0; which < 2; ++which) {
      std::vector<Peak>& some = peaks[which];
      some.clear();
      const double step = 1.5 / (std::min(needed(d, order), largest_scan_degree) + 1);
      for (std::size_t i = 0; i < starts.size(); ++i) some.push_back({starts[i], errors[i][which], step});
      keep_best(some, near ? 8 : 4);
      climb(
          some, step / 128, [&](std::span<const Vec3> to) { return by_series(to, d, orders, most); }, which);
      const auto best =
          std::max_element(some.begin(), some.end(), [](const Peak& a, const Peak& b) { return a.error < b.error; });
      if (best != some.end()) last_[order][which] = best->to;
    }
    return peaks;
  }

  void polish(double d, int order, std::size_t which, Peak& best) {
    const std::span orders(&order, 1);
    std::vector<Peak> peaks = {best};
    peaks[0].step = 0.1 / (std::min(terms_.lmax(), 4 * order + 16));
    climb(
        peaks, peaks[0].step / 16, [&](std::span<const Vec3> to) { return against_polyhedron(to, d, orders); }, which);
    best = peaks[0];
  }

  // Six neighbours at a time, at shrinking distances, until the step is below `end`.
  template <class Evaluate>
  static void climb(std::vector<Peak>& peaks, double end, const Evaluate& evaluate, std::size_t which) {
    constexpr int neighbours = 6;
    for (int round = 0; round < 60; ++round) {
      std::vector<Vec3> to;
      std::vector<std::size_t> whose;
      for (std::size_t k = 0; k < peaks.size(); ++k) {
        if (peaks[k].step < end) continue;
        const Vec3 across = peaks[k].to.unitOrthogonal(), other = peaks[k].to.cross(across);
        for (int n = 0; n < neighbours; ++n) {
          const double angle = (n + 0.5 * (round % 2)) * (2 * std::numbers::pi / neighbours), h = peaks[k].step;
          to.push_back((peaks[k].to * std::cos(h) + (across * std::cos(angle) + other * std::sin(angle)) * std::sin(h))
                           .normalized());
          whose.push_back(k);
        }
      }
      if (to.empty()) return;
      const std::vector<Errors> errors = evaluate(to);
      std::vector<char> moved(peaks.size(), 0);
      for (std::size_t i = 0; i < to.size(); ++i)
        if (Peak& peak = peaks[whose[i]]; errors[i][which] > peak.error) {
          peak.to = to[i];
          peak.error = errors[i][which];
          moved[whose[i]] = 1;
        }
      for (std::size_t k = 0; k < peaks.size(); ++k)
        if (!moved[k]) peaks[k].step /= 2;
    }
  }

  const Body& body_;
  unsigned threads_;
  Monitor& monitor_;
  PotentialTerms terms_;
  std::vector<Vec3> mean_, marked_; // the grid of the mean; the axes and the outermost vertices
  std::vector<double> weights_;
  std::map<int, std::unique_ptr<SphereTransform>> transforms_;
  std::map<int, std::array<Vec3, 2>> last_; // best directions of the search before, by order
};

// From the far end inwards: where the error first rises above the tolerance. In between two distances of the ladder by the
// secant of logarithms, from outside, so that the tolerance holds where it ends.
std::optional<double> good_from(ErrorSearch& search, int order, const std::vector<double>& ladder,
                                const std::vector<double>& errors, double tolerance, int truth_degree) {
  std::size_t i = ladder.size();
  while (i > 0 && errors[i - 1] <= tolerance) --i;
  if (i == ladder.size()) return {};
  if (i == 0) return ladder[0];
  double low = ladder[i - 1], high = ladder[i], above = errors[i - 1], below = errors[i];
  for (int k = 0; k < 12 && below < 0.995 * tolerance && high / low > 1 + 1e-6; ++k) {
    double part = below > 0 ? std::log(above / (0.998 * tolerance)) / std::log(above / below) : 0.5;
    part = std::clamp(part, 0.02, 0.98);
    const double d = low * std::pow(high / low, part);
    // Next to the sphere the series is no truth where its last degrees have not fallen far below the tolerance.
    if (d < truth_begins() && search.worst(d, truth_degree * 3 / 4) > 1e-3 * tolerance) break;
    const double error = search.worst(d, order);
    if (error <= tolerance) {
      high = d;
      below = error;
    } else {
      low = d;
      above = error;
    }
  }
  return high;
}

} // namespace

SeriesErrors series_errors(const Body& body, const std::vector<int>& orders, const std::vector<double>& distances,
                           Backend& backend, unsigned threads, Monitor& monitor) {
  if (orders.empty() || distances.empty())
    throw Error(Fault::bad_argument, "errors of a series need at least one order and one distance");
  for (const double d : distances)
    if (!(d >= 1) || !(d <= farthest_good))
      throw Error(
          Fault::bad_argument,
          fmt::format("a distance of {} Brillouin radii is out of range: the series is for 1 to {}", d, farthest_good));
  const int highest = *std::max_element(orders.begin(), orders.end());
  SeriesErrors result;
  result.truth_degree = std::min(largest_potential_degree, std::max(usual_truth_degree, highest));
  result.truth_from = truth_begins();
  ErrorSearch search(body, backend, threads, monitor, result.truth_degree);
  result.directions = search.mean_directions();
  std::vector<double>& ladder = result.ladder;
  const int steps = int(std::lround(std::log10(farthest_good))) * steps_per_decade;
  for (int k = 0; k <= steps; ++k) ladder.push_back(k == 0 ? 1 : std::pow(10.0, double(k) / steps_per_decade));
  double done = 0;
  const auto step = [&](double part) {
    done += part;
    check_stop(monitor);
    monitor.progress("errors of the series", std::min(1.0, done / (double(distances.size() + ladder.size()) + 10)));
  };
  std::map<double, std::vector<SeriesError>> known;
  const auto errors_at = [&](double d) -> const std::vector<SeriesError>& {
    step(1);
    auto found = known.find(d);
    if (found == known.end()) found = known.emplace(d, search.at(d, orders)).first;
    return found->second;
  };
  // From the far end, where errors are smooth, inwards: each search starts where the one before ended.
  result.worst.assign(orders.size(), std::vector<double>(ladder.size()));
  for (std::size_t k = ladder.size(); k-- > 0;) {
    const std::vector<SeriesError>& errors = errors_at(ladder[k]);
    for (std::size_t o = 0; o < orders.size(); ++o)
      result.worst[o][k] = std::max(errors[o].potential_max, errors[o].acceleration_max);
  }
  for (const double d : distances) {
    const std::vector<SeriesError>& errors = errors_at(d);
    result.rows.insert(result.rows.end(), errors.begin(), errors.end());
  }
  result.truth_error = search.truth_error(result.truth_from);
  for (std::size_t i = 0; i < orders.size(); ++i) {
    GoodFrom good{orders[i], {}};
    for (std::size_t t = 0; t < good_tolerances.size(); ++t) {
      good.distance[t] = good_from(search, orders[i], ladder, result.worst[i], good_tolerances[t], result.truth_degree);
      step(10.0 / double(good_tolerances.size() * orders.size()));
    }
    result.good_from.push_back(good);
  }
  return result;
}

} // namespace cowgpu::physics

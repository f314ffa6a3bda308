#include "host/physics/equilibria.hpp"

#include "host/error.hpp"
#include "host/physics/equilibrium_bounds.hpp"
#include "host/physics/equilibrium_cells.hpp"
#include "host/physics/equilibrium_newton.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

namespace cowgpu::physics {
namespace {

constexpr std::size_t batch = 32768;     // places whose field is computed together
constexpr std::size_t most_starts = 256; // of Newton's method, a level of cells
constexpr double rounding = 1e-13;       // of the field, in G M/R^2 and G M/R^3
// Second derivatives of a sum to a tolerance are right to so many times it, in G M/R^3: up to 90 times was measured, on the faces
// of a cow; 27 beside asteroids, plates, needles, shells and a star-shaped body, to a thickness of 1e-6.
constexpr double tensor_tolerance = 400;

double ball_radius(const Body& body) {
  return std::cbrt(std::abs(body.volume) * 3 / (4 * std::numbers::pi));
}

// No place has more: surfaces whose boxes are apart do not add up.
double largest_density(const Body& body, int winding) {
  const auto box_of = [](const ClosedSurface& surface) { return bounding_box(surface.vertices(), surface.faces()); };
  std::vector<std::pair<Box, double>> pieces = {{box_of(body.surface), body.density}};
  for (const Part& part : body.parts) pieces.emplace_back(box_of(part.surface), part.density);
  double most = 0;
  for (const auto& [box, density] : pieces) {
    double sum = 0;
    for (const auto& [other, added] : pieces)
      if ((box.min.array() <= other.max.array()).all() && (other.min.array() <= box.max.array()).all())
        sum += std::max(added, 0.0);
    most = std::max(most, sum);
  }
  return most * winding;
}

class Search {
public:
  Search(const Body& body, const EquilibriaProblem& problem, const Backend& backend, Monitor& monitor)
      : body_(body), problem_(problem), monitor_(monitor), frame_(body, problem.spin),
        field_(body, problem.constant, problem.spin, problem.tolerance, backend),
        newton_(body, problem.constant, problem.spin, backend) {
    radius_ = ball_radius(body);
    const double pull = problem.constant * body.mass();
    bounds_ = {problem.constant * largest_density(body, 1), pull, frame_.box_low(), frame_.box_high()};
    nothing_ = 1e-6 * std::abs(body.density);
    found_.low = frame_.low;
    found_.high = frame_.high;
    found_.farthest = farthest(pull);
    found_.smallest_cell = problem.smallest * radius_;
    const double part = std::max(problem.tolerance, rounding);
    slack_ = part * pull / (radius_ * radius_);
    tensor_slack_ = tensor_tolerance * part * pull / (radius_ * radius_ * radius_);
  }

  Equilibria run() {
    std::vector<Cell> cells = {whole()};
    std::vector<Cell> undecided;
    for (int level = 0; !cells.empty(); ++level) {
      check_stop(monitor_);
      std::vector<Cell> left = look_at(cells);
      std::erase_if(left, [&](const Cell& cell) { return done(cell); });
      cells.clear();
      for (const Cell& cell : left)
        if (cell.half.norm() <= found_.smallest_cell)
          undecided.push_back(cell);
        else
          cut(cell, cells);
      std::erase_if(cells, [&](const Cell& cell) { return done(cell) || beyond(cell); });
      if (found_.places + cells.size() > problem_.most_places) {
        found_.exhausted = true;
        undecided.insert(undecided.end(), cells.begin(), cells.end());
        break;
      }
      monitor_.progress("looking for equilibria", 1 - std::pow(0.9, level));
    }
    finish(undecided);
    return std::move(found_);
  }

private:
  // Where w^2 r (r - b)^2 = G M.
  double farthest(double pull) const {
    const double square = problem_.spin.rate * problem_.spin.rate, b = frame_.reach;
    if (!(square > 0)) return b;
    double low = b, high = b + 2 * std::cbrt(pull / square) + radius_;
    for (int i = 0; i < 200; ++i) {
      const double r = (low + high) / 2;
      (square * r * (r - b) * (r - b) < pull ? low : high) = r;
    }
    return high * (1 + 1e-9);
  }

  Cell whole() const {
    const double r = found_.farthest, middle = (found_.low + found_.high) / 2;
    return {Vec3(0, 0, middle), Vec3(r, r, (found_.high - found_.low) / 2 * (1 + 1e-9))};
  }

  bool beyond(const Cell& cell) const {
    const double x = std::max(std::abs(cell.centre[0]) - cell.half[0], 0.0),
                 y = std::max(std::abs(cell.centre[1]) - cell.half[1], 0.0);
    return std::hypot(x, y) > found_.farthest;
  }

  // Within a ball where the only equilibrium is known.
  bool done(const Cell& cell) const {
    return std::any_of(found_.points.begin(), found_.points.end(), [&](const Equilibrium& e) {
      return ((frame_.inward(e.at) - cell.centre).cwiseAbs() + cell.half).norm() <= e.alone_within;
    });
  }

  // Those that are not excluded. New equilibria go to the list.
  std::vector<Cell> look_at(const std::vector<Cell>& cells) {
    std::vector<Cell> left;
    std::vector<Start> starts;
    for (std::size_t begin = 0; begin < cells.size(); begin += batch) {
      check_stop(monitor_);
      const std::size_t end = std::min(cells.size(), begin + batch);
      std::vector<Vec3> points;
      for (std::size_t i = begin; i < end; ++i) points.push_back(frame_.outward(cells[i].centre));
      const SpinningValues values = field_.at(points, true, monitor_);
      check_densities(values, points);
      found_.places += points.size();
      if (values.largest_winding > found_.largest_winding) {
        found_.largest_winding = values.largest_winding;
        bounds_ = {problem_.constant * largest_density(body_, found_.largest_winding), problem_.constant * body_.mass(),
                   frame_.box_low(), frame_.box_high()};
      }
      for (std::size_t i = begin; i < end; ++i) judge(cells[i], values, i - begin, left, starts);
    }
    // The same number from everywhere, where there are too many.
    const std::size_t stride = starts.size() / most_starts + 1;
    std::vector<Start> some;
    for (std::size_t i = 0; i < starts.size(); i += stride) some.push_back(starts[i]);
    add(newton_.from(some, monitor_));
    return left;
  }

  void judge(const Cell& cell, const SpinningValues& values, std::size_t i, std::vector<Cell>& left,
             std::vector<Start>& starts) {
    const double h = cell.half.norm(), depth = values.depth[i];
    const Vec3 a = frame_.turned(values.acceleration[i]);
    const Eigen::Matrix3d gradient = frame_.turned(values.gradient[i]);
    // Half of the largest density, in a ball about the place.
    Eigen::Matrix3d known = -2 * std::numbers::pi / 3 * bounds_.density() * Eigen::Matrix3d::Identity();
    const double square = problem_.spin.rate * problem_.spin.rate;
    known(0, 0) += square;
    known(1, 1) += square;
    if (least_over_box(a, known, cell.half) > bounds_.change(frame_.farthest_vertex(cell.centre), h) + slack_) return;
    const bool smooth = !values.on_edge[i] && depth > 0;
    if (smooth &&
        least_over_box(a, gradient, cell.half) >
            bounds_.remainder(cell.centre, depth, values.density[i] < nothing_, h) + slack_ + tensor_slack_ * h)
      return;
    left.push_back(cell);
    if (!smooth) return;
    const Vec3 step = gradient.partialPivLu().solve(a);
    if (step.allFinite() && step.norm() <= 2 * h) starts.push_back({frame_.outward(cell.centre), 4 * h});
  }

  void check_densities(const SpinningValues& values, std::span<const Vec3> points) const {
    for (std::size_t i = 0; i < points.size(); ++i)
      if (values.density[i] < -1e-6 * std::abs(body_.density))
        throw Error(Fault::bad_argument,
                    fmt::format("at ({:.6g}, {:.6g}, {:.6g}) the body's density is {:.6g}: the search for equilibria "
                                "rests on densities of 0 or more; a --part may not dig more than there is",
                                points[i][0], points[i][1], points[i][2], values.density[i]));
  }

  void add(std::vector<Equilibrium> more) {
    for (Equilibrium& e : more) {
      const Vec3 q = frame_.inward(e.at);
      if (std::hypot(q[0], q[1]) > found_.farthest || q[2] < found_.low || q[2] > found_.high) continue;
      const bool known = std::any_of(found_.points.begin(), found_.points.end(), [&](const Equilibrium& other) {
        return (other.at - e.at).norm() <= std::max(1e-7 * radius_, other.alone_within / 2);
      });
      if (known) continue;
      const double stiffness = e.motions.stiffness.cwiseAbs().minCoeff() - tensor_slack_;
      if (e.depth > 0 && stiffness > 0)
        e.alone_within = 0.999 * bounds_.injective_within(q, e.depth, !e.inside, stiffness);
      found_.points.push_back(std::move(e));
    }
  }

  void finish(const std::vector<Cell>& undecided) {
    found_.undecided_cells = undecided.size();
    for (const std::vector<Cell>& group : touching(undecided)) {
      UndecidedPlace place = frame_.place_of(group);
      for (const Equilibrium& e : found_.points) place.found += holds(group, frame_.inward(e.at));
      found_.undecided.push_back(place);
    }
    std::stable_sort(found_.undecided.begin(), found_.undecided.end(),
                     [](const auto& a, const auto& b) { return a.cells > b.cells; });
    const auto distance = [&](const Equilibrium& e) { return (e.at - body_.centre_of_mass).norm(); };
    std::stable_sort(found_.points.begin(), found_.points.end(),
                     [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    for (const Equilibrium& e : found_.points) found_.index_sum += e.motions.index;
  }

  const Body& body_;
  const EquilibriaProblem& problem_;
  Monitor& monitor_;
  SpinFrame frame_;
  SpinningField field_;
  EquilibriumNewton newton_;
  GravityBounds bounds_{0, 0, Vec3::Zero(), Vec3::Zero()};
  Equilibria found_;
  double radius_ = 0, slack_ = 0, tensor_slack_ = 0, nothing_ = 0;
};

} // namespace

bool Equilibria::complete() const {
  return undecided_cells == 0 && index_sum == -1 &&
         std::none_of(points.begin(), points.end(), [](const Equilibrium& e) { return e.motions.index == 0; });
}

double synchronous_radius(const Body& body, double constant, const Spin& spin) {
  return spin.rate > 0 ? std::cbrt(constant * body.mass() / (spin.rate * spin.rate)) : 0;
}

MemoryNeed equilibria_memory(const Body& body, const EquilibriaProblem& problem, const Backend& backend) {
  MemoryNeed need = SpinningField(body, problem.constant, problem.spin, problem.tolerance, backend).memory(batch);
  // Cells of a level, those left of it and those of the next.
  need.host += 3 * problem.most_places * sizeof(Cell);
  return need;
}

Equilibria equilibria(const Body& body, const EquilibriaProblem& problem, const Backend& backend, Monitor& monitor) {
  if (!(problem.constant > 0) || !std::isfinite(problem.constant))
    throw Error(Fault::bad_argument, fmt::format("the constant of gravity is {}", problem.constant));
  if (!(problem.smallest >= 1e-8 && problem.smallest <= 0.1))
    throw Error(Fault::bad_argument,
                fmt::format("cells are refined to 1e-8 to 0.1 radii of the body, not {}", problem.smallest));
  if (problem.most_places < 1000)
    throw Error(Fault::bad_argument, fmt::format("{} places are too few: 1000 at least", problem.most_places));
  check_spin(problem.spin);
  if (!(body.mass() > 0) || !body.centre_of_mass.allFinite())
    throw Error(Fault::bad_argument, fmt::format("a body of mass {} holds nothing", body.mass()));
  return Search(body, problem, backend, monitor).run();
}

} // namespace cowgpu::physics

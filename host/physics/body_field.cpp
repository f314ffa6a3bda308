#include "host/physics/body_field.hpp"

#include "host/error.hpp"
#include "host/parallel.hpp"
#include "host/physics/closed_forms.hpp"
#include "host/physics/far_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace cowgpu::physics {
namespace {

using Real = long double;

constexpr std::size_t series_points_per_task = 64;

// Of the field: what thin and hollow bodies lose beyond it is left to the series.
constexpr Real device_loss = 1e-12L;

[[noreturn]] void refuse_edge(const Vec3& p) {
  throw Error(Fault::point_singular,
              fmt::format("the point ({}, {}, {}) lies on an edge of the body, where the second derivatives of its "
                          "potential are infinite; move it, or ask for potential and acceleration alone "
                          "(--derivatives 1)",
                          p[0], p[1], p[2]));
}

PolyhedronAt series_at(const FarField& far, const Vec3& point) {
  const auto at = far.at(point.cast<Real>());
  PolyhedronAt sum;
  sum.value = at.value;
  sum.gradient = at.gradient;
  sum.hessian = at.hessian;
  return sum;
}

// The worse of the relative errors of value and gradient.
double relative_error(const PolyhedronAt& at, const FieldError& error, Real distance, Derivatives derivatives) {
  constexpr Real rounded = std::numeric_limits<double>::epsilon() / 2;
  const Real value = std::fabs(at.value);
  const auto part = [](Real a, Real b) { return a == 0 ? 0 : a / b; };
  Real worst = part(error.value, value);
  if (derivatives != Derivatives::none)
    worst = std::max(worst, part(error.gradient, std::max(at.gradient.norm(), value / distance)));
  return double(worst + rounded);
}

// What each point is summed by, and the errors to be expected.
struct Choice {
  const ClosedForms& forms;
  FieldSum sum;
  Derivatives derivatives;
  Middle about;
  Real mass;    // without sign
  Real allowed; // relative loss of the closed form that no series is asked for
  std::optional<FarField> far;

  Real distance(const Vec3& point) const { return (point.cast<Real>() - about.centre.cast<Real>()).norm(); }

  FieldError closed_error(Real d) const { return forms.rounding(d + about.radius); }

  bool loses(Real d) const { return d > about.radius && closed_error(d).value * d > allowed * mass; }

  // The series may be better: it leaves out a part x^33 of the mass at least.
  bool series_may_win(Real d) const {
    return d > about.radius &&
           closed_error(d).value * d > std::pow(about.radius / d, Real(FarField::degree + 1)) * mass;
  }

  // 80-bit sums go by the smaller error, however small both are.
  bool by_series(const Vec3& point) const {
    if (!far) return false;
    const Real d = distance(point);
    if (!(d > about.radius) || (sum == FieldSum::device && !loses(d))) return false;
    const FieldError closed = closed_error(d), series = far->error(d);
    return series.value < closed.value && (derivatives == Derivatives::none || series.gradient < closed.gradient) &&
           (derivatives != Derivatives::second || series.hessian < closed.hessian);
  }
};

// Fills in what comes, from several threads at different points.
class Results {
public:
  Results(std::span<const Vec3> points, const BodyFieldProblem& problem, unsigned threads)
      : points_(points), problem_(problem), errors_(threads) {
    const std::size_t count = points.size();
    found.density.resize(count);
    found.by_series.resize(count);
    found.field.value.resize(count);
    if (problem.derivatives != Derivatives::none) found.field.gradient.resize(count);
    if (problem.derivatives == Derivatives::second) found.field.hessian.resize(count);
    if (problem.guarantee) found.bound.resize(count);
  }

  void put(std::size_t i, const PolyhedronAt& at, double bound, const FieldError& error, Real distance,
           unsigned thread) {
    if (at.on_edge && problem_.derivatives == Derivatives::second) refuse_edge(points_[i]);
    Errors& worst = errors_[thread];
    worst.relative = std::max(worst.relative, relative_error(at, error, distance, problem_.derivatives));
    worst.value = std::max(worst.value, double(error.value));
    worst.gradient = std::max(worst.gradient, double(error.gradient));
    found.density[i] = double(at.winding);
    found.field.value[i] = double(at.value);
    if (problem_.guarantee) found.bound[i] = bound;
    if (problem_.derivatives == Derivatives::none) return;
    found.field.gradient[i] = at.gradient.cast<double>();
    if (problem_.derivatives == Derivatives::first) return;
    const auto& h = at.hessian;
    found.field.hessian[i] = {double(h(0, 0)), double(h(0, 1)), double(h(0, 2)),
                              double(h(1, 1)), double(h(1, 2)), double(h(2, 2))};
  }

  BodyFieldValues take() {
    for (const Errors& e : errors_) {
      found.error = std::max(found.error, e.relative);
      found.value_error = std::max(found.value_error, e.value);
      found.gradient_error = std::max(found.gradient_error, e.gradient);
    }
    return std::move(found);
  }

  BodyFieldValues found;

private:
  struct Errors {
    double relative = 0, value = 0, gradient = 0;
  };
  std::span<const Vec3> points_;
  const BodyFieldProblem& problem_;
  std::vector<Errors> errors_;
};

} // namespace

BodyField::BodyField(const Body& body, const BodyFieldProblem& problem, const Backend& backend)
    : body_(body), problem_(problem), forms_(problem.sum == FieldSum::extended ? extended_forms(body, problem.threads)
                                                                               : device_forms(body, problem, backend)) {
}

BodyField::~BodyField() = default;

MemoryNeed BodyField::memory(std::uint64_t points) const {
  MemoryNeed need = forms_->memory(points);
  const std::uint64_t tensor = problem_.derivatives == Derivatives::second ? 6 : 0;
  need.host += points * (8 * (1 + 3 + tensor + 1 + 1) + 8);
  return need;
}

BodyFieldValues BodyField::at(std::span<const Vec3> points, Monitor& monitor, RunReport* report) const {
  const unsigned threads = problem_.threads ? problem_.threads : all_threads();
  Choice choice{*forms_, problem_.sum, problem_.derivatives, middle(body_), std::fabs(Real(body_.mass())), 0, {}};
  choice.allowed = problem_.sum == FieldSum::extended ? Real(std::numeric_limits<double>::epsilon() / 4)
                                                      : std::max<Real>(problem_.tolerance, device_loss);
  bool some_lose = false, some_may_win = false;
  for (const Vec3& p : points) {
    if (!p.allFinite()) throw Error(Fault::bad_argument, "a point is not finite");
    if (some_lose && some_may_win) continue;
    const Real d = choice.distance(p);
    some_lose = some_lose || choice.loses(d);
    some_may_win = some_may_win || choice.series_may_win(d);
  }
  if (some_lose && some_may_win) choice.far.emplace(body_, monitor);
  Results results(points, problem_, threads);
  std::vector<std::uint32_t> closed, series;
  for (std::size_t i = 0; i < points.size(); ++i) {
    results.found.by_series[i] = choice.by_series(points[i]);
    (results.found.by_series[i] ? series : closed).push_back(std::uint32_t(i));
  }
  const auto put_closed = [&](std::size_t i, const PolyhedronAt& at, double bound, unsigned thread) {
    const Real d = choice.distance(points[i]);
    FieldError error = choice.closed_error(d);
    const FieldError left_out = forms_->left_out();
    error.value += left_out.value;
    error.gradient += left_out.gradient;
    results.put(i, at, bound, error, std::max<Real>(d, choice.about.radius), thread);
  };
  if (!closed.empty()) forms_->at(points, closed, put_closed, monitor, report);
  const std::size_t tasks = (series.size() + series_points_per_task - 1) / series_points_per_task;
  parallel_for(threads, tasks, [&](std::size_t task, unsigned thread) {
    check_stop(monitor);
    const std::size_t end = std::min(series.size(), (task + 1) * series_points_per_task);
    for (std::size_t k = task * series_points_per_task; k < end; ++k) {
      const Vec3& p = points[series[k]];
      const Real d = choice.distance(p);
      const FieldError error = choice.far->error(d);
      results.put(series[k], series_at(*choice.far, p), double(error.gradient), error, d, thread);
    }
  });
  return results.take();
}

BodyFieldValues exact_field(const Body& body, std::span<const Vec3> points, Derivatives derivatives, unsigned threads,
                            Monitor& monitor) {
  // The 80-bit sums take nothing of a backend but its type.
  const auto none = make_cpu_backend(1);
  return BodyField(body, {derivatives, FieldSum::extended, threads}, *none).at(points, monitor);
}

} // namespace cowgpu::physics

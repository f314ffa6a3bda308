#include "host/physics/push.hpp"

#include "host/error.hpp"

#include <Eigen/Core>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace cowgpu::physics {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

using State = Eigen::Vector2d; // theta, omega

// Gauss's rule of 7 points within Kronrod's of 15 on [-1, 1]; QUADPACK's qk15.
constexpr std::array kronrod_at = {0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
                                   0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
                                   0.586087235467691130294144691693013, 0.405845151377397166906606412076961,
                                   0.207784955007898467600689403773245, 0.0};
constexpr std::array kronrod_weight = {0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
                                       0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
                                       0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
                                       0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
constexpr std::array gauss_weight = {0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
                                     0.381830050505118944950369775488975, 0.417959183673469387755102040816327};

struct Panel {
  double value = 0, error = 0;
};

Panel panel(const std::function<double(double)>& f, double a, double b) {
  const double middle = (a + b) / 2, half = (b - a) / 2, centre = f(middle);
  double kronrod = kronrod_weight[7] * centre, gauss = gauss_weight[3] * centre;
  for (std::size_t i = 0; i < 7; ++i) {
    const double pair = f(middle - half * kronrod_at[i]) + f(middle + half * kronrod_at[i]);
    kronrod += kronrod_weight[i] * pair;
    if (i % 2 == 1) gauss += gauss_weight[i / 2] * pair;
  }
  return {half * kronrod, half * std::abs(kronrod - gauss)};
}

// Halves what is off by more than `tolerance`, twenty times at most: what is left then is rounding.
double integral(const std::function<double(double)>& f, double a, double b, double tolerance, const Monitor& monitor,
                int depth = 0) {
  check_stop(monitor);
  const Panel whole = panel(f, a, b);
  const bool good = whole.error <= std::max(tolerance, 1e-13 * std::abs(whole.value));
  if (good || depth == 20 || !std::isfinite(whole.value)) return whole.value;
  return integral(f, a, (a + b) / 2, tolerance, monitor, depth + 1) +
         integral(f, (a + b) / 2, b, tolerance, monitor, depth + 1);
}

// theta - sin theta without loss.
double less_sine(double theta) {
  const double t = theta * theta;
  if (t > 0.04) return theta - std::sin(theta);
  return theta * t / 6 * (1 - t / 20 * (1 - t / 42 * (1 - t / 72 * (1 - t / 110 * (1 - t / 156)))));
}

// The part of the lift that is done at a tilt, over m g r: cos(alpha - theta) - cos alpha.
double lifted(double alpha, double theta) {
  return 2 * std::sin(theta / 2) * std::sin(alpha - theta / 2);
}

// The motion while the push is one straight line.
struct Motion {
  const Rocker& rocker;
  double start = 0, force = 0, slope = 0; // the push at `start`, and its rise

  double push_at(double t) const { return std::max(force + slope * (t - start), 0.0); }
  double acceleration(double t, double theta) const {
    const double arm = rocker.lever * (rocker.turns_with_body ? 1 : std::cos(theta));
    const double weight = rocker.mass * rocker.gravity;
    return (push_at(t) * arm - weight * rocker.radius * std::sin(rocker.balance - theta)) / rocker.inertia;
  }
  State slope_at(double t, const State& y) const { return {y[1], acceleration(t, y[0])}; }

  // |friction|/normal force that keep the edge where it is.
  double friction(double t, const State& y) const {
    const double beta = rocker.balance - y[0], alpha = rocker.turns_with_body ? beta : rocker.balance;
    const double turn = acceleration(t, y[0]), f = push_at(t);
    const double inward = y[1] * y[1];
    const double across = rocker.radius * (std::cos(beta) * turn + std::sin(beta) * inward);
    const double upwards = rocker.radius * (std::sin(beta) * turn - std::cos(beta) * inward);
    const double horizontal = rocker.mass * across - f * std::cos(alpha);
    const double normal = rocker.mass * (upwards + rocker.gravity) - f * std::sin(alpha);
    return normal > 0 ? std::abs(horizontal) / normal : infinity;
  }

  // A step of order 5, and the difference to that of order 4.
  State step(double t, const State& y, double h, State& error) const {
    const State k1 = slope_at(t, y);
    const State k2 = slope_at(t + h / 5, y + h * (k1 / 5));
    const State k3 = slope_at(t + 3 * h / 10, y + h * (3.0 / 40 * k1 + 9.0 / 40 * k2));
    const State k4 = slope_at(t + 4 * h / 5, y + h * (44.0 / 45 * k1 - 56.0 / 15 * k2 + 32.0 / 9 * k3));
    const State k5 = slope_at(
        t + 8 * h / 9, y + h * (19372.0 / 6561 * k1 - 25360.0 / 2187 * k2 + 64448.0 / 6561 * k3 - 212.0 / 729 * k4));
    const State k6 = slope_at(t + h, y + h * (9017.0 / 3168 * k1 - 355.0 / 33 * k2 + 46732.0 / 5247 * k3 +
                                              49.0 / 176 * k4 - 5103.0 / 18656 * k5));
    const State next =
        y + h * (35.0 / 384 * k1 + 500.0 / 1113 * k3 + 125.0 / 192 * k4 - 2187.0 / 6784 * k5 + 11.0 / 84 * k6);
    const State k7 = slope_at(t + h, next);
    error = h * (71.0 / 57600 * k1 - 71.0 / 16695 * k3 + 71.0 / 1920 * k4 - 17253.0 / 339200 * k5 + 22.0 / 525 * k6 -
                 1.0 / 40 * k7);
    return next;
  }
};

enum class Event { none, tipped, landed };

constexpr double tolerance = 1e-12;
constexpr long most_steps = 2000000;

class Integrator {
public:
  Integrator(const Rocker& rocker, PushResult& result, const Monitor& monitor)
      : rocker_(rocker), result_(result), monitor_(monitor),
        rate_(std::sqrt(rocker.mass * rocker.gravity * rocker.radius / rocker.inertia)) {}

  double t = 0;
  State y = State::Zero();

  // Moves on until `end`, past the balance or to the ground.
  Event run(const Motion& motion, double end) {
    double h = std::min(end - t, 1e-3 / rate_);
    note(motion);
    for (long steps = 0; t < end; ++steps) {
      if (steps % 256 == 0) check_stop(monitor_);
      if (steps == most_steps)
        throw Error(Fault::check_failed,
                    fmt::format("the motion cannot be followed beyond {} s: it takes more than {} steps", t, steps));
      h = std::min(h, end - t);
      State error;
      const State next = motion.step(t, y, h, error);
      // Relative to what there is, from a thousandth of alpha on: just above the threshold it grows as cosh.
      const double least = 1e-3 * rocker_.balance;
      const double wrong = std::max(std::abs(error[0]) / std::max(std::abs(y[0]), least),
                                    std::abs(error[1]) / (rate_ * std::max(std::abs(y[1] / rate_), least))) /
                           tolerance;
      const double factor = std::isfinite(wrong) ? 0.9 * std::pow(std::max(wrong, 1e-10), -0.2) : 0;
      if (!(wrong <= 1) && h > 1e-14 * t) {
        h *= std::max(factor, 0.2);
        continue;
      }
      const bool over = next[0] >= rocker_.balance, down = next[0] <= 0 && next[1] < 0;
      if (y[1] > 0 && next[1] < 0) peak(motion, h);
      if (over || down) {
        finish(motion, h, over ? rocker_.balance : 0);
        return over ? Event::tipped : Event::landed;
      }
      const bool last = h == end - t;
      t = last ? end : t + h;
      y = next;
      note(motion);
      h *= std::min(factor, 5.0);
    }
    return Event::none;
  }

  void note(const Motion& motion) {
    result_.peak_tilt = std::max(result_.peak_tilt, y[0]);
    const double needed = motion.friction(t, y);
    if (!(needed > result_.friction_needed)) return;
    result_.friction_needed = needed;
    result_.friction_time = t;
  }

private:
  // The part of a step of length h at which `value` changes its sign, by bisection.
  template <class Value>
  double root(const Motion& motion, double h, const Value& value) const {
    State error;
    double low = 0, high = h;
    const bool sign = value(y) > 0;
    for (int i = 0; i < 200 && high - low > 0; ++i) {
      const double middle = (low + high) / 2;
      if (middle == low || middle == high) break;
      (((value(motion.step(t, y, middle, error)) > 0) == sign) ? low : high) = middle;
    }
    return high;
  }
  void peak(const Motion& motion, double h) {
    State error;
    const double part = root(motion, h, [](const State& s) { return s[1]; });
    const double tilt = motion.step(t, y, part, error)[0];
    if (tilt < rocker_.balance) result_.peak_tilt = std::max(result_.peak_tilt, tilt);
  }
  void finish(const Motion& motion, double h, double tilt) {
    State error;
    const bool starts_there = y[0] == tilt; // right after lifting off
    const double part = starts_there ? h : root(motion, h, [&](const State& s) { return s[0] - tilt; });
    y = motion.step(t, y, part, error);
    y[0] = tilt;
    t += part;
    note(motion);
  }

  const Rocker& rocker_;
  PushResult& result_;
  const Monitor& monitor_;
  double rate_;
};

void check(const Rocker& rocker) {
  for (const double value : {rocker.mass, rocker.gravity, rocker.inertia, rocker.radius, rocker.balance, rocker.lever})
    if (!(value > 0) || !std::isfinite(value))
      throw Error(Fault::bad_argument,
                  "a body that any push tips has no threshold, and none that it can fall back from: "
                  "mass, inertia, lever and the angle of balance must be above 0");
}

} // namespace

double Rocker::threshold() const {
  return mass * gravity * radius * std::sin(balance) / lever;
}

double Rocker::least_energy() const {
  return mass * gravity * radius * lifted(balance, balance);
}

double Rocker::least_impulse() const {
  return std::sqrt(2 * inertia * least_energy()) / lever;
}

double Rocker::least_duration(double force, const Monitor& monitor) const {
  const double over = force / threshold();
  if (!(over > 1)) return infinity;
  const double sine = std::sin(balance), cosine = std::cos(balance);
  const double work = lifted(balance, balance) / (over * sine); // theta_1 or its sine
  const double end = turns_with_body ? work : std::asin(work);
  // theta = end s^2 takes the root of omega at 0 away.
  const double omega2 = 2 * mass * gravity * radius / inertia;
  const auto slowness = [&](double s) {
    const double theta = end * s * s, half = std::sin(theta / 2);
    const double arm = turns_with_body ? theta : std::sin(theta), more = turns_with_body ? less_sine(theta) : 0;
    return 2 * end * s / std::sqrt(omega2 * (sine * ((over - 1) * arm + more) + 2 * cosine * half * half));
  };
  return integral(slowness, 0, 1, 1e-14 * panel(slowness, 0, 1).value, monitor);
}

double Rocker::least_force(double duration, const Monitor& monitor) const {
  double low = threshold(), high = 2 * low;
  while (least_duration(high, monitor) > duration && high < 1e300) high *= 2;
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (!(low < middle && middle < high)) return high;
    (least_duration(middle, monitor) > duration ? low : high) = middle;
  }
}

double Profile::impulse() const {
  double sum = 0;
  for (std::size_t i = 1; i < time.size(); ++i) sum += (force[i] + force[i - 1]) / 2 * (time[i] - time[i - 1]);
  return sum;
}

Profile square_pulse(double force, double duration) {
  return {{0, duration}, {force, force}};
}

void check(const Profile& profile) {
  if (profile.time.size() < 2 || profile.time.size() != profile.force.size())
    throw Error(Fault::bad_argument, "a push over time is at least two rows of time and force");
  for (std::size_t i = 0; i < profile.time.size(); ++i) {
    if (!std::isfinite(profile.time[i]) || !std::isfinite(profile.force[i]) || profile.force[i] < 0)
      throw Error(Fault::bad_argument,
                  fmt::format("row {} of the push: a force of {} N at {} s; both must be finite and "
                              "the force not below 0",
                              i + 1, profile.force[i], profile.time[i]));
    if (profile.time[i] < (i ? profile.time[i - 1] : 0))
      throw Error(Fault::bad_argument, fmt::format("row {} of the push: {} s comes before what it follows; times rise "
                                                   "from 0 on",
                                                   i + 1, profile.time[i]));
  }
  if (!std::isfinite(profile.impulse()))
    throw Error(Fault::bad_argument,
                "the impulse of the push is not finite: its forces are too large, give smaller ones");
}

PushResult push(const Rocker& rocker, const Profile& profile, const Monitor& monitor) {
  check(rocker);
  check(profile);
  PushResult result;
  result.lift_time = std::numeric_limits<double>::quiet_NaN();
  Integrator body(rocker, result, monitor);
  const double threshold = rocker.threshold();
  bool up = false;
  for (std::size_t i = 1; i < profile.time.size(); ++i) {
    const double begin = profile.time[i - 1], end = profile.time[i];
    if (end == begin) continue;
    const Motion motion{rocker, begin, profile.force[i - 1], (profile.force[i] - profile.force[i - 1]) / (end - begin)};
    body.t = begin;
    while (body.t < end) {
      if (!up) { // on the ground, where friction and the normal force hold against the push
        double lift = body.t;
        if (!(motion.push_at(lift) > threshold)) {
          lift = motion.slope > 0 ? std::min(begin + (threshold - motion.force) / motion.slope, end) : end;
          for (const double t : {body.t, lift}) {
            const double held = std::min(motion.push_at(t), threshold);
            const double needed =
                held * std::cos(rocker.balance) / (rocker.mass * rocker.gravity - held * std::sin(rocker.balance));
            if (needed <= result.friction_needed) continue;
            result.friction_needed = needed;
            result.friction_time = t;
          }
        }
        if (!(lift < end)) break;
        up = true;
        body.t = lift;
        body.y.setZero();
        if (std::isnan(result.lift_time)) result.lift_time = lift;
      }
      const Event event = body.run(motion, end);
      if (event == Event::tipped) {
        result.outcome = Outcome::tipped;
        result.peak_tilt = rocker.balance;
        result.end_time = body.t;
        return result;
      }
      if (event == Event::landed) {
        up = false;
        result.end_time = body.t;
      }
    }
  }
  if (std::isnan(result.lift_time)) return result;
  result.outcome = Outcome::fell_back;
  if (!up) return result;
  // Free: energy decides, the integration only says when.
  const double alpha = rocker.balance, weight = rocker.mass * rocker.gravity * rocker.radius;
  const double left = lifted(alpha, alpha) - lifted(alpha, body.y[0]); // what is left of the lift, over m g r
  const double kinetic = rocker.inertia * body.y[1] * body.y[1] / (2 * weight);
  const bool tips = body.y[1] > 0 && kinetic > left;
  if (tips) result.outcome = Outcome::tipped;
  // Still rising, to where cos(alpha - theta) has grown by what is left in motion.
  const double peak = body.y[1] > 0 ? alpha - 2 * std::asin(std::sqrt(std::max(left - kinetic, 0.0) / 2)) : body.y[0];
  result.peak_tilt = tips ? alpha : std::max(result.peak_tilt, peak);
  const Motion free{rocker, body.t, 0, 0};
  const double slow = std::sqrt(rocker.inertia / weight);
  const Event event = body.run(free, body.t + 1000 * slow);
  const Event wanted = tips ? Event::tipped : Event::landed;
  result.end_time = event == wanted ? body.t : infinity;
  return result;
}

} // namespace cowgpu::physics

#include "host/plan/flow_path.hpp"

#include "host/plan/flow_steps.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cowgpu::plan {
namespace {

// Lengths relative to the body's diagonal. Next to the surface, where flows off edges start, they go with the distance.
constexpr double rounding = 1e-13;   // what two ways to the same length may differ by
constexpr double tie = 1e-11;        // a triangle nearer by so much is an event
constexpr double apart = 1e-9;       // a contact farther by so much is none
constexpr double off_surface = 1e-7; // where a flow starts that cannot leave along the normal
constexpr double digits = 4e-15;     // what doubles can tell
// Relative to the distance.
constexpr double same_point = 1e-6;

constexpr double near_share = 1e3; // a length of 1e-3 diagonals and more is not next to the surface

constexpr int most_rounds = 2000; // rounds of steps as long as the distance

// shaders/flow.comp does the same operations in the same order.
double norm(const Vec3& a) {
  return plan::norm<double>(a);
}
double square(const Vec3& a) {
  return dot<double>(a, a);
}

// What a step may be multiplied by: errors per step go with its fourth power.
double longer(double allowed, double error) {
  return 0.9 * std::sqrt(std::sqrt(allowed / error));
}

} // namespace

void FlowPath::Contact::add(std::uint32_t face) {
  if (std::find(faces.begin(), faces.begin() + count, face) != faces.begin() + count) return;
  if (count == most_faces) { // the oldest goes
    std::rotate(faces.begin(), faces.begin() + 1, faces.end());
    --count;
  }
  faces[std::size_t(count++)] = face;
}

void FlowPath::Contacts::add(std::uint32_t face) {
  if (count == most_contacts) return;
  list[std::size_t(count)] = {};
  list[std::size_t(count++)].add(face);
}

double FlowPath::View::active_distance() const {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < count; ++i)
    if (active(i)) least = std::min(least, distances[std::size_t(i)]);
  return std::isfinite(least) ? least : distance;
}

double FlowPath::small(double length, double distance) const {
  return std::max(digits * scale_, length * std::min(scale_, near_share * distance));
}

FlowPath::FlowPath(const FlowSurface& surface, double time, double tolerance, FlowTrace* trace)
    : surface_(&surface), time_(time), tolerance_(tolerance), scale_(surface.diagonal()),
      longest_(longest_step(tolerance)), most_steps_(most_steps(tolerance)), trace_(trace) {}

// A triangle that is nearer only during a step is not seen: closer looks at tighter tolerances.
double FlowPath::longest_step(double tolerance) {
  return std::clamp(0.5 * std::pow(tolerance / 1e-6, 1.0 / 6), 0.05, 0.5);
}

double FlowPath::most_steps(double tolerance) {
  return most_rounds / longest_step(tolerance);
}

FlowDeparture FlowPath::departure() const {
  using Asks = FlowDeparture::Asks;
  const Asks asks = phase_ == Phase::lift ? Asks::lift : phase_ == Phase::ray ? Asks::ray : Asks::last;
  return {asks,           x_,           t_,         ball_.foot, ball_.normal,
          ball_.distance, ball_.radius, ball_.face, inside_,    std::uint32_t(rounds_)};
}

void FlowPath::record() {
  if (!trace_) return;
  trace_->places.push_back(x_);
  trace_->times.push_back(t_);
}

void FlowPath::look(const Vec3& x, View& view) const {
  view.place = x;
  view.count = contacts_.count;
  view.distance = std::numeric_limits<double>::infinity();
  for (int c = 0; c < contacts_.count; ++c) {
    const auto i = std::size_t(c);
    const Contact& contact = contacts_.list[i];
    Foot best = surface_->foot(contact.faces[0], x);
    view.faces[i] = contact.faces[0];
    for (int k = 1; k < contact.count; ++k) {
      const Foot foot = surface_->foot(contact.faces[std::size_t(k)], x);
      if (foot.distance < best.distance) best = foot, view.faces[i] = contact.faces[std::size_t(k)];
    }
    view.points[i] = best.point;
    view.distances[i] = best.distance;
    view.inside[i] = best.inside;
    view.normals[i] = best.distance > 0 ? Vec3((x - best.point) / best.distance) : surface_->normal(view.faces[i]);
    view.distance = std::min(view.distance, best.distance);
  }
  if (view.count == 1) {
    view.weights[0] = 1;
    view.velocity = view.normals[0];
  } else if (view.count == 2) {
    view.weights[0] = view.weights[1] = 0.5;
    view.velocity = (view.normals[0] + view.normals[1]) / 2;
  } else {
    least_norm_in_hull<double>(std::span<const Vec3>(view.normals.data(), std::size_t(view.count)), view.velocity,
                               std::span<double>(view.weights.data(), std::size_t(view.count)));
  }
}

void FlowPath::tidy(View& view) {
  const double far = view.distance + small(apart, view.distance);
  const double join = same_point / 10 * view.distance;
  Contacts kept;
  bool changed = false;
  std::array<int, most_contacts> from{};
  for (int c = 0; c < view.count; ++c) {
    const auto i = std::size_t(c);
    if (view.distances[i] > far) {
      changed = true;
      continue;
    }
    int same = 0;
    while (same < kept.count && norm(view.points[std::size_t(from[std::size_t(same)])] - view.points[i]) >= join)
      ++same;
    const Contact& contact = contacts_.list[i];
    if (same < kept.count) {
      changed = true;
      for (int k = 0; k < contact.count; ++k) kept.list[std::size_t(same)].add(contact.faces[std::size_t(k)]);
      continue;
    }
    Contact& own = kept.list[std::size_t(kept.count)];
    own = {};
    from[std::size_t(kept.count++)] = c;
    if (contact.count == 1) {
      own = contact;
      continue;
    }
    for (int k = 0; k < contact.count; ++k) {
      const std::uint32_t face = contact.faces[std::size_t(k)];
      if (surface_->foot(face, x_).distance <= view.distances[i] + (far - view.distance) / 10) own.add(face);
    }
  }
  if (kept.count == 0) return;
  contacts_ = kept;
  if (changed) look(x_, view);
}

void FlowPath::restart(std::uint32_t face) {
  warm_ = face;
  contacts_.count = 0;
  contacts_.add(warm_);
  idle_ = 0;
  step_ = 0;
  go_on();
}

void FlowPath::take_in(std::uint32_t face, const Vec3& place) {
  View view;
  look(place, view);
  const Vec3 point = surface_->foot(face, place).point;
  ++end_.events;
  for (int c = 0; c < view.count; ++c)
    if (norm(view.points[std::size_t(c)] - point) < same_point * view.distance) {
      contacts_.list[std::size_t(c)].add(face);
      return;
    }
  contacts_.add(face);
}

void FlowPath::begin_ray(const Vec3& foot, const Vec3& normal, double distance, std::uint32_t face) {
  const double limit = distance + (time_ - t_);
  ball_ = {foot, normal, distance, limit, limit, face, face, foot, 0};
  ask(Phase::ray, foot + limit * normal, warm_);
}

void FlowPath::shrink(std::uint32_t face) {
  const Vec3 point = surface_->foot(face, query_).point;
  if (!plan::shrink<double>(ball_.foot, ball_.normal, point, small(rounding, ball_.radius), ball_.radius) ||
      ++ball_.rounds == 100) {
    ball_.radius = std::max(ball_.distance, ball_.radius);
    return end_ray();
  }
  ball_.touched = point;
  ball_.hit = face;
  ask(Phase::ray, ball_.foot + ball_.radius * ball_.normal, face);
}

void FlowPath::end_ray() {
  x_ = ball_.foot + ball_.radius * ball_.normal;
  t_ += ball_.radius - ball_.distance;
  record();
  if (ball_.radius >= ball_.limit) {
    t_ = time_;
    return go_on();
  }
  const bool moved = ball_.radius > ball_.distance + rounding * scale_;
  ++end_.events;
  contacts_.count = 0;
  if (moved && norm(ball_.touched - ball_.foot) < same_point * ball_.radius) {
    contacts_.add(ball_.hit);
  } else {
    contacts_.add(ball_.face);
    if (ball_.hit != ball_.face) contacts_.add(ball_.hit);
  }
  warm_ = ball_.face;
  step_ = 0;
  idle_ = moved ? 0 : idle_ + 1;
  go_on();
}

// With an error wanted `view` is that from the step's end.
Vec3 FlowPath::slide_step(const Vec3& from, const Vec3& velocity, double step, View& view, double* error) const {
  return dormand_prince<double>(
      from, step, velocity,
      [&](const Vec3& y) {
        look(y, view);
        return view.velocity;
      },
      error);
}

void FlowPath::balance(Vec3& x, View& view) const {
  // Newton's method for equal distances of up to three contacts, along the differences of their directions.
  for (int round = 0; round < 3; ++round) {
    if (x != view.place) look(x, view);
    int id[3], m = 0;
    for (int i = 0; i < view.count && m < 3; ++i)
      if (view.active(i)) id[m++] = i;
    if (m < 2) return;
    const auto at = [&](int k) { return std::size_t(id[k]); };
    const Vec3 a = view.normals[at(1)] - view.normals[at(0)];
    const double ra = view.distances[at(0)] - view.distances[at(1)], aa = square(a);
    if (!(aa > 1e-16)) return;
    double rc = 0;
    if (m == 2) {
      x += ra / aa * a;
    } else {
      const Vec3 c = view.normals[at(2)] - view.normals[at(0)];
      rc = view.distances[at(0)] - view.distances[at(2)];
      const double cc = square(c), ac = dot<double>(a, c), determinant = aa * cc - ac * ac;
      if (!(determinant > 1e-14 * aa * cc)) return;
      x += (ra * cc - rc * ac) / determinant * a + (rc * aa - ra * ac) / determinant * c;
    }
    if (std::abs(ra) + std::abs(rc) < 1e-15 * scale_) return;
  }
}

bool FlowPath::straight(const View& from, const Vec3& to) const {
  // Nearest points inside their triangles at both ends are so in between: distances are linear, velocity is constant.
  for (int c = 0; c < from.count; ++c) {
    const auto i = std::size_t(c);
    if (!from.inside[i]) return false;
    if (contacts_.list[i].count > 1) return false;
    if (!surface_->foot(from.faces[i], to).inside) return false;
  }
  return true;
}

Vec3 FlowPath::advance(const View& from, double step, bool straight) const {
  if (straight) return x_ + step * from.velocity;
  View view;
  Vec3 place = slide_step(x_, from.velocity, step, view, nullptr);
  balance(place, view);
  return place;
}

// The step after which `face` is as near as the contacts, by Illinois' rule; `place`, that after `step`, then.
double FlowPath::to_tie(const View& from, std::uint32_t face, double step, double gap, bool straight, Vec3& place) {
  View view;
  const auto gap_at = [&](const Vec3& at) {
    look(at, view);
    return surface_->foot(face, at).distance - view.active_distance();
  };
  double low = 0, high = step, low_gap = gap_at(x_), high_gap = gap;
  if (low_gap <= 10 * small(rounding, from.distance)) {
    place = x_;
    return 0;
  }
  int side = 0;
  for (int round = 0; round < 60 && high - low > 1e-9 * step; ++round) {
    double s = round % 4 == 3 ? (low + high) / 2 : low + (high - low) * low_gap / (low_gap - high_gap);
    if (!(s > low && s < high)) s = (low + high) / 2;
    const Vec3 at = advance(from, s, straight);
    const double here = gap_at(at);
    const bool enough = std::abs(here) < small(rounding, from.distance) / 10;
    if (here > 0) {
      low = s;
      low_gap = here;
      if (side == 1) high_gap /= 2;
      side = 1;
    } else {
      high_gap = here;
      if (side == -1) low_gap /= 2;
      side = -1;
    }
    if (here > 0 && !enough) continue;
    high = s;
    place = at;
    if (enough) break;
  }
  return high;
}

void FlowPath::begin_slide(const View& view) {
  const double most = std::min(time_ - t_, longest_ * view.distance / norm(view.velocity));
  double step = most, next = 0;
  ++end_.steps;
  Vec3 place = x_ + step * view.velocity;
  const bool line = straight(view, place);
  if (!line) {
    step = std::min(most, step_ > 0 ? step_ : most / 10);
    double error = 0, allowed = 0;
    View there;
    for (int tries = 0;; ++tries) {
      place = slide_step(x_, view.velocity, step, there, &error);
      allowed = tolerance_ * step + small(rounding, view.distance);
      if (error <= allowed || step < apart * most || tries == 30) break;
      step *= std::max(0.1, longer(allowed, error));
    }
    next = step * std::min(4.0, longer(allowed, error + 1e-30));
    balance(place, there);
  }
  slide_ = {view, place, step, next, line, no_face, 0};
  ask(Phase::slide, place, warm_);
}

void FlowPath::check_slide(std::uint32_t face) {
  Vec3& place = slide_.place;
  View view;
  look(place, view);
  const double gap = surface_->foot(face, place).distance - view.distance;
  const bool met = gap < -small(tie, view.distance);
  if (met) {
    slide_.nearer = face;
    slide_.step = to_tie(slide_.from, face, slide_.step, gap, slide_.straight, place);
    if (slide_.step > 0 && ++slide_.tries < 12) return ask(Phase::slide, place, warm_);
  }
  end_slide(slide_.nearer == no_face ? &view : nullptr);
}

// `view`: from the step's end, if the contacts are the same there.
void FlowPath::end_slide(View* view) {
  const double step = slide_.step, distance = slide_.from.distance;
  const bool met = slide_.nearer != no_face;
  if (met) take_in(slide_.nearer, slide_.place);
  x_ = slide_.place;
  t_ += step;
  record();
  idle_ = step < apart * distance ? idle_ + 1 : 0;
  step_ = met ? std::max(slide_.next / 4, same_point * distance) : slide_.next;
  warm_ = contacts_.list[0].faces[0];
  go_on(view);
}

bool FlowPath::come_out(const Vec3& place, Vec3& foot, Vec3& normal, std::uint32_t& face) const {
  std::vector<Foot> feet(surface_->faces());
  for (std::uint32_t f = 0; f < surface_->faces(); ++f) feet[f] = surface_->foot(f, place);
  std::vector<std::uint32_t> order(feet.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return feet[a].distance < feet[b].distance || (feet[a].distance == feet[b].distance && a < b);
  });
  for (const std::uint32_t f : order) {
    const Vec3 way = feet[f].point - place;
    const Vec3 out = feet[f].distance > rounding * scale_ ? Vec3(way / feet[f].distance) : surface_->normal(f);
    if (surface_->winding_number(feet[f].point + off_surface * scale_ * out) != 0) continue;
    foot = feet[f].point;
    normal = out;
    face = f;
    return true;
  }
  return false;
}

void FlowPath::leave() {
  const Vec3 place = x_;
  Vec3 foot = place, normal = ball_.normal;
  const Foot near = surface_->foot(warm_, place);
  const bool on_surface = normal.squaredNorm() > 0 || near.distance <= rounding * scale_;
  if (on_surface && normal.squaredNorm() == 0) normal = surface_->normal(warm_);
  const Vec3 off = place + off_surface * scale_ * normal;
  if (surface_->winding_number(on_surface ? off : place) != 0) {
    // Inside, the gradient of the negative distance leads straight to the nearest way out. Sheets of the surface inside
    // the body, where it overlaps itself, are none.
    end_.flags |= flow_inside;
    std::uint32_t face = 0;
    if (!come_out(on_surface ? off : place, foot, normal, face)) {
      end_.flags |= flow_unfinished;
      t_ = time_;
      inside_ = true;
      return go_on();
    }
    const double way = (foot - place).norm();
    warm_ = face;
    if (way >= time_) {
      x_ = place + time_ * normal;
      t_ = time_;
      inside_ = true;
      return go_on();
    }
    t_ = way;
    x_ = foot;
    record();
  } else if (!on_surface) {
    contacts_.add(warm_);
    return go_on();
  }
  // Largest ball that touches here: the flow leaves along the normal if there is one.
  const double least = std::min(10 * off_surface * scale_, time_ - t_);
  ball_ = {foot, normal, 0, least, 0, warm_, 0, foot, 0};
  ask(Phase::lift, foot + least * normal, warm_);
}

void FlowPath::lift(std::uint32_t face) {
  const Vec3 foot = ball_.foot, normal = ball_.normal;
  const double least = ball_.radius;
  if (surface_->foot(face, query_).distance >= least - small(rounding, least)) return begin_ray(foot, normal, 0, warm_);
  end_.flags |= flow_notch;
  const double away = std::min(off_surface * scale_, time_ - t_);
  x_ = foot + away * normal;
  t_ += away;
  record();
  ask(Phase::restart, x_, warm_);
}

void FlowPath::ask(Phase phase, const Vec3& place, std::uint32_t warm) {
  phase_ = phase;
  query_ = place;
  query_warm_ = warm;
  ++end_.queries;
}

void FlowPath::start(const Vec3& place, const Vec3& normal) {
  end_ = {};
  contacts_.count = 0;
  t_ = step_ = 0;
  idle_ = rounds_ = 0;
  inside_ = false;
  if (trace_) *trace_ = {};
  x_ = place;
  ball_.normal = normal;
  record();
  ask(Phase::start, place, no_face);
}

void FlowPath::answer(std::uint32_t face) {
  switch (phase_) {
  case Phase::start: warm_ = face; return time_ > 0 ? leave() : go_on();
  case Phase::lift: return lift(face);
  case Phase::restart: return restart(face);
  case Phase::ray: return shrink(face);
  case Phase::slide: return check_slide(face);
  case Phase::last:
    end_.position = x_;
    end_.face = face;
    end_.distance = surface_->foot(face, x_).distance;
    if (inside_) end_.distance = -end_.distance;
    phase_ = Phase::done;
    return;
  case Phase::done: return;
  }
}

// `view`: from x_, where it is known.
void FlowPath::go_on(View* known) {
  if (t_ >= time_ * (1 - time_digits)) return ask(Phase::last, x_, warm_);
  if (rounds_++ >= most_steps_) {
    end_.flags |= flow_unfinished;
    return ask(Phase::last, x_, warm_);
  }
  if (idle_ > 6) return ask(Phase::restart, x_, warm_);
  View fresh;
  if (!known) look(x_, fresh);
  View& view = known ? *known : fresh;
  tidy(view);
  if (square(view.velocity) < 1e-16) {
    end_.flags |= flow_stationary;
    return ask(Phase::last, x_, warm_);
  }
  if (view.count == 1) return begin_ray(view.points[0], view.normals[0], view.distance, view.faces[0]);
  if (!(end_.flags & flow_slid)) {
    end_.flags |= flow_slid;
    end_.slide_time = t_;
    end_.slide_place = x_;
  }
  begin_slide(view);
}

} // namespace cowgpu::plan

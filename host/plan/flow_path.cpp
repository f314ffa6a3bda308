#include "host/plan/flow_path.hpp"

#include "host/plan/flow_steps.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cowgpu::plan {

namespace {

constexpr int most_rounds = 2000; // rounds of steps as long as the distance

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

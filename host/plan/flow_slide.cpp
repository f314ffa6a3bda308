// How a path of the distance's flow slides between several nearest points, and how it meets the next one.
#include "host/plan/flow_path.hpp"

#include "host/plan/flow_steps.hpp"

#include <algorithm>
#include <cmath>

namespace cowgpu::plan {

namespace {

// What a step may be multiplied by: errors per step go with its fourth power.
double longer(double allowed, double error) {
  return 0.9 * std::sqrt(std::sqrt(allowed / error));
}

} // namespace

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

} // namespace cowgpu::plan

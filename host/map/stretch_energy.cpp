#include "host/map/stretch_energy.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace cowgpu {

namespace {
constexpr double beyond = std::numeric_limits<double>::infinity();
}

StretchWeights stretch_weights(double side_a, double side_b, double side_c, double lambda, double softening) {
  side_a += softening, side_b += softening, side_c += softening;
  const double da = (side_b + side_c - side_a) / 2;
  const double db = (side_c + side_a - side_b) / 2;
  const double dc = (side_a + side_b - side_c) / 2;
  const double longest = std::max({side_a, side_b, side_c});
  const double area = std::sqrt(std::max(0.0, da * db + db * dc + dc * da)) / 2;
  const double floor = std::max(area, 1e-2 * longest), forward = std::max(area, 1e-4 * longest) / 8;
  return {{da, db, dc}, forward, lambda * forward / (floor * floor)};
}

double stretch_energy(const StretchWeights& w, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const double area = a.dot(ab.cross(ac)) / 2;
  if (!(area > 0)) return beyond;
  const double form = w.dot[0] * (c - b).squaredNorm() + w.dot[1] * ac.squaredNorm() + w.dot[2] * ab.squaredNorm();
  return form * (w.forward / (area * area) + w.backward);
}

Frame tangent_frame(const Vec3& x) {
  const Vec3 t = x.unitOrthogonal();
  Frame frame;
  frame.row(0) = t;
  frame.row(1) = x.cross(t);
  frame.row(2) = x;
  return frame;
}

StretchDerivatives stretch_derivatives(const StretchWeights& w, const std::array<Frame, 3>& frames) {
  const std::array<Vec3, 3> x = {frames[0].row(2), frames[1].row(2), frames[2].row(2)};
  Eigen::Matrix<double, 6, 1> form_gradient, area_gradient;
  Eigen::Matrix<double, 6, 6> form_hessian, area_hessian;
  form_hessian.setZero();
  area_hessian.setZero();
  double form = 0;
  const double area = x[0].dot((x[1] - x[0]).cross(x[2] - x[0])) / 2;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const auto tangents = frames[i].topRows<2>(), others = frames[j].topRows<2>();
    form += w.dot[i] * (x[j] - x[k]).squaredNorm();
    const Vec3 form_slope = 2 * (w.dot[k] * (x[i] - x[j]) + w.dot[j] * (x[i] - x[k]));
    const Vec3 area_slope = x[j].cross(x[k] - x[j]) / 2;
    form_gradient.segment<2>(2 * i) = tangents * form_slope;
    area_gradient.segment<2>(2 * i) = tangents * area_slope;
    // On the sphere the second derivative has the slope along x in it. The area's slope along x is the area itself.
    form_hessian.block<2, 2>(2 * i, 2 * i).diagonal().setConstant(2 * (w.dot[j] + w.dot[k]) - form_slope.dot(x[i]));
    area_hessian.block<2, 2>(2 * i, 2 * i).diagonal().setConstant(-area);
    const Eigen::Matrix2d form_mixed = -2 * w.dot[k] * tangents * others.transpose();
    Eigen::Matrix2d area_mixed; // det(s, t, x_k)/2
    for (int r = 0; r < 2; ++r)
      for (int c = 0; c < 2; ++c) area_mixed(r, c) = frames[i].row(r).dot(frames[j].row(c).cross(frames[k].row(2))) / 2;
    form_hessian.block<2, 2>(2 * i, 2 * j) = form_mixed;
    form_hessian.block<2, 2>(2 * j, 2 * i) = form_mixed.transpose();
    area_hessian.block<2, 2>(2 * i, 2 * j) = area_mixed;
    area_hessian.block<2, 2>(2 * j, 2 * i) = area_mixed.transpose();
  }
  const double inverse = 1 / area, square = w.forward * inverse * inverse;
  const double f = square + w.backward, f1 = -2 * square * inverse, f2 = 6 * square * inverse * inverse;
  StretchDerivatives d;
  d.energy = form * f;
  d.gradient = f * form_gradient + form * f1 * area_gradient;
  d.hessian = f * form_hessian + form * f1 * area_hessian + form * f2 * area_gradient * area_gradient.transpose() +
              f1 * (form_gradient * area_gradient.transpose() + area_gradient * form_gradient.transpose());
  return d;
}

void Star::set(const Vec3& x, std::span<const Vec3> ring, std::span<const StretchWeights> weights) {
  frame_ = tangent_frame(x);
  const std::size_t count = ring.size();
  local_.resize(count);
  wedges_.resize(count);
  double nearest = beyond;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 d = ring[i] - x, u = frame_ * d;
    local_[i] = {u[0], u[1], u[2]};
    const double square = u.squaredNorm();
    if (square > 0) nearest = std::min(nearest, square);
  }
  nearest_ = std::sqrt(nearest);
  for (std::size_t i = 0; i < count; ++i) {
    const auto& u = local_[i];
    const auto& v = local_[i + 1 == count ? 0 : i + 1];
    const StretchWeights& w = weights[i];
    const double bp = v[0] - u[0], bq = v[1] - u[1], bx = v[2] - u[2];
    const double uu = u[0] * u[0] + u[1] * u[1] + u[2] * u[2], vv = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    const double rim = bp * bp + bq * bq + bx * bx;
    Wedge& wedge = wedges_[i];
    wedge.area = (u[0] * v[1] - u[1] * v[0]) / 2;
    wedge.area_p = (u[1] * (1 + v[2]) - v[1] * (1 + u[2])) / 2;
    wedge.area_q = (v[0] * (1 + u[2]) - u[0] * (1 + v[2])) / 2;
    wedge.form = w.dot[0] * rim + w.dot[1] * vv + w.dot[2] * uu;
    wedge.form_p = -2 * (w.dot[1] * v[0] + w.dot[2] * u[0]);
    wedge.form_q = -2 * (w.dot[1] * v[1] + w.dot[2] * u[1]);
    wedge.form_delta = 2 * (w.dot[1] * (1 + v[2]) + w.dot[2] * (1 + u[2]));
    wedge.forward = w.forward;
    wedge.backward = w.backward;
    wedge.least_area = 1e-13 * std::min({uu + vv, rim + vv, rim + uu});
  }
}

double Star::energy(double p, double q) const {
  const double square = p * p + q * q, s2 = 1 + square, s = std::sqrt(s2), inverse = 1 / s;
  const double delta = square / (s2 + s), ps = p * inverse, qs = q * inverse;
  double sum = 0;
  for (const Wedge& w : wedges_) {
    const double area = (w.area + p * w.area_p + q * w.area_q) * inverse;
    if (!(area > w.least_area)) return beyond;
    const double form = w.form + ps * w.form_p + qs * w.form_q + delta * w.form_delta;
    sum += form * (w.forward / (area * area) + w.backward);
  }
  return sum;
}

double Star::derivatives(Eigen::Vector2d& gradient, Eigen::Matrix2d& hessian) const {
  double sum = 0, gp = 0, gq = 0, hpp = 0, hpq = 0, hqq = 0;
  for (const Wedge& w : wedges_) {
    const double inverse = 1 / w.area, square = w.forward * inverse * inverse;
    const double f = square + w.backward, f1 = -2 * square * inverse, f2 = 6 * square * inverse * inverse;
    sum += w.form * f;
    const double nf1 = w.form * f1, nf2 = w.form * f2;
    gp += f * w.form_p + nf1 * w.area_p;
    gq += f * w.form_q + nf1 * w.area_q;
    const double diagonal = f * w.form_delta - nf1 * w.area;
    hpp += diagonal + 2 * f1 * w.form_p * w.area_p + nf2 * w.area_p * w.area_p;
    hqq += diagonal + 2 * f1 * w.form_q * w.area_q + nf2 * w.area_q * w.area_q;
    hpq += f1 * (w.form_p * w.area_q + w.form_q * w.area_p) + nf2 * w.area_p * w.area_q;
  }
  gradient << gp, gq;
  hessian << hpp, hpq, hpq, hqq;
  return sum;
}

bool Star::newton_step(Eigen::Vector2d& to) const {
  Eigen::Vector2d gradient;
  Eigen::Matrix2d hessian;
  const double here = derivatives(gradient, hessian);
  if (!(here < beyond)) return false;
  // The Hessian with its eigenvalues mean +- radius made positive.
  const double mean = (hessian(0, 0) + hessian(1, 1)) / 2, half = (hessian(0, 0) - hessian(1, 1)) / 2;
  const double radius = std::sqrt(half * half + hessian(0, 1) * hessian(0, 1));
  const double largest = std::abs(mean) + radius;
  const double high = std::max(std::abs(mean + radius), 1e-3 * largest);
  const double low = std::max(std::abs(mean - radius), 1e-3 * largest);
  if (!(low > 0)) return false;
  // Its inverse is i0 + i1 [[half, h01], [h01, -half]].
  const double i0 = (1 / high + 1 / low) / 2, i1 = radius > 0 ? (1 / high - 1 / low) / (2 * radius) : 0;
  Eigen::Vector2d step;
  step[0] = -(i0 + i1 * half) * gradient[0] - i1 * hessian(0, 1) * gradient[1];
  step[1] = -i1 * hessian(0, 1) * gradient[0] - (i0 - i1 * half) * gradient[1];
  const double length = step.norm();
  if (!(length > 0 && length < beyond)) return false;
  if (length > 0.5) step *= 0.5 / length;
  const double slope = gradient.dot(step);
  double t = 1;
  for (int halvings = 0; halvings < 30; ++halvings, t /= 2)
    if (energy(t * step[0], t * step[1]) < here + 1e-4 * t * slope) {
      to = t * step;
      return true;
    }
  return false;
}

Vec3 Star::position(double p, double q) const {
  return (frame_.row(2) + p * frame_.row(0) + q * frame_.row(1)).transpose().normalized();
}

Eigen::Vector2d Star::coordinates(const Vec3& y) const {
  const Vec3 local = frame_ * y;
  return local.head<2>() / local[2];
}

} // namespace cowgpu

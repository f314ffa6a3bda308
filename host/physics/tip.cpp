#include "host/physics/tip.hpp"

#include "host/error.hpp"
#include "host/spectrum/reconstruct.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace cowgpu::physics {
namespace {

// Lengths below this part of the body are rounding.
constexpr double negligible = 1e-12;

double size_of(const RigidBody& body) {
  double size = 0;
  for (const Vec3& v : body.vertices) size = std::max(size, (v - body.centre).norm());
  return size;
}

void turn(Stance& stance, RigidBody& body) {
  const Eigen::Matrix3d& rotation = stance.attitude.rotation;
  if (rotation.isIdentity(0)) return;
  for (Vec3& v : body.vertices) v = rotation * v;
  body.centre = rotation * body.centre;
  body.quadrupole = rotation * body.quadrupole * rotation.transpose();
  stance.inertia = rotation * stance.inertia * rotation.transpose();
}

std::pair<double, double> z_range(const std::vector<Vec3>& points) {
  const auto [low, high] =
      std::minmax_element(points.begin(), points.end(), [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); });
  return {low->z(), high->z()};
}

// The longest edge of the triangles with a vertex that touches the ground.
double contact_spacing(const RigidBody& body, const std::vector<std::size_t>& touching) {
  std::vector<bool> touches(body.vertices.size(), false);
  for (const std::size_t v : touching) touches[v] = true;
  double longest = 0;
  for (const Face& face : body.faces)
    for (std::size_t c = 0; (touches[face[0]] || touches[face[1]] || touches[face[2]]) && c < 3; ++c)
      longest = std::max(longest, (body.vertices[face[c]] - body.vertices[face[(c + 1) % 3]]).norm());
  return longest;
}

// Whether the foot that a body would turn about is under its barycentre; the only foot always is.
bool rolls_over(const Stance& stance, const Vec3& support) {
  const double z = stance.body.centre.z();
  if (stance.feet.size() == 1) return true;
  for (const Foot& foot : stance.feet)
    if (foot.left <= support.z() && support.z() <= foot.right && foot.left <= z && z <= foot.right) return true;
  return false;
}

// The support point farthest to a side; of several the one nearest to the barycentre fore and aft.
Vec3 farthest(const std::vector<Vec3>& support, double sign, const Vec3& barycentre, double noise) {
  Vec3 best = support.front();
  for (const Vec3& p : support) {
    const double more = sign * (p.z() - best.z());
    const bool nearer = std::abs(p.x() - barycentre.x()) < std::abs(best.x() - barycentre.x());
    if (more > noise || (more > -noise && nearer)) best = p;
  }
  return best;
}

// The balance about the barycentre in space, with the arm |(p - b) x y|.
std::optional<double> literal_force(const RigidBody& body, const Vec3& p, double sign) {
  const Vec3 q = (body.centre - p).normalized();
  const auto hit = last_hit(body, p, q);
  if (!hit) return std::nullopt;
  const Vec3 n = sign * q.cross(-Vec3::UnitX()).normalized();
  const double arm = std::hypot(p.x() - body.centre.x(), p.z() - body.centre.z());
  return arm / ((p + *hit * q - body.centre).norm() + n.y() * arm);
}

} // namespace

RigidBody smooth_body(const TriangleSurface& surface, double mass, std::string& note) {
  RawMesh mesh;
  mesh.name = surface.name;
  mesh.vertices = surface.vertices;
  mesh.faces = surface.faces;
  if (volume(mesh.vertices, mesh.faces) < 0) {
    for (Face& face : mesh.faces) std::swap(face[1], face[2]);
    note = "inside out; turned";
  }
  ClosedSurface closed = ClosedSurface::from(std::move(mesh));
  const double density = mass / volume(closed);
  RigidBody body = solid_body(make_body(std::move(closed), {}, density));
  body.smooth = true;
  return body;
}

RigidBody ball_like(const RigidBody& body, double volume) {
  const SphereTriangulation sphere = icosphere(4);
  const double radius = std::cbrt(3 * volume / (4 * std::numbers::pi));
  TriangleSurface ball;
  ball.faces = sphere.faces;
  for (const Vec3& direction : sphere.directions) ball.vertices.emplace_back(body.centre + radius * direction);
  std::string note;
  return smooth_body(ball, body.mass, note);
}

Stance stand(RigidBody body, const StandOptions& options, const Monitor& monitor) {
  Stance stance;
  stance.inertia = body.inertia();
  if (!options.as_modelled) {
    stance.attitude = settle(body.vertices, body.centre, monitor);
    turn(stance, body);
  }
  const double size = size_of(body);
  stance.contact = contact(body.vertices, body.centre, options.contact_tolerance);
  const auto [left, right] = z_range(stance.contact.support);
  const double z = body.centre.z();
  double slack = 1e-9 * size;
  if (body.smooth) {
    stance.feet = feet(body.vertices, body.faces, stance.contact.vertices, stance.contact.ground, size);
    if (stance.feet.size() == 1) slack = contact_spacing(body, stance.contact.vertices);
  }
  if (z < left - slack || z > right + slack)
    throw Error(
        Fault::cannot_stand,
        fmt::format("the body cannot stand: it falls to the {} unpushed, its barycentre, at z = {:.6g}, not being "
                    "between the points that touch the ground, at z = {:.6g} to {:.6g}{}",
                    z < left ? "left" : "right", z, left, right,
                    options.as_modelled ? "; leave --as-modelled out to let it settle, or raise --contact-tolerance"
                                        : ""));
  stance.held = stance.contact.margin < -std::max(slack, 1e-9 * size);
  stance.body = std::move(body);
  return stance;
}

std::string name(Side side) {
  return side == Side::left ? "left" : "right";
}

double Tipping::balance_angle() const {
  return std::atan2(offset, height);
}

double Tipping::slip_force(double mu) const {
  return mu / (std::abs(direction.z()) + mu * direction.y());
}

Tipping tipping(const Stance& stance, Side side) {
  const RigidBody& body = stance.body;
  const double sign = side == Side::right ? 1 : -1, size = size_of(body);
  const Vec3& b = body.centre;
  Tipping t;
  t.side = side;
  t.support = farthest(stance.contact.support, sign, b, negligible * size);
  t.pivot = {b.x(), t.support.y(), t.support.z()};
  t.rolls = rolls_over(stance, t.support);
  if (t.rolls) t.support = t.pivot = {b.x(), stance.contact.ground, b.z()};
  t.offset = std::max(sign * (t.pivot.z() - b.z()), 0.0);
  if (t.offset <= negligible * size) t.offset = 0;
  t.height = b.y() - t.pivot.y();
  t.radius = std::hypot(t.offset, t.height);
  if (!(t.height > 0))
    throw Error(Fault::cannot_stand, "the body cannot stand: its barycentre is not above the ground");
  const Vec3 q(0, t.height / t.radius, -sign * t.offset / t.radius);
  t.direction = {0, t.offset / t.radius, sign * t.height / t.radius};
  const auto hit = last_hit(body, t.pivot, q);
  if (!hit)
    throw Error(Fault::cannot_stand, "the ray from the pivot through the barycentre meets no surface, so there is no "
                                     "point to push at: the barycentre lies outside the body");
  t.lever = *hit;
  t.point = t.pivot + t.lever * q;
  t.force = t.offset / t.lever;
  const double above = std::abs(t.lever - t.radius), paper = above + t.direction.y() * t.offset;
  t.force_paper_balance = t.offset == 0 ? 0 : t.offset / paper;
  t.force_paper_literal = literal_force(body, t.support, sign);
  t.friction_needed = t.force * std::abs(t.direction.z()) / (1 - t.force * t.direction.y());
  t.inertia = stance.inertia(0, 0) + body.mass * t.radius * t.radius;
  return t;
}

Rocker rocker(double mass, const Tipping& tipping, double gravity, bool turns_with_body) {
  return {mass, gravity, tipping.inertia, tipping.radius, tipping.balance_angle(), tipping.lever, turns_with_body};
}

Side weaker_side(const Tipping& left, const Tipping& right) {
  return left.force < right.force * (1 - 1e-12) ? Side::left : Side::right;
}

std::optional<double> last_hit(const RigidBody& body, const Vec3& start, const Vec3& direction) {
  // Moeller and Trumbore, J. Graphics Tools 2 (1997) 21; triangles are a little wider than they are, so that none is missed
  // between two.
  const double reach = negligible * size_of(body);
  std::optional<double> last;
  for (const Face& face : body.faces) {
    const Vec3& a = body.vertices[face[0]];
    const Vec3 e1 = body.vertices[face[1]] - a, e2 = body.vertices[face[2]] - a;
    const Vec3 p = direction.cross(e2), s = start - a;
    const double det = e1.dot(p);
    if (std::abs(det) <= negligible * e1.norm() * e2.norm()) continue; // seen edge on: its neighbours are met
    const double u = s.dot(p) / det;
    if (u < -negligible || u > 1 + negligible) continue;
    const Vec3 q = s.cross(e1);
    const double v = direction.dot(q) / det;
    if (v < -negligible || u + v > 1 + negligible) continue;
    const double t = e2.dot(q) / det;
    if (t > reach && (!last || t > *last)) last = t;
  }
  return last;
}

} // namespace cowgpu::physics

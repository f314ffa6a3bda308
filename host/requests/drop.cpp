#include "host/requests/drop.hpp"

#include "host/bounds.hpp"
#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu {

using namespace physics;

namespace {

constexpr long double degree = std::numbers::pi_v<long double> / 180;

// The least turn that brings the feet down, about x where it is a half turn.
LongMat3 feet_down(const Vec3& feet) {
  if (feet == -Vec3::UnitY()) return LongMat3::Identity();
  if (feet == Vec3::UnitY()) return turn_about(Vec3::UnitX(), 180);
  return Eigen::Quaternion<long double>::FromTwoVectors(feet.cast<long double>(), -LongVec3::UnitY())
      .toRotationMatrix();
}

LongMat3 attitude_of(const DropRequest& request) {
  if (const LongMat3* rotation = std::get_if<LongMat3>(&request.attitude)) return *rotation;
  const Held held = std::get<Held>(request.attitude);
  const double quarters = held == Held::upside_down ? 2 : held == Held::on_side ? 1 : 0;
  return turn_about(Vec3::UnitX(), 90 * quarters) * feet_down(request.feet);
}

double tilt(const LongMat3& attitude, const Vec3& feet) {
  const LongVec3 f = attitude * feet.cast<long double>();
  return double(std::atan2(std::hypot(f.x(), f.z()), -f.y()) / degree);
}

std::vector<Vec3> corners_of(const ClosedSurface& surface) {
  std::vector<Vec3> corners;
  for (const Face& face : surface.faces())
    for (const std::uint32_t corner : face) corners.push_back(surface.vertices()[corner]);
  return corners;
}

// Corners of what is solid, from the centre of mass, each once.
std::vector<Vec3> corners_of(const Body& body) {
  std::vector<Vec3> vertices = corners_of(body.surface);
  for (const Part& part : body.parts) {
    const std::vector<Vec3> more = corners_of(part.surface);
    if (part.density > 0) vertices.insert(vertices.end(), more.begin(), more.end());
  }
  std::sort(vertices.begin(), vertices.end(), [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (Vec3& v : vertices) v -= body.centre_of_mass;
  return vertices;
}

} // namespace

DropOutcome drop(const DropRequest& request, Monitor& monitor) {
  if (is_coefficient_file(request.body.mesh))
    throw Error(
        Fault::file_format,
        fmt::format("{} holds coefficients, which do not say where the body's lowest point is; `drop` needs the mesh",
                    request.body.mesh));
  check_direction(request.feet, "the direction of the feet");
  if (const auto* held = std::get_if<Held>(&request.attitude)) require_member("the attitude is", *held, Held::on_side);
  if (const auto* attitude = std::get_if<physics::LongMat3>(&request.attitude))
    check_rotation(attitude->cast<double>(), "the attitude");
  check_multipole_order(request.order);
  const LoadedMass loaded = load_mass(request.body, Motion::free, monitor);
  require_units(loaded);
  const std::vector<Vec3> vertices = corners_of(*loaded.mesh);
  DropProblem problem;
  problem.body = free_body(loaded, request.order, monitor);
  problem.height = request.height;
  problem.attitude = attitude_of(request);
  problem.spin = request.spin;
  problem.vertices = vertices;
  DropOutcome outcome;
  outcome.subject = subject(loaded);
  outcome.fall = physics::drop(problem, monitor);
  outcome.body = problem.body;
  outcome.height = request.height;
  outcome.spin = request.spin;
  outcome.feet = request.feet;
  outcome.touch = vertices[outcome.fall.touching];
  outcome.tilt_before = tilt(problem.attitude, request.feet);
  outcome.tilt_after = tilt(outcome.fall.attitude, request.feet);
  return outcome;
}

} // namespace cowgpu

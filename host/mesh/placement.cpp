#include "host/mesh/placement.hpp"

#include "host/error.hpp"
#include "host/mesh/closed_surface.hpp"
#include "host/mesh/weld.hpp"

#include <fmt/format.h>

#include <Eigen/LU>

namespace cowgpu {

void place(RawMesh& mesh, const Placement& placement) {
  const double metre = placement.units.metre;
  if (metre != 1) {
    if (!seems_balanced(mesh.faces)) ClosedSurface::from(mesh); // which refuses it with lengths in the file's unit
    for (Vec3& v : mesh.vertices) v *= metre;
    mesh.notes.push_back(fmt::format("lengths are metres: coordinates times {}", metre));
  }
  if (!placement.rotation.isIdentity(0)) {
    const Eigen::Matrix3d& r = placement.rotation;
    // Row by row, so that a signed permutation adds exact zeros only.
    for (Vec3& v : mesh.vertices) v = Vec3(r.row(0).dot(v), r.row(1).dot(v), r.row(2).dot(v));
    mesh.notes.push_back(fmt::format(
        "the body is turned: x' = ({:.6g} {:.6g} {:.6g}), y' = ({:.6g} {:.6g} {:.6g}), z' = ({:.6g} {:.6g} {:.6g})",
        r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)));
  }
}

void check_rotation(const Eigen::Matrix3d& r, std::string_view what) {
  const double departure = (r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (r.allFinite() && departure <= 1e-9 && r.determinant() > 0) return;
  throw Error(Fault::bad_argument,
              fmt::format("{} is not a rotation: R R^T differs from 1 by {:.3g}, the determinant is {:.3g}; 1e-9 and a "
                          "positive one are asked for",
                          what, departure, r.determinant()));
}

void check_direction(const Vec3& direction, std::string_view what) {
  if (std::abs(direction.norm() - 1) <= 1e-9) return;
  throw Error(Fault::bad_argument, fmt::format("{} ({}, {}, {}) must be a vector of length 1", what, direction.x(),
                                               direction.y(), direction.z()));
}

Eigen::Matrix3d axes_rotation(std::string_view text) {
  const auto refuse = [&](const char* why) {
    return Error(Fault::bad_argument,
                 fmt::format("--axes {}: {}; name the mesh's axes that become x, y and z, such as x,-z,y", text, why));
  };
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();
  std::string_view rest = text;
  for (int row = 0; row < 3; ++row) {
    const std::size_t comma = rest.find(',');
    if ((comma == std::string_view::npos) != (row == 2)) throw refuse("it takes three axes");
    std::string_view word = rest.substr(0, comma);
    if (comma != std::string_view::npos) rest.remove_prefix(comma + 1);
    const double sign = word.starts_with('-') ? -1 : 1;
    if (word.starts_with('-') || word.starts_with('+')) word.remove_prefix(1);
    if (word != "x" && word != "y" && word != "z") throw refuse("axes are x, y and z, with a sign or without");
    rotation(row, word[0] - 'x') = sign;
  }
  if (std::abs(rotation.determinant()) < 0.5) throw refuse("an axis is named twice");
  if (rotation.determinant() < 0) throw refuse("these axes are left-handed and would make the body its mirror image");
  return rotation;
}

} // namespace cowgpu

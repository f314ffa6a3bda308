// From the coordinates of a file to those of a body: unit, axes, attitude.
#pragma once

#include "host/mesh/raw_mesh.hpp"
#include "host/units.hpp"

#include <Eigen/Core>

#include <string_view>

namespace cowgpu {

/// p -> rotation (units.metre p). The rotation is exact where it only names axes anew; any other rounds coordinates once.
struct Placement {
  Units units; ///< a mass is the body's to add (Body::units())
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();

  bool is_identity() const { return units.metre == 1 && rotation.isIdentity(0); }
};

/// Moves a mesh; its hash stays that of the file, and a note says what was done. Coordinates that leave the range of doubles
/// become infinite, which ClosedSurface::from() refuses.
void place(RawMesh& mesh, const Placement& placement);

/// Throws Error(bad_argument), which begins with `what`, unless R R^T is 1 to 1e-9 and the determinant positive.
void check_rotation(const Eigen::Matrix3d& r, std::string_view what);

/// Throws Error(bad_argument), which begins with `what`, unless the length is 1 to 1e-9.
void check_direction(const Vec3& direction, std::string_view what);

/// The rotation that makes the mesh's axes named by `text` the x, y and z axes: three of x, y, z, -x, -y, -z separated by
/// commas, "x,-z,y" for new x = x, new y = -z, new z = y. Throws Error(bad_argument) for other words, an axis named twice,
/// and axes of the other hand: they would make the body its mirror image.
Eigen::Matrix3d axes_rotation(std::string_view text);

} // namespace cowgpu

// Exact moments of triangles, lanes are faces.
#pragma once

#include "host/plan/solid_harmonics.hpp"
#include "host/types.hpp"

#include <cstddef>
#include <span>

namespace cowgpu::plan {

inline constexpr std::size_t face_group = 8;

/// Faces side by side: corners, twice the area times the outward normal n, that times n.y, y seen from the body's origin, the
/// area. Unused ones have area 0 and their corners at some used one's.
struct alignas(64) FaceGroup {
  double a[3][face_group], b[3][face_group], c[3][face_group];
  double weights[4][face_group];
  double area[face_group];
};

/// Doubles that add_face_moments() works in.
inline constexpr std::size_t moment_groups = 4; // groups worked on together
inline constexpr std::size_t moment_room(int order) {
  return moment_groups * face_group * 12 * std::size_t(order + 4);
}

/// Adds to `moments`, [harmonic][4], the integrals of R_lm(y - centre) times n_x, n_y, n_z and n.y over the faces.
void add_face_moments(std::span<const FaceGroup> groups, const Vec3& centre, int order, double* room, double* moments);

struct FaceReach {
  double radius = 0; ///< largest distance of a corner
  double moment = 0; ///< integral over the faces, or more, of that distance to some power
};
FaceReach face_reach(std::span<const FaceGroup> groups, const Vec3& centre, int power);

} // namespace cowgpu::plan

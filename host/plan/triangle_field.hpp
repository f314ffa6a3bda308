// Distances from single triangles, and which triangle of a mesh is nearest: what the flow asks of a surface.
#pragma once

#include "host/plan/bvh.hpp"
#include "host/types.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// Where on a triangle its closest point lies.
enum class Region : std::uint8_t { face, edge, corner };

/// The closest point of one triangle.
struct Foot {
  Vec3 point = Vec3::Zero();
  double distance = 0;
  Region region = Region::face;
};

/// A mesh's triangles, each in a frame of its own, so that distances need no quotient; and their hierarchy. Reading is
/// safe from several threads.
class TriangleField {
public:
  static constexpr std::uint32_t none = 0xffffffffu;

  /// Indices valid, coordinates finite, at least one face; else Error(bad_argument). Copies what it needs.
  TriangleField(std::span<const Vec3> vertices, std::span<const Face> faces);

  std::size_t size() const { return frames_.size(); }
  double scale() const { return scale_; } ///< the diagonal of the bounding box
  const Vec3& low() const { return low_; }
  const Vec3& high() const { return high_; }

  /// Unit normal, outwards; zero for a face without area.
  const Vec3& normal(std::uint32_t face) const { return frames_[face].n; }

  Foot foot(std::uint32_t face, const Vec3& x) const;
  double distance2(std::uint32_t face, const Vec3& x) const;

  /// A face with the least distance from x. `warm` is a first guess, best a face near x. Of equally near ones it may be any.
  std::uint32_t nearest(const Vec3& x, std::uint32_t warm = none) const;

  /// How often the surface winds round x (positive inside): crossings along a ray, or, where a ray grazes an edge, the sum
  /// of solid angles (van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125). For a closed surface, x off it.
  int winding_number(const Vec3& x) const;

private:
  struct Frame {
    Vec3 a, u, v, n;      ///< corner, unit vectors along ab, in the plane, normal
    double length;        ///< of ab
    double cx, cy, per_ac; ///< c in the frame, 1 / |ac|^2 (0 for a point)
    double ex, ey, per_bc; ///< c - b
    bool flat;            ///< without area: never inside
  };
  int solid_angle_winding(const Vec3& x) const;

  std::vector<Frame> frames_;
  Bvh tree_;
  Vec3 low_, high_;
  double scale_ = 0;
};

} // namespace cowgpu::plan

// What a map to the sphere is worth.
#pragma once

#include "host/map/sphere_map.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace cowgpu {

/// A connected set of triangles that a grid cannot see.
struct UnseenPart {
  std::size_t triangles = 0;
  double area = 0;            ///< its part of the surface's area
  Vec3 middle = Vec3::Zero(); ///< its centroid, in mesh coordinates
};

/// Findings on a map. "By area" weighs triangles by their area on the surface, so that a quantile is a part of the
/// surface; a quantile p is the least value that triangles of at least the part p do not exceed.
struct MapQuality {
  std::size_t triangles = 0;
  /// Sum of the signed solid angles over 4 pi: near 1 for a map of degree 1 whatever it folds, so no test of
  /// bijectivity; near -1 for a map that is inside-out.
  double degree = 0;
  bool inside_out = false;            ///< degree < 0
  std::vector<std::uint32_t> flipped; ///< faces that run against the map's orientation (exact signs), ascending
  std::vector<std::uint32_t> flat;    ///< faces of exactly no area on the sphere, ascending
  double flipped_area = 0;            ///< solid angle of the flipped ones over 4 pi

  /// log10 of a triangle's part of the sphere over its part of the surface, by area: at 0 (the least), 5, 25, 50, 95 and
  /// 100 %. Not less than smallest_log_ratio.
  std::array<double, 6> log_area_ratio{};
  /// Ratio of the singular values (1: angles are kept) of the linear map from the triangle to the chord triangle, by area:
  /// at 50, 95, 99 and 100 %. Infinity for a triangle of no area.
  std::array<double, 4> shear{};

  double smallest_area = 0; ///< solid angle, steradians
  std::uint32_t smallest_area_face = 0;
  double smallest_height = 0; ///< smallest angle between a corner and the opposite great circle, radians
  std::uint32_t smallest_height_face = 0;

  int lmax = 0;
  double cell = 0;               ///< pi / (2 lmax), radians: the distance between rings of a grid of 2 lmax
  std::size_t unseen = 0;        ///< triangles whose height is below a cell
  double unseen_area = 0;        ///< their part of the surface's area
  std::vector<UnseenPart> parts; ///< what the unseen ones form, largest area first

  std::vector<std::string> sentences; ///< the same in words
};

inline constexpr double smallest_log_ratio = -300;
/// What log_area_ratio and shear are quantiles at.
inline constexpr std::array log_area_ratio_parts = {0.0, 0.05, 0.25, 0.5, 0.95, 1.0};
inline constexpr std::array shear_parts = {0.5, 0.95, 0.99, 1.0};

/// Judges a map for a grid that expands to degree lmax >= 1. Throws Error(bad_argument) where the map does not belong to
/// the surface (another number of vertices), is not finite, or lmax < 1.
MapQuality judge(const ManifoldSurface& surface, const SphereMap& map, int lmax);

/// The signed solid angle of the spherical triangle a, b, c (A. van Oosterom, J. Strackee, IEEE Trans. Biomed. Eng. 30
/// (1983) 125), between -2 pi and 2 pi; differences are formed first, so that tiny triangles keep their digits.
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c);

} // namespace cowgpu

// Reference of the stage `sample`: every point against every triangle, in an exact number type: the oracle of both fast
// paths.
#pragma once

#include "host/sphere_directions.hpp"
#include "host/types.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::reference {

template <class Number>
Number determinant(const Vec3& a, const Vec3& b, const Vec3& c) {
  Number sum(0);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    sum += Number(a[i]) * (Number(b[j]) * Number(c[k]) - Number(b[k]) * Number(c[j]));
  }
  return sum;
}

/// The sign of det(a, b, c) of vectors no longer than 2, exact where Number is; what is ten times the rounding error
/// decides at once.
template <class Number>
int determinant_sign(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double quick = determinant<double>(a, b, c);
  if (std::abs(quick) > 1e-14) return quick > 0 ? 1 : -1;
  const Number exact = determinant<Number>(a, b, c);
  return exact > Number(0) ? 1 : exact < Number(0) ? -1 : 0;
}

inline constexpr std::uint32_t no_face = 0xffffffff;

/// What one direction meets.
struct Sample {
  std::uint32_t face = no_face;    ///< least (flipped, face) of the triangles that hold the direction
  bool flipped = false;            ///< whether that face is flipped
  bool edge = false;               ///< the direction lies on its edge or corner
  unsigned inside = 0;             ///< triangles that hold it inside
  std::array<double, 3> weights{}; ///< barycentric coordinates of the face's corners, rounded once
};

/// A map, to be asked for one direction after the other. Number: exact for sums of products of three doubles, such as a
/// rational.
template <class Number>
class Sampler {
public:
  /// Keeps references to both.
  Sampler(std::span<const Vec3> positions, std::span<const Face> faces) : positions_(positions), faces_(faces) {
    for (const Face& f : faces)
      signs_.push_back(determinant_sign<Number>(positions[f[0]], positions[f[1]], positions[f[2]]));
  }

  /// Signs of det(a, b, c), one a face.
  const std::vector<int>& signs() const { return signs_; }

  Sample operator()(const Vec3& d) const {
    Sample best;
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
      const Vec3 &a = positions_[faces_[f][0]], &b = positions_[faces_[f][1]], &c = positions_[faces_[f][2]];
      if (signs_[f] == 0) continue;
      const int u = signs_[f] * determinant_sign<Number>(d, b, c);
      if (u < 0) continue;
      const int v = signs_[f] * determinant_sign<Number>(d, c, a);
      if (v < 0) continue;
      const int w = signs_[f] * determinant_sign<Number>(d, a, b);
      if (w < 0) continue;
      const bool edge = u == 0 || v == 0 || w == 0;
      if (!edge) ++best.inside;
      if (best.face != no_face && !(best.flipped && signs_[f] > 0)) continue;
      best.face = f;
      best.flipped = signs_[f] < 0;
      best.edge = edge;
    }
    if (best.face == no_face) return best;
    const Face& face = faces_[best.face];
    const Vec3 &a = positions_[face[0]], &b = positions_[face[1]], &c = positions_[face[2]];
    const Number u = determinant<Number>(d, b, c), v = determinant<Number>(d, c, a), w = determinant<Number>(d, a, b);
    const Number sum = u + v + w;
    best.weights = {static_cast<double>(Number(u / sum)), static_cast<double>(Number(v / sum)),
                    static_cast<double>(Number(w / sum))};
    return best;
  }

private:
  std::span<const Vec3> positions_;
  std::span<const Face> faces_;
  std::vector<int> signs_;
};

} // namespace cowgpu::reference

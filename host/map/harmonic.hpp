// The harmonic map of a genus-0 surface to the sphere, through a disk.
#pragma once

#include "host/map/laplacian.hpp"
#include "host/map/sphere_map.hpp"
#include "host/monitor.hpp"

#include <cstdint>
#include <optional>

namespace cowgpu {

/// Which vertex is taken out to make the surface a disk.
struct Pole {
  enum class Rule {
    vertex, ///< the one named
    point,  ///< the one nearest to a point
    back,   ///< the middle of the top: nearest to where the ray along +y from the middle of the bounding box last
            ///< leaves the body or, where it does not meet the body, to where it leaves the box
  };
  Rule rule = Rule::back;
  std::uint32_t vertex = 0;  ///< for Rule::vertex; counted from 0
  Vec3 point = Vec3::Zero(); ///< for Rule::point; in mesh coordinates
};

/// The vertex that a pole means; of several equally near, the one of smallest index. Throws Error(bad_argument) for a
/// vertex that does not exist or belongs to no face, or a point that is not finite.
std::uint32_t pole_vertex(const ManifoldSurface& surface, const Pole& pole);

struct HarmonicOptions {
  EdgeWeights weights = EdgeWeights::cotangent;
  Pole pole;
  /// The unit disk is multiplied by this before it is wrapped round the sphere. 0: by the number that brings half of the
  /// surface's area to each side of the equator. Centring undoes it.
  double disk_scale = 0;
  /// The Moebius transformation that moves the mean direction (by surface area) to the sphere's centre.
  bool centre = false;
  /// Go on to the map that is harmonic on the whole sphere (implies centre): the result depends on the pole no more, and
  /// angles are kept as well as the mesh allows. Without it the disk's boundary leaves shear round the pole. Symmetric
  /// weights only. Nothing: where that is possible and neither a scale nor centring alone is asked for; where it fails, on
  /// triangles too thin for it, the map is centred instead and a note says so.
  std::optional<bool> polish;
  /// Rotate the sphere so that directions on it look like those from the middle of the body (moebius.hpp). Otherwise the
  /// pole is at (0, 0, -1) and the vertex of smallest index among its neighbours has azimuth 0.
  bool align = true;
};

/// Takes the pole out; lays its neighbours on the unit circle, by arc length, from angle 0 at the neighbour of smallest
/// index, in the order of the boundary that the other faces have (counter-clockwise); solves L w = 0 for the others
/// (M. Eck et al., SIGGRAPH 1995, 173); multiplies by the scale and wraps the plane round the sphere with the pole at
/// infinity (S. Haker et al., IEEE Trans. Vis. Comput. Graph. 6 (2000) 181). The orientation is kept. Where cotangent
/// weights are negative, triangles may come out flipped: judge() in host/map/quality.hpp counts them.
///
/// Throws Error: map_topology unless the surface is one sphere; bad_argument for the pole or a scale that is not
/// positive; map_failed where weights or the system fail (laplacian.hpp, solve.hpp, moebius.hpp);
/// interrupted, between the parts of the solution and the steps of the polish.
SphereMap harmonic_map(const ManifoldSurface& surface, const HarmonicOptions& options = {},
                       Monitor& monitor = silent_monitor());

} // namespace cowgpu

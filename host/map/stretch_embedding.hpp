// The way up from a tetrahedron: vertices return to the sphere and are relaxed. Part of stretch.hpp.
#pragma once

#include "host/map/collapse.hpp"
#include "host/map/stretch_energy.hpp"
#include "host/monitor.hpp"

#include <span>
#include <vector>

namespace cowgpu {

class StretchEmbedding {
public:
  /// Of a surface of area 4 pi, by points and rings (see CanonicalSurface).
  StretchEmbedding(std::span<const Vec3> points, std::vector<std::vector<std::uint32_t>> rings, double lambda);

  /// Down to a tetrahedron and up again. Throws Error(Fault::map_failed) if a vertex finds no place, or interrupted.
  void build(Monitor& monitor);
  /// Relaxes every vertex once, in the order in which they came; returns the largest move, in units of the distance to
  /// the nearest neighbour on the sphere.
  double sweep();

  const std::vector<Vec3>& positions() const { return positions_; }
  const VertexRings& rings() const { return rings_; }

private:
  void place_tetrahedron();
  void insert(Collapse&& step);
  double relax(std::uint32_t v, int steps);
  void set_star(std::uint32_t v, const Vec3& centre);

  std::span<const Vec3> points_;
  VertexRings rings_;
  double lambda_;
  std::vector<Vec3> positions_;
  std::vector<std::uint32_t> present_; // in the order in which they came
  Star star_;
  std::vector<Vec3> ring_positions_;
  std::vector<StretchWeights> weights_;
};

} // namespace cowgpu

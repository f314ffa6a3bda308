// Whether a stretch map is one that other numberings and poses of its body come to as well.
#pragma once

#include "host/map/stretch.hpp"

#include <cstdint>
#include <vector>

namespace cowgpu {

/// The map of one copy of the body.
struct StretchRepeat {
  std::uint32_t seed = 0; ///< seed of the numbering and the rotation
  double energy = 0;      ///< as in StretchMeasure
  double largest = 0;     ///< distance of a vertex, turned back, from where the map has it
  double rms = 0;         ///< the same, root mean square by the surface's area
  bool reached = false;   ///< the energy is the map's to same_minimum
};

/// Two energies whose ratio is this near to 1 count as one minimum.
inline constexpr double same_minimum = 1e-6;

/// Numbers vertices and faces of the surface anew at random, turns it at random, maps it with the same options, and turns
/// the map back: `count` times, with seeds 1, 2, ... Numbering alone changes nothing (canonical_surface.hpp); the rotation
/// changes how every number is rounded. Copies are mapped on `threads` threads (0: all), each about as long as the first
/// map took. Throws what stretch_map() throws.
std::vector<StretchRepeat> repeat_stretch_map(const ManifoldSurface& surface, const SphereMap& map,
                                              const StretchOptions& options, unsigned count, unsigned threads,
                                              Monitor& monitor);

} // namespace cowgpu

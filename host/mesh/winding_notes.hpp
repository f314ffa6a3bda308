// What is odd about how often a body's surface winds round its parts, in sentences.
#pragma once

#include "host/mesh/closed_surface.hpp"
#include "host/monitor.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace cowgpu {

/// Up to so many faces volumes are measured; beyond, shells are looked at as wholes.
inline constexpr std::size_t most_measured_faces = 20000;

/// Notes for who takes the surface for a body, whose integrals weigh every region by the winding number:
///
/// - shells that look inwards and lie outside of all others, or in cavities: their volume is subtracted;
/// - volume that is counted twice or more, and volume that is inside out: measured by overlap() up to `most_measured_faces`
///   faces, and told with its part of the whole where it is above its uncertainty and a millionth of the volume. Beyond,
///   shells that are the same or lie inside others and yet look outwards are named; that no more was looked for is said.
///
/// Where volume is subtracted the option that mends it is named, if one does (cure_of_shells()).
///
/// A shell (topology.hpp) lies inside others where their surfaces wind about its first face, those of the same box and
/// volume set apart. With more than 64 shells that need this, the others are left out, and said to be. Empty for the
/// surfaces that most bodies have. Built-in bodies, which are sound, are not looked at. Time: some microseconds a face.
/// Throws Error(interrupted).
std::vector<std::string> winding_notes(const ClosedSurface& surface, Monitor& monitor, unsigned threads = 0);

/// All notes on a surface that a command works on: of its reading and mending, and these. Throws Error(interrupted).
std::vector<std::string> body_notes(const ClosedSurface& surface, Monitor& monitor, unsigned threads = 0);

} // namespace cowgpu

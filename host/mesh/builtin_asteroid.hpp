// Bodies that look like asteroids, made of random numbers and a seed.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <cstdint>

namespace cowgpu {

/// A Gaussian random sphere (K. Muinonen, Astron. Astrophys. 332 (1998) 1087) with craters. The radius in the direction n is
/// e(n) exp(s(n)) k(n): e of an ellipsoid of semi-axes 1.28, 1 and 0.84 along x, y and z; s a random field of spherical
/// harmonics of degrees 2 to 40, whose variance falls with the degree; k of some 160 craters with rims, most of them small.
/// Vertices are the `sphere`'s, whose own must be unit vectors, moved along their directions: as the surface has one point in
/// each direction, it is closed and does not intersect itself where the sphere is and does not.
///
/// The same seed gives the same bits everywhere: nothing but sums, products, quotients and roots is used, and a sum of twelve
/// uniform numbers stands for each Gaussian one. A vertex depends on its direction and the seed alone, so that a finer sphere
/// only adds vertices.
RawMesh asteroid(RawMesh sphere, std::uint64_t seed);

/// A contact binary: two lobes, each an ellipsoid made rough in the way above about its own centre, joined by a neck at the
/// origin on the x axis. The larger one lies at negative x. Rays from the origin leave the body once, so all that is said above
/// holds here too.
RawMesh contact_binary(RawMesh sphere, std::uint64_t seed);

} // namespace cowgpu

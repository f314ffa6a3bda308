// Bodies made here rather than read: what a user may write after "builtin:" where a mesh file is expected.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

/// A body as help texts list it.
struct BuiltinBody {
  std::string name;        ///< "sphere"
  std::string usage;       ///< "sphere[:R][@LEVEL]"
  std::string description; ///< one line, with sizes, levels and defaults
};

/// All bodies, in the order to list them.
const std::vector<BuiltinBody>& builtin_bodies();

/// No body has more faces than this.
inline constexpr std::uint64_t builtin_face_limit = std::uint64_t{1} << 26;

/// Makes a body. `spec` is what follows "builtin:", in this grammar, without spaces:
///
///     spec   = name [":" (size {"," size} | seed)] ["@" level]
///     name   = "cow" | "sphere" | "ellipsoid" | "box" | "tetrahedron" | "asteroid" | "binary"
///     size   = a decimal number as C++ writes it ("2", "0.5", "1e-3"), from 1e-30 to 1e30; the sizes of one body
///              differ by a factor of at most 1e6
///     seed   = decimal digits, from 0 to 4294967295
///     level  = decimal digits
///
///     body         sizes              levels   default      faces at level L, and how they are made
///     cow          none               0 .. 8   @3           820 4^L: Loop subdivision of cow_cage()
///     sphere       radius             0 .. 9   :1@4         20 4^L: icosahedron, midpoints pushed to the sphere
///     ellipsoid    semi-axes x, y, z  0 .. 9   @4           20 4^L: the sphere's vertices, scaled; sizes required
///     box          edges x, y, z      0 .. 11  :1,1,1@0     12 4^L: split at midpoints, the surface unchanged
///     tetrahedron  edge               0 .. 12  :1@0         4 4^L: regular, split at midpoints, likewise
///     asteroid     seed               0 .. 9   :1@5         20 4^L: asteroid() of the sphere (builtin_asteroid.hpp)
///     binary       seed               0 .. 9   :1@5         20 4^L: contact_binary() of the sphere
///
/// Lengths are in the body's own unit. All but the cow, the asteroid and the binary are centred on the origin, which is inside
/// these two; for the cow's axes and origin see builtin_cow.hpp. Every vertex of the sphere lies on it, so its volume is less than 4/3 pi R^3, by an amount of order
/// 4^-L. Every body is closed, 2-manifold, of genus 0, counter-clockwise seen from outside, and made without sine
/// or cosine, so the vertices do not depend on the mathematical library.
///
/// The name is "builtin:" and the spec in canonical form, with the sizes (shortest digits that read back the same) and
/// the level that were used: "builtin:sphere:1@4". `sha256` is left empty.
///
/// Throws bad_argument if `spec` breaks the grammar or leaves these ranges, or would exceed builtin_face_limit.
RawMesh builtin_mesh(std::string_view spec);

} // namespace cowgpu

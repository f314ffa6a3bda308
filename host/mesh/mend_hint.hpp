// What would mend a mesh that is no closed surface: tried, not guessed.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <string>

namespace cowgpu {

/// The first of these that makes of the mesh a closed, consistently oriented surface of positive volume of which nothing is
/// counted twice or subtracted (volume_amiss()), or else the first, which says how much is, as options: "--orient"; "--weld EPS" for
/// EPS 0 and for 1e-6, 1e-5 and 1e-4 times the power of ten below the longest side of its box, in the unit of the file; both; and,
/// where none of these gives a volume, "--largest-shell". A sentence that names it, the volume and what it merges or turns; "" where none does,
/// coordinates are not finite or the work would be more than seconds (over 2^20 faces, for --orient of several shells over
/// 2^16). The indices must be valid. Memory: a copy of the mesh.
std::string mend_hint(const RawMesh& mesh);

/// The first faces that have the three vertices of an earlier one, in the same order round: "face 12, line 20, repeats face
/// 3", and how many there are beyond; "" if there are none.
std::string repeated_faces(const RawMesh& mesh);

} // namespace cowgpu

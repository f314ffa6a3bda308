// Whether what an option makes of a mesh is sound, before the option is named.
#pragma once

#include "host/mesh/raw_mesh.hpp"
#include "host/monitor.hpp"

#include <cstddef>
#include <optional>
#include <string>

namespace cowgpu {

/// Meshes of more faces are not tried: it would take seconds.
inline constexpr std::size_t most_tried_faces = std::size_t{1} << 16;

/// Of a closed, consistently oriented mesh the volume that is counted twice or more often, or subtracted (overlap.hpp); 0 where it
/// is not above its uncertainty and a millionth of the whole. Nothing where it is not known: of more than most_tried_faces
/// faces, or of too many that meet. Throws Error(interrupted).
std::optional<double> volume_amiss(const RawMesh& mesh, Monitor& monitor);

/// The first of --orient and --largest-shell after which a closed mesh of several shells has a volume, and nothing of it is
/// counted twice or subtracted: "--orient gives the volume 12". Empty where neither does, or it is not known. --orient is not
/// tried where the mesh went through it. Throws Error(interrupted).
std::string cure_of_shells(const RawMesh& mesh, Monitor& monitor);

} // namespace cowgpu

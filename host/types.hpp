// The words every part of the host uses.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>

namespace cowgpu {

using Vec3 = Eigen::Vector3d;
using Face = std::array<std::uint32_t, 3>; ///< vertex indices, counter-clockwise seen from outside

} // namespace cowgpu

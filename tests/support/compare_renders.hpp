// One call that holds every path of the stage `render` against the reference.
#pragma once

#include "host/backend.hpp"
#include "tests/support/compare_moments.hpp"

namespace cowgpu::test {

/// The picture with every ray cast by the reference in 80-bit arithmetic.
Image reference_picture(const RenderScene& scene);

/// Asks that every path gives the same bits, and that no channel of any pixel is off the reference's by more than `levels`
/// of 255.
void compare_renders(Paths& paths, const RenderScene& scene, int levels);

} // namespace cowgpu::test

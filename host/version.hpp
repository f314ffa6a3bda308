// The program's version, as results name it.
#pragma once

namespace cowgpu {
inline constexpr const char* version = COWGPU_VERSION;
} // namespace cowgpu

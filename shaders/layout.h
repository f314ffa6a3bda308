// What every shader shares with C++: the same text is read by both.
#ifndef COWGPU_SHADERS_LAYOUT_H
#define COWGPU_SHADERS_LAYOUT_H

#ifdef __cplusplus
#include <cstdint>
using uint = std::uint32_t;
#endif

// Specialization constant that sets the workgroup's width in every shader.
#define COWGPU_LOCAL_SIZE_ID 0

#endif

// Interface of loop_limit.comp, read by GLSL and by C++.
#ifndef COWGPU_SHADERS_LOOP_LIMIT_H
#define COWGPU_SHADERS_LOOP_LIMIT_H
#include "shaders/layout.h"

#define LOOP_LIMIT_RESULT 0
#define LOOP_LIMIT_BINDINGS 1

#ifdef __cplusplus
namespace cowgpu::shaders {
#endif
struct LoopLimitPush {
  uint iterations;
};
#ifdef __cplusplus
} // namespace cowgpu::shaders
#endif
#endif

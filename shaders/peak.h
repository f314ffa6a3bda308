// Interface of peak.comp, read by GLSL and by C++.
#ifndef COWGPU_SHADERS_PEAK_H
#define COWGPU_SHADERS_PEAK_H
#include "shaders/layout.h"

#define PEAK_RESULT 0
#define PEAK_BINDINGS 1
#define PEAK_CHAINS 16 // independent multiply-add chains per invocation

#ifdef __cplusplus
namespace cowgpu::shaders {
#endif
struct PeakPush {
  double factor; // below 1, so that the chains stay finite
  double term;
  uint rounds; // each does 8 multiply-adds a chain; at most 60000
};
#ifdef __cplusplus
static_assert(sizeof(PeakPush) == 24);
} // namespace cowgpu::shaders
#endif
#endif

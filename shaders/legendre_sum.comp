// Adds the partial sums of legendre_analysis.comp, one of each range of rings, to the total in a fixed order.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/legendre.h"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;

layout(std430, binding = LEGENDRE_SUM_PARTIAL) readonly buffer Partial { dvec2 partial[]; };
layout(std430, binding = LEGENDRE_SUM_TOTAL) buffer Total { dvec2 total[]; };
layout(push_constant) uniform Push { LegendreSumPush push; };

void main() {
  const uint width = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  for (uint i = gl_GlobalInvocationID.x; i < push.size; i += width) {
    dvec2 sum = partial[i];
    for (uint part = 1; part < push.count; ++part) sum += partial[part * push.stride + i];
    total[i] = push.add != 0 ? total[i] + sum : sum;
  }
}

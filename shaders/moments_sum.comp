// Adds the workgroups' partial sums of moments.comp to the total, in a fixed order, and clears them for the next slice.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/moments.h"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;

layout(std430, binding = MOMENTS_SUM_PARTIAL) buffer Partial { double partial[]; };
layout(std430, binding = MOMENTS_SUM_TOTAL) buffer Total { double total[]; };
layout(push_constant) uniform Push { MomentsSumPush push; };

void main() {
  const uint width = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  for (uint i = gl_GlobalInvocationID.x; i < push.size; i += width) {
    double sum = 0;
    for (uint part = 0; part < push.count; ++part) {
      sum += partial[part * push.stride + i];
      partial[part * push.stride + i] = 0;
    }
    total[i] += sum;
  }
}

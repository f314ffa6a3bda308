// Double-precision multiply-add throughput: independent chains in registers.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/peak.h"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;
layout(std430, binding = PEAK_RESULT) writeonly buffer Result { double result[]; };
layout(push_constant) uniform Push { PeakPush push; };

void main() {
  double x[PEAK_CHAINS];
  [[unroll]] for (int c = 0; c < PEAK_CHAINS; ++c) x[c] = double(gl_GlobalInvocationID.x) + 0.01lf * c;
  for (uint round = 0; round < push.rounds; ++round)
    [[unroll]] for (int step = 0; step < 8; ++step)
      [[unroll]] for (int c = 0; c < PEAK_CHAINS; ++c) x[c] = x[c] * push.factor + push.term;
  double sum = 0;
  [[unroll]] for (int c = 0; c < PEAK_CHAINS; ++c) sum += x[c];
  result[gl_GlobalInvocationID.x] = sum;
}

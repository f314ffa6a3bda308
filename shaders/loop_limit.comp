// Counts the iterations of a loop: software devices end loops early, without a word, after some tens of thousands.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/loop_limit.h"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;
layout(std430, binding = LOOP_LIMIT_RESULT) buffer Result { uint count[]; };
layout(push_constant) uniform Push { LoopLimitPush push; };

void main() {
  uint done = 0;
  uint state = gl_LocalInvocationIndex;
  for (uint i = 0; i < push.iterations; ++i) {
    state = state * 1664525u + 1013904223u; // keeps the loop from being folded
    ++done;
  }
  count[gl_LocalInvocationIndex] = done + (state == 12345u && done == 0 ? 1u : 0u);
}

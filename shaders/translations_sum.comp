// What several pairs add to one local expansion, in their order. A lane takes a harmonic of a run of pairs.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/translations.h"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;

layout(std430, binding = TRANSLATIONS_SUM_RUNS) readonly buffer Runs { uvec4 runs[]; };
layout(std430, binding = TRANSLATIONS_SUM_EXPANDED) readonly buffer Expanded { dvec4 expanded[]; };
layout(std430, binding = TRANSLATIONS_SUM_LOCALS) buffer Locals { dvec4 locals[]; };
layout(push_constant) uniform Push { TranslationsSumPush push; };

void main() {
  const uint run = gl_GlobalInvocationID.x / push.harmonics, harmonic = gl_GlobalInvocationID.x % push.harmonics;
  if (run >= push.runs) return;
  const uvec4 own = runs[run];
  const uint to = own.x * push.stride + harmonic;
  dvec4 sum = locals[to];
  for (uint pair = own.y; pair < own.y + own.z; ++pair) sum += expanded[pair * push.harmonics + harmonic];
  locals[to] = sum;
}

// Sums of series in irregular solid harmonics: the mathematics stands in host/plan/potential.hpp. A lane takes four points
// next to each other, so that a load of coefficients serves all of them, through a range of orders; between ranges its sums
// wait in a buffer.
//
// Software devices end loops early without a word: lanes count what they summed, and the host compares.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/potential.h"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;
layout(constant_id = POTENTIAL_SETS_ID) const uint SETS = 9;

layout(binding = POTENTIAL_TABLE) uniform usamplerBuffer table;
layout(std430, binding = POTENTIAL_POINTS) readonly buffer Points { dvec4 points[]; };
layout(std430, binding = POTENTIAL_TOPS) readonly buffer Tops { uint tops[]; };
layout(std430, binding = POTENTIAL_STATE) buffer State { dvec4 state[]; };
layout(std430, binding = POTENTIAL_SEEN) buffer Seen { uint seen[]; };
layout(push_constant) uniform Push { PotentialPush push; };

dvec2 entry(int at) {
  const uvec4 texel = texelFetch(table, at);
  return dvec2(packDouble2x32(texel.xy), packDouble2x32(texel.zw));
}

void main() {
  const uint lane = gl_GlobalInvocationID.x;
  if (lane >= push.lanes) return;
  const uint top = tops[lane];
  if (top < push.first) return;
  const uint end = min(push.end, top + 1);

  const uint from = POTENTIAL_INPUTS * lane, to = (2 + SETS) * lane;
  const dvec4 x = points[from], y = points[from + 1], z = points[from + 2], q = points[from + 3];
  dvec4 start_re = points[from + 4], start_im = dvec4(0);
  dvec4 s0 = dvec4(0), s1 = s0, s2 = s0, s3 = s0, s4 = s0, s5 = s0, s6 = s0, s7 = s0, s8 = s0;
  uint count = 0;
  if (push.first > 0) {
    count = seen[lane];
    start_re = state[to];
    start_im = state[to + 1];
    s0 = state[to + 2];
    if (SETS > 1) {
      s1 = state[to + 3];
      s2 = state[to + 4];
      s3 = state[to + 5];
    }
    if (SETS > 4) {
      s4 = state[to + 6];
      s5 = state[to + 7];
      s6 = state[to + 8];
      s7 = state[to + 9];
      s8 = state[to + 10];
    }
  }

  const int stride = int(1 + SETS);
  int row = 0;
  uint m = push.first;
  do {
    dvec4 re = start_re, im = start_im, last_re = dvec4(0), last_im = dvec4(0);
    int at = row;
    uint l = m;
    do {
      const dvec2 factors = entry(at);
      const dvec2 c0 = entry(at + 1);
      s0 += c0.x * re + c0.y * im;
      if (SETS > 1) {
        const dvec2 c1 = entry(at + 2), c2 = entry(at + 3), c3 = entry(at + 4);
        s1 += c1.x * re + c1.y * im;
        s2 += c2.x * re + c2.y * im;
        s3 += c3.x * re + c3.y * im;
      }
      if (SETS > 4) {
        const dvec2 c4 = entry(at + 5), c5 = entry(at + 6), c6 = entry(at + 7), c7 = entry(at + 8), c8 = entry(at + 9);
        s4 += c4.x * re + c4.y * im;
        s5 += c5.x * re + c5.y * im;
        s6 += c6.x * re + c6.y * im;
        s7 += c7.x * re + c7.y * im;
        s8 += c8.x * re + c8.y * im;
      }
      const dvec4 a = factors.x * z, b = factors.y * q;
      const dvec4 next_re = a * re - b * last_re, next_im = a * im - b * last_im;
      last_re = re;
      last_im = im;
      re = next_re;
      im = next_im;
      at += stride;
      ++count;
      ++l;
    } while (l <= top);
    row += stride * int(push.top - m + 1);
    const double factor = entry(row - stride).x;
    const dvec4 fx = factor * x, fy = factor * y;
    const dvec4 turned = fx * start_re - fy * start_im;
    start_im = fx * start_im + fy * start_re;
    start_re = turned;
    ++m;
  } while (m < end);

  seen[lane] = count;
  state[to] = start_re;
  state[to + 1] = start_im;
  state[to + 2] = s0;
  if (SETS > 1) {
    state[to + 3] = s1;
    state[to + 4] = s2;
    state[to + 5] = s3;
  }
  if (SETS > 4) {
    state[to + 6] = s4;
    state[to + 7] = s5;
    state[to + 8] = s6;
    state[to + 9] = s7;
    state[to + 10] = s8;
  }
}

// Faces that may be the closest ones, in single precision: host/plan/closest_tree.hpp says how wrong that can be. A lane
// takes four queries next to each other, so that a load serves all of them, and walks down a binary tree, nearer child
// first. Triangles within twice the error of the best so far are noted; at the end, and when the list is full, those no
// longer within it are dropped. What is left is decided in double precision on the host.
//
// Software devices end loops early without a word. Every loop therefore leaves a trace of having run to its end, and a
// lane for which one is missing says so.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/closest.h"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;

layout(binding = CLOSEST_NODES) uniform usamplerBuffer nodes;
layout(binding = CLOSEST_TRIANGLES) uniform usamplerBuffer triangles;
layout(std430, binding = CLOSEST_QUERIES) readonly buffer Queries { vec4 queries[]; };
layout(std430, binding = CLOSEST_LANES) writeonly buffer Lanes { uvec2 lanes[]; };
layout(std430, binding = CLOSEST_CANDIDATES) buffer Candidates {
  uint total;
  uint candidates[];
};
layout(push_constant) uniform Push { ClosestPush push; };

vec4 px, py, pz;

float least(vec4 v) { return min(min(v.x, v.y), min(v.z, v.w)); }
float most(vec4 v) { return max(max(v.x, v.y), max(v.z, v.w)); }

vec4 box_distance2(uvec4 low_bits, uvec4 high_bits) {
  const vec3 low = uintBitsToFloat(low_bits.xyz), high = uintBitsToFloat(high_bits.xyz);
  const vec4 x = max(max(low.x - px, px - high.x), vec4(0));
  const vec4 y = max(max(low.y - py, py - high.y), vec4(0));
  const vec4 z = max(max(low.z - pz, pz - high.z), vec4(0));
  return x * x + y * y + z * z;
}

// From an edge that runs from the origin to (ex, ey).
vec4 edge_distance2(vec4 x, vec4 y, float ex, float ey, float inverse) {
  const vec4 s = clamp((x * ex + y * ey) * inverse, 0.0, 1.0);
  const vec4 dx = x - s * ex, dy = y - s * ey;
  return dx * dx + dy * dy;
}

vec4 triangle_distance2(uint triangle) {
  const int at = int(triangle) * CLOSEST_TRIANGLE_TEXELS;
  const vec4 u = uintBitsToFloat(texelFetch(triangles, at)), v = uintBitsToFloat(texelFetch(triangles, at + 1));
  const vec4 n = uintBitsToFloat(texelFetch(triangles, at + 2)), c = uintBitsToFloat(texelFetch(triangles, at + 3));
  const vec4 e = uintBitsToFloat(texelFetch(triangles, at + 4));
  const vec4 x = u.x * px + u.y * py + u.z * pz - u.w;
  const vec4 y = v.x * px + v.y * py + v.z * pz - v.w;
  const vec4 z = n.x * px + n.y * py + n.z * pz - n.w;
  const vec4 dx = x - clamp(x, 0.0, c.x), xb = x - c.x;
  vec4 d2 = dx * dx + y * y;
  d2 = min(d2, edge_distance2(x, y, c.y, c.z, c.w));
  d2 = min(d2, edge_distance2(xb, y, e.x, e.y, e.z));
  const vec4 inside = min(min(y, c.z * x - c.y * y), e.x * y - e.y * xb);
  return mix(d2, vec4(0), greaterThan(inside, vec4(0))) + z * z;
}

void main() {
  const uint lane = gl_GlobalInvocationID.x;
  if (lane >= push.lanes) return;
  px = queries[3 * lane];
  py = queries[3 * lane + 1];
  pz = queries[3 * lane + 2];
  const vec4 margin = push.margin * max(vec4(1), max(abs(px), max(abs(py), abs(pz))));

  uint list[CLOSEST_LIST];
  uint waiting[CLOSEST_STACK];
  float waiting_distance2[CLOSEST_STACK];
  uint count = 0, depth = 0, node = 0, steps = 0, rounds = 0;
  uint planned = 0, done = 0; // iterations of inner loops
  bool walking = true;
  vec4 best = vec4(push.unreachable), bound = best;
  float widest = push.unreachable;

  do {
    do {
      const int at = int(node) * CLOSEST_NODE_TEXELS;
      const uvec4 low_0 = texelFetch(nodes, at), high_0 = texelFetch(nodes, at + 1);
      const uvec4 low_1 = texelFetch(nodes, at + 2), high_1 = texelFetch(nodes, at + 3);
      const vec4 d2_0 = box_distance2(low_0, high_0), d2_1 = box_distance2(low_1, high_1);
      const bool reached_0 = any(lessThanEqual(d2_0, bound)), reached_1 = any(lessThanEqual(d2_1, bound));
      const bool leaf_0 = high_0.w > 0, leaf_1 = high_1.w > 0;
      // Triangles of two leaves follow each other.
      const bool take_0 = reached_0 && leaf_0, take_1 = reached_1 && leaf_1;
      uint triangle = take_0 ? low_0.w : low_1.w;
      const uint number = (take_0 ? high_0.w : 0) + (take_1 ? high_1.w : 0);
      planned += number;
      const uint end = triangle + number;
      while (triangle < end) {
        const vec4 d2 = triangle_distance2(triangle);
        list[count] = triangle;
        count += any(lessThanEqual(d2, bound)) ? 1 : 0;
        best = min(best, d2);
        ++triangle;
        ++done;
      }
      const vec4 reach = sqrt(best) + margin;
      bound = reach * reach;
      widest = most(bound);

      const bool go_0 = reached_0 && !leaf_0, go_1 = reached_1 && !leaf_1;
      const float near_0 = least(d2_0), near_1 = least(d2_1);
      const bool second = go_1 && (!go_0 || near_1 < near_0);
      node = second ? low_1.w : low_0.w;
      walking = go_0 || go_1;
      if (go_0 && go_1) {
        waiting[depth] = second ? low_0.w : low_1.w;
        waiting_distance2[depth] = max(near_0, near_1);
        ++depth;
      }
      while (!walking && depth > 0) {
        --depth;
        node = waiting[depth];
        walking = waiting_distance2[depth] <= widest;
      }
      ++steps;
    } while (walking && steps < push.steps && count <= CLOSEST_LIST - 2 * CLOSEST_LEAF);

    const uint all = count;
    count = 0;
    planned += all;
    for (uint k = 0; k < all; ++k) {
      const uint triangle = list[k] & ((1u << CLOSEST_TRIANGLE_BITS) - 1);
      const bvec4 within = lessThanEqual(triangle_distance2(triangle), bound);
      const uint whose = uint(within.x) | uint(within.y) << 1 | uint(within.z) << 2 | uint(within.w) << 3;
      list[count] = triangle | whose << CLOSEST_TRIANGLE_BITS;
      count += whose > 0 ? 1 : 0;
      ++done;
    }
    ++rounds;
  } while (walking && steps < push.steps && count <= CLOSEST_LIST / 2 && rounds < CLOSEST_ROUNDS);

  uint answer = count, first = 0;
  if (walking) answer = CLOSEST_LEFT;
  const bool stopped = steps >= push.steps || count > CLOSEST_LIST / 2 || rounds >= CLOSEST_ROUNDS;
  if (walking ? !stopped : depth > 0) answer = CLOSEST_CUT;
  if (!walking) {
    first = atomicAdd(total, count);
    if (first + count > push.capacity) {
      answer = CLOSEST_LEFT;
    } else {
      planned += count;
      for (uint k = 0; k < count; ++k) {
        candidates[first + k] = list[k];
        ++done;
      }
    }
  }
  if (done != planned) answer = CLOSEST_CUT;
  lanes[lane] = uvec2(first, answer);
}

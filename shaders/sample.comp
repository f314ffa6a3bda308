// Who holds the points of a grid: the mathematics stands in host/plan/sample.hpp. A workgroup works through its spans of
// points that a triangle may hold, a lane a point. What lies clearly inside goes to the least triangle; what the filter
// leaves open is listed for the host. The filter's error bound counts no fused operations, but holds with them as well.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/sample.h"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;

layout(std430, binding = SAMPLE_SPANS) readonly buffer Spans { uvec4 spans[]; };
layout(std430, binding = SAMPLE_CORNERS) readonly buffer Corners { double corners[]; };
layout(std430, binding = SAMPLE_RINGS) readonly buffer Rings { dvec2 rings[]; };
layout(std430, binding = SAMPLE_LONGITUDES) readonly buffer Longitudes { dvec2 longitudes[]; };
layout(std430, binding = SAMPLE_OWNERS) buffer Owners { uint owners[]; };
layout(std430, binding = SAMPLE_FOLDED) buffer Folded { uint folded[]; };
layout(std430, binding = SAMPLE_OPEN) buffer Open {
  uint visited;
  uint pairs;
  uvec2 open[];
};
layout(push_constant) uniform Push { SamplePush push; };

dvec3 corner(uint at) { return dvec3(corners[at], corners[at + 1], corners[at + 2]); }

void main() {
  const uint lane = gl_LocalInvocationID.x, lanes = gl_WorkGroupSize.x;
  const uint begin = push.first_span + gl_WorkGroupID.x * SAMPLE_SPANS_PER_GROUP;
  const uint end = min(begin + SAMPLE_SPANS_PER_GROUP, push.spans);
  // Software devices end loops early without a word; the host compares this count with what it asked for.
  uint seen = 0;
  for (uint s = begin; s < end; ++s) {
    const uvec4 span = spans[s];
    const dvec3 a = corner(9 * span.x), b = corner(9 * span.x + 3), c = corner(9 * span.x + 6);
    const dvec3 u = cross(b, c), v = cross(c, a), w = cross(a, b);
    const dvec2 ring = rings[span.y];
    const double uz = u.z * ring.y, vz = v.z * ring.y, wz = w.z * ring.y;
    const uint row = span.y * push.ring_length;
    for (uint j = lane; j < span.w; j += lanes) {
      ++seen;
      const dvec2 longitude = longitudes[span.z + j];
      precise double x = ring.x * longitude.x, y = ring.x * longitude.y;
      const double least = min(min(u.x * x + u.y * y + uz, v.x * x + v.y * y + vz), w.x * x + w.y * y + wz);
      const uint point = row + span.z + j;
      if (least > push.margin) {
        if (atomicMax(owners[point], push.triangles - span.x) != 0) folded[point] = 1;
      } else if (least >= -push.margin) {
        const uint at = atomicAdd(pairs, 1);
        if (at < push.capacity) open[at] = uvec2(point, span.x);
      }
    }
  }
  if (seen > 0) atomicAdd(visited, seen);
}

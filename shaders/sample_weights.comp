// Barycentric coordinates of each point on its triangle: the same operations as barycentric() of host/plan/sample.hpp, in
// the same order.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/sample.h"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;

layout(std430, binding = SAMPLE_WEIGHTS_CORNERS) readonly buffer Corners { double corners[]; };
layout(std430, binding = SAMPLE_WEIGHTS_RINGS) readonly buffer Rings { dvec2 rings[]; };
layout(std430, binding = SAMPLE_WEIGHTS_LONGITUDES) readonly buffer Longitudes { dvec2 longitudes[]; };
layout(std430, binding = SAMPLE_WEIGHTS_OWNERS) readonly buffer Owners { uint owners[]; };
layout(std430, binding = SAMPLE_WEIGHTS_WEIGHTS) writeonly buffer Weights { double weights[]; };
layout(push_constant) uniform Push { SampleWeightsPush push; };

void main() {
  const uint width = gl_WorkGroupSize.x;
  const uint begin = gl_WorkGroupID.x * width * SAMPLE_WEIGHTS_POINTS + gl_LocalInvocationID.x;
  for (uint k = 0; k < SAMPLE_WEIGHTS_POINTS; ++k) {
    const uint point = begin + k * width;
    if (point >= push.points) break;
    const uint owner = owners[point];
    if (owner == 0) continue; // the host knows
    const uint ring = point / push.ring_length;
    const dvec2 circle = rings[ring], longitude = longitudes[point - ring * push.ring_length];
    const uint at = 9 * (push.triangles - owner);
    precise double x = circle.x * longitude.x, y = circle.x * longitude.y, z = circle.y;
    precise double ax = corners[at] - x, ay = corners[at + 1] - y, az = corners[at + 2] - z;
    precise double bx = corners[at + 3] - x, by = corners[at + 4] - y, bz = corners[at + 5] - z;
    precise double cx = corners[at + 6] - x, cy = corners[at + 7] - y, cz = corners[at + 8] - z;
    precise double u = (x * (by * cz - bz * cy) + y * (bz * cx - bx * cz)) + z * (bx * cy - by * cx);
    precise double v = (x * (cy * az - cz * ay) + y * (cz * ax - cx * az)) + z * (cx * ay - cy * ax);
    precise double w = (x * (ay * bz - az * by) + y * (az * bx - ax * bz)) + z * (ax * by - ay * bx);
    u = u > 0 ? u : 0;
    v = v > 0 ? v : 0;
    w = w > 0 ? w : 0;
    precise double sum = (u + v) + w;
    const bool good = sum > 0;
    const double third = 1.0lf / 3.0lf;
    weights[3 * point] = good ? u / sum : third;
    weights[3 * point + 1] = good ? v / sum : third;
    weights[3 * point + 2] = good ? w / sum : third;
  }
}

// The first triangle along a ray, one ray an invocation: Bvh::first_hit of geometry/bvh.cpp step by step and operation by
// operation, so that hits are the CPU path's bit by bit where the device divides as IEEE 754 says.
//
// Software devices end loops early without a word. Every loop therefore leaves a trace of having run to its end, and a
// ray for which one is missing says so.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/render.h"

struct RenderHit {
  uint face, pad;
  double t, u, v;
};

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;
layout(binding = RENDER_NODES) uniform usamplerBuffer nodes;
layout(binding = RENDER_TRIANGLES) uniform usamplerBuffer triangles;
layout(std430, binding = RENDER_RAYS) readonly buffer Rays { double rays[]; };
layout(std430, binding = RENDER_HITS) writeonly buffer Hits { RenderHit hits[]; };
layout(push_constant) uniform Push { RenderPush push; };

const double edge_margin = 1e-12lf;
const double edge_limit = 1.0lf + 1e-12lf;
const double box_margin = 1.0lf + 8e-16lf;

double infinity;
dvec3 origin, inverse;
bvec3 parallel; // to a box's sides: no quotient says where the ray is between them

dvec2 doubles(uvec4 words) { return dvec2(packDouble2x32(words.xy), packDouble2x32(words.zw)); }

double dot3(dvec3 a, dvec3 b) {
  precise const double xy = a.x * b.x + a.y * b.y;
  precise const double sum = xy + a.z * b.z;
  return sum;
}

dvec3 cross3(dvec3 a, dvec3 b) {
  precise const double x = a.y * b.z - a.z * b.y;
  precise const double y = a.z * b.x - a.x * b.z;
  precise const double z = a.x * b.y - a.y * b.x;
  return dvec3(x, y, z);
}

// Narrows the stretch of the ray that is in a box by two of the box's sides.
void narrow(double low, double high, double from, double over, bool flat_on, inout double near, inout double far) {
  precise const double t1 = (low - from) * over;
  precise const double t2 = (high - from) * over;
  const double enter = t2 < t1 ? t2 : t1;
  precise const double leave = (t1 < t2 ? t2 : t1) * box_margin;
  if (flat_on) {
    if (from < low || from > high) near = infinity;
  } else {
    near = near < enter ? enter : near;
    far = leave < far ? leave : far;
  }
}

// Entry into a node's box; infinite if it is missed.
double entry(uint node, double limit) {
  const int at = int(node) * RENDER_NODE_TEXELS;
  const dvec2 a = doubles(texelFetch(nodes, at)), b = doubles(texelFetch(nodes, at + 1));
  const dvec2 c = doubles(texelFetch(nodes, at + 2));
  double near = 0, far = limit;
  narrow(a.x, b.y, origin.x, inverse.x, parallel.x, near, far);
  narrow(a.y, c.x, origin.y, inverse.y, parallel.y, near, far);
  narrow(b.x, c.y, origin.z, inverse.z, parallel.z, near, far);
  return near <= far ? near : infinity;
}

void main() {
  const uint ray = gl_GlobalInvocationID.x;
  if (ray >= push.rays) return;
  infinity = packDouble2x32(uvec2(0, 0x7ff00000u));
  const uint start = 7 * ray;
  origin = dvec3(rays[start], rays[start + 1], rays[start + 2]);
  const dvec3 direction = dvec3(rays[start + 3], rays[start + 4], rays[start + 5]);
  double limit = rays[start + 6];
  parallel = lessThan(abs(direction), dvec3(1e-100lf));
  inverse = 1.0lf / mix(direction, dvec3(1.0lf), parallel);

  uint waiting[RENDER_STACK];
  double waiting_near[RENDER_STACK];
  uint depth = 0, steps = 0, node = 0;
  uint planned = 0, done = 0; // triangles of leaves
  uint face = RENDER_NOTHING;
  double hit_u = 0, hit_v = 0;
  bool walking = entry(0, limit) < infinity;

  do {
    if (walking) {
      const uvec4 links = texelFetch(nodes, int(node) * RENDER_NODE_TEXELS + 3);
      uint triangle = links.x;
      const uint end = links.x + links.y;
      planned += links.y;
      while (triangle < end) {
        // Moeller and Trumbore, Journal of Graphics Tools 2 (1997) 21.
        const int at = int(triangle) * RENDER_TRIANGLE_TEXELS;
        const dvec2 t0 = doubles(texelFetch(triangles, at)), t1 = doubles(texelFetch(triangles, at + 1));
        const dvec2 t2 = doubles(texelFetch(triangles, at + 2)), t3 = doubles(texelFetch(triangles, at + 3));
        const uvec4 t4 = texelFetch(triangles, at + 4);
        const dvec3 a = dvec3(t0.x, t0.y, t1.x), ab = dvec3(t1.y, t2.x, t2.y);
        const dvec3 ac = dvec3(t3.x, t3.y, packDouble2x32(t4.xy));
        const dvec3 p = cross3(direction, ac);
        const double det = dot3(ab, p);
        precise const double scale = 1.0lf / det;
        precise const dvec3 s = origin - a;
        precise const double u = dot3(s, p) * scale;
        const dvec3 q = cross3(s, ab);
        precise const double v = dot3(direction, q) * scale;
        precise const double t = dot3(ac, q) * scale;
        precise const double uv = u + v;
        // Written so that what is no number hits nothing.
        const bool inside = det != 0.0lf && u >= -edge_margin && u <= edge_limit && v >= -edge_margin && uv <= edge_limit;
        const bool first = t >= 0.0lf && t <= limit && !(face != RENDER_NOTHING && t == limit && t4.z > face);
        if (inside && first) {
          limit = t;
          face = t4.z;
          hit_u = u;
          hit_v = v;
        }
        ++triangle;
        ++done;
      }
      walking = false;
      if (links.y == 0) {
        uint near = node + 1, far = links.x;
        double near_t = entry(near, limit), far_t = entry(far, limit);
        if (far_t < near_t) {
          const uint other = near;
          const double other_t = near_t;
          near = far;
          near_t = far_t;
          far = other;
          far_t = other_t;
        }
        if (far_t < infinity) {
          waiting[depth] = far;
          waiting_near[depth] = far_t;
          ++depth;
        }
        node = near;
        walking = near_t < infinity;
      }
    } else if (depth > 0) {
      --depth;
      node = waiting[depth];
      walking = !(waiting_near[depth] > limit);
    }
    ++steps;
  } while ((walking || depth > 0) && steps < push.steps);

  if (walking || depth > 0) face = steps < push.steps ? RENDER_CUT : RENDER_LEFT;
  if (planned != done) face = RENDER_CUT;
  hits[ray].face = face;
  hits[ray].t = limit;
  hits[ray].u = hit_u;
  hits[ray].v = hit_v;
}

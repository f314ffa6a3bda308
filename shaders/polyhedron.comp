// Closed forms of triangles at groups of points: the equations stand in host/plan/polyhedron.hpp. A workgroup takes a group of
// points, a lane two of them, through ranges of steps. A step has one new corner N and the face P Q N between it and the two
// before, so that a face of a strip costs one distance, two logarithms and one angle; where a strip begins, two faces without
// area bring its first corners.
//
// Where all points are far from all faces the logarithms and the angle are short series. Elsewhere ln(x/y) = k ln 2 + 2 atanh z
// with k from the exponents' bits; a + b - e cancels next to an edge, and comes from (a + b)^2 - e^2 = 2 |r_a x r_b|^2 /
// (a b - r_a.r_b) there.
//
// Software devices end loops early without a word: lanes count their steps, and the host compares.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/polyhedron.h"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;
layout(constant_id = POLYHEDRON_NEAR_ID) const uint NEAR = 1;
layout(constant_id = POLYHEDRON_SECOND_ID) const uint SECOND = 0;
layout(constant_id = POLYHEDRON_SEEDS_ID) const uint SEEDS = 1;

layout(binding = POLYHEDRON_STEPS) uniform usamplerBuffer steps;
layout(std430, binding = POLYHEDRON_RANGES) readonly buffer Ranges { uvec2 ranges[]; };
layout(std430, binding = POLYHEDRON_WORK) readonly buffer Work { uvec4 work[]; };
layout(std430, binding = POLYHEDRON_POINTS) readonly buffer Points { dvec2 points[]; };
layout(std430, binding = POLYHEDRON_SUMS) buffer Sums { dvec2 sums[]; };
layout(std430, binding = POLYHEDRON_SEEN) buffer Seen { uint seen[]; };
layout(push_constant) uniform Push { PolyhedronPush push; };

#define V dvec2
#define B bvec2

struct Corner {
  V x, y, z, distance;
};
struct Side {
  V logarithm, excess, on; // on: 1 where the point is on the edge
};

dvec2 pair(int at) {
  const uvec4 texel = texelFetch(steps, at);
  return dvec2(packDouble2x32(texel.xy), packDouble2x32(texel.zw));
}

V most(V a, V b) { return mix(a, b, lessThan(a, b)); }
V size(V a) { return mix(a, -a, lessThan(a, V(0))); }

// 1/x, right to a unit in the last place, for 1e-37 < x < 1e37.
V inverse(V x) {
  if (SEEDS == 0) return 1.0LF / x;
  V y = V(1.0 / vec2(x));
  y += y * (1.0LF - x * y);
  y += y * (1.0LF - x * y);
  return y;
}
V quotient(V a, V b) {
  if (SEEDS == 0) return a / b;
  const V y = inverse(b), q = a * y;
  return q + y * (a - q * b);
}
V root(V x) {
  if (SEEDS == 0) return sqrt(x);
  V y = V(inversesqrt(vec2(x)));
  y += 0.5LF * y * (1.0LF - x * y * y);
  const V g = x * y;
  const V once = g + 0.5LF * y * (x - g * g);
  return once + 0.5LF * y * (x - once * once);
}

V atanh_series(V w) {
  return 2.0LF + w * (0.6666666666667569LF + w * (0.39999999995294805LF + w * (0.2857142950517728LF +
         w * (0.22222131395718692LF + w * (0.18186601178034084LF + w * (0.15245895623917796LF + w * 0.1539819284600443LF))))));
}
V atan_series(V w) {
  return 2.0LF + w * (-0.6666666666666012LF + w * (0.39999999996561564LF + w * (-0.285714278818379LF +
         w * (0.2222215418019332LF + w * (-0.18178161340284663LF + w * (0.15275101037288163LF - w * 0.11600898864526461LF))))));
}
V folded_atan_series(V w) {
  const V upper = 0.1538408943518799LF + w * (-0.13325889526574225LF + w * (0.11693652763669968LF +
                  w * (-0.10069731384388068LF + w * (0.07591833927724048LF - w * 0.03559730388763467LF))));
  return 2.0LF + w * (-0.6666666666666624LF + w * (0.39999999999881297LF + w * (-0.28571428558452994LF +
         w * (0.22222221487476326LF + w * (-0.18181793549820227LF + w * upper)))));
}

const double pi = 3.141592653589793238LF;

double power_of_two(double above, double below, out double scaled) {
  const uvec2 a = unpackDouble2x32(above), b = unpackDouble2x32(below);
  const int k = int(a.y - b.y + 0x80000u) >> 20;
  scaled = packDouble2x32(uvec2(b.x, b.y + (uint(k) << 20)));
  return double(k);
}
// ln((s + edge)^2/excess); where that is near 1 the quotient edge/s tells it without cancellation.
V log_side(V s, double edge, V excess) {
  const V above = (s + edge) * (s + edge);
  V k, scaled;
  double part;
  k.x = power_of_two(above.x, excess.x, part);
  scaled.x = part;
  k.y = power_of_two(above.y, excess.y, part);
  scaled.y = part;
  const B far = greaterThan(s, V(5.1LF * edge));
  const V z = quotient(mix(above - scaled, V(edge), far), mix(above + scaled, s, far));
  return mix(k * 0.69314718055994530942LF, V(0), far) + z * atanh_series(z * z);
}
// 2 atan2(y, x); 0 where y is 0 and x is not negative
V twice_atan2(V y, V x) {
  const V rise = size(y), run = size(x);
  const B high = greaterThan(rise, run);
  const V more = most(mix(run, rise, high), V(1e-36LF)), less = mix(rise, run, high);
  const B steep = greaterThan(less, more * 0.41421356237309504880LF);
  const V t = quotient(mix(less, less - more, steep), mix(more, less + more, steep));
  V angle = t * folded_atan_series(t * t) + mix(V(0), V(0.5LF * pi), steep);
  angle = mix(angle, pi - angle, high);
  angle = mix(angle, 2.0LF * pi - angle, lessThan(x, V(0)));
  return mix(angle, -angle, lessThan(y, V(0)));
}

Side side_between(Corner a, Corner b, double edge) {
  Side side;
  side.on = V(0);
  const V s = a.distance + b.distance;
  if (NEAR == 0) {
    const V z = quotient(V(edge), s);
    side.logarithm = z * atanh_series(z * z);
    side.excess = (s - edge) * (s + edge);
    return side;
  }
  const V product = a.distance * b.distance, cosine = a.x * b.x + a.y * b.y + a.z * b.z;
  const V cx = a.y * b.z - a.z * b.y, cy = a.z * b.x - a.x * b.z, cz = a.x * b.y - a.y * b.x;
  const V area2 = cx * cx + cy * cy + cz * cz; // of the parallelogram, squared
  const B between = lessThan(cosine, V(0));
  const V plain = 2.0LF * (product + cosine), narrow = 2.0LF * quotient(area2, most(product - cosine, V(1e-36LF)));
  const V excess = most(mix(plain, narrow, between), V(1e-31LF) * (edge * edge) + 1e-36LF);
  side.excess = excess;
  side.logarithm = log_side(s, edge, excess);
  if (SECOND != 0 && edge > 0) {
    // The foot of the height lies between the ends, or an end is touched.
    const double margin = push.touching, margin2 = margin * margin;
    const B line = lessThanEqual(area2, V(margin2 * edge * edge));
    const V along = a.distance * a.distance - cosine, rest = b.distance * b.distance - cosine; // times the edge
    const double beyond = -margin * edge;
    side.on = mix(V(0), mix(V(0), mix(V(0), V(1), line), greaterThanEqual(along, V(beyond))),
                  greaterThanEqual(rest, V(beyond)));
  }
  return side;
}

void main() {
  const uint lane = gl_LocalInvocationID.x;
  const uvec4 own = work[push.first + gl_WorkGroupID.x];
  if (2 * lane >= own.x >> POLYHEDRON_COUNT_SHIFT) return;
  const uint group = own.x & ((1u << POLYHEDRON_COUNT_SHIFT) - 1u), from = group * 3 * POLYHEDRON_LANES + lane;
  const uint rows = SECOND != 0 ? POLYHEDRON_ROWS_SECOND : POLYHEDRON_ROWS_FIRST;
  const uint to = group * rows * POLYHEDRON_LANES + lane;
  const V x = points[from], y = points[from + POLYHEDRON_LANES], z = points[from + 2 * POLYHEDRON_LANES];
  // Sums over the body are small differences of large ones: they are added up from short sums.
  V value = V(0), gx = V(0), gy = V(0), gz = V(0), winding = V(0);
  V hxx = V(0), hxy = V(0), hxz = V(0), hyy = V(0), hyz = V(0), hzz = V(0);
  V jxx = V(0), jxy = V(0), jxz = V(0), jyy = V(0), jyz = V(0), jzz = V(0), edges = V(0);

  Corner P, Q;
  P.x = V(1);
  P.y = P.z = V(0);
  P.distance = V(1);
  Q = P;
  Side PQ;
  PQ.logarithm = PQ.on = V(0);
  PQ.excess = V(4);

  uint item = own.y, at = own.z, count = 0;
  uint end = ranges[item].y;
  do {
    V short_value = V(0), short_gx = V(0), short_gy = V(0), short_gz = V(0), short_winding = V(0);
    V short_hxx = V(0), short_hxy = V(0), short_hxz = V(0), short_hyy = V(0), short_hyz = V(0), short_hzz = V(0);
    const uint stop = min(count + POLYHEDRON_SHORT, own.w);
    do {
      const int texel = int(at) * POLYHEDRON_STEP_TEXELS;
      const dvec2 t0 = pair(texel), t1 = pair(texel + 1), t2 = pair(texel + 2), t3 = pair(texel + 3), t4 = pair(texel + 4);
      const dvec2 t5 = pair(texel + 5), t6 = pair(texel + 6), t7 = pair(texel + 7), t8 = pair(texel + 8);
      const uvec4 last = texelFetch(steps, texel + 9);
      const double nx = t1.y, ny = t2.x, nz = t2.y;
      const double height = t8.x;

      Corner N;
      N.x = t0.x - x;
      N.y = t0.y - y;
      N.z = t1.x - z;
      N.distance = root(most(N.x * N.x + N.y * N.y + N.z * N.z, V(1e-36LF)));
      const Side QN = side_between(Q, N, t8.y), NP = side_between(N, P, packDouble2x32(last.xy));

      const V h = nx * N.x + ny * N.y + nz * N.z;
      const V below = P.distance * QN.excess + Q.distance * NP.excess + N.distance * PQ.excess -
                      4.0LF * P.distance * Q.distance * N.distance;
      const V above = t7.y * h;
      V angle;
      if (NEAR == 0) {
        const V t = quotient(above, below);
        angle = t * atan_series(t * t);
      } else {
        angle = mix(twice_atan2(above, below), V(0), lessThanEqual(size(h), V(push.touching)));
      }
      const double px = t3.x, py = t3.y, pz = t4.x, qx = t4.y, qy = t5.x, qz = t5.y, rx = t6.x, ry = t6.y, rz = t7.x;
      const V lp = PQ.logarithm, lq = QN.logarithm, lr = NP.logarithm;
      const V sq = qx * N.x + qy * N.y + qz * N.z, sr = rx * N.x + ry * N.y + rz * N.z;
      const V sp = px * N.x + py * N.y + pz * N.z + height;
      const V phi = sp * lp + sq * lq + sr * lr - h * angle;
      short_value += h * phi;
      short_gx += nx * phi;
      short_gy += ny * phi;
      short_gz += nz * phi;
      short_winding += angle;
      if (SECOND != 0) {
        V kp = lp, kq = lq, kr = lr;
        if (NEAR != 0) {
          kp -= kp * PQ.on;
          kq -= kq * QN.on;
          kr -= kr * NP.on;
        }
        const V ux = px * kp + qx * kq + rx * kr - nx * angle;
        const V uy = py * kp + qy * kq + ry * kr - ny * angle;
        const V uz = pz * kp + qz * kq + rz * kr - nz * angle;
        short_hxx += nx * ux;
        short_hxy += nx * uy;
        short_hxz += nx * uz;
        short_hyy += ny * uy;
        short_hyz += ny * uz;
        short_hzz += nz * uz;
        if (NEAR != 0) {
          const uint flags = last.z;
          edges += PQ.on * double(flags / POLYHEDRON_FLAG_SHARP_PQ & 1) + QN.on * double(flags / POLYHEDRON_FLAG_SHARP_QN & 1) +
                   NP.on * double(flags / POLYHEDRON_FLAG_SHARP_NP & 1);
          // On the face: 2 pi inside, pi on an edge, the corner's angle at a corner (of which the two edges there tell).
          const V margin = V(push.touching);
          const V inside = mix(V(0), V(2.0LF * pi), lessThanEqual(size(h), margin));
          const B out_p = lessThan(sp, -margin), out_q = lessThan(sq, -margin), out_r = lessThan(sr, -margin);
          const B on_p = lessThanEqual(sp, margin), on_q = lessThanEqual(sq, margin), on_r = lessThanEqual(sr, margin);
          V part = mix(inside, V(0), out_p);
          part = mix(part, V(0), out_q);
          part = mix(part, V(0), out_r);
          if (t7.y == 0) part = V(0);
          const V lines = mix(V(0), V(1), on_p) + mix(V(0), V(1), on_q) + mix(V(0), V(1), on_r);
          part *= mix(V(1), V(0.5LF), greaterThan(lines, V(0.5LF)));
          // The angle between two edges' normals is found by the atan2 of their cross and dot products.
          const double cp = -(qx * rx + qy * ry + qz * rz), cq = -(rx * px + ry * py + rz * pz), cr = -(px * qx + py * qy + pz * qz);
          const V corner = mix(mix(V(cr), V(cq), on_r), V(cp), B(on_q.x && on_r.x, on_q.y && on_r.y));
          const V sine2 = most(1.0LF - corner * corner, V(0));
          const V corner_angle = 0.5LF * twice_atan2(root(most(sine2, V(1e-36LF))), corner);
          part = mix(part, mix(V(0), corner_angle, greaterThan(part, V(0))), greaterThan(lines, V(1.5LF)));
          jxx += part * (nx * nx);
          jxy += part * (nx * ny);
          jxz += part * (nx * nz);
          jyy += part * (ny * ny);
          jyz += part * (ny * nz);
          jzz += part * (nz * nz);
        }
      }

      if ((last.z & POLYHEDRON_FLAG_KEEP_P) != 0) {
        Q = N;
        PQ = NP;
      } else {
        P = Q;
        Q = N;
        PQ = QN;
      }
      ++count;
      ++at;
      if (at == end && count < own.w) {
        ++item;
        at = ranges[item].x;
        end = ranges[item].y;
      }
    } while (count < stop);
    value += short_value;
    gx += short_gx;
    gy += short_gy;
    gz += short_gz;
    winding += short_winding;
    if (SECOND != 0) {
      hxx += short_hxx;
      hxy += short_hxy;
      hxz += short_hxz;
      hyy += short_hyy;
      hyz += short_hyz;
      hzz += short_hzz;
    }
  } while (count < own.w);

  seen[group * POLYHEDRON_LANES + lane] += count;
  sums[to] += value;
  sums[to + POLYHEDRON_LANES] += gx;
  sums[to + 2 * POLYHEDRON_LANES] += gy;
  sums[to + 3 * POLYHEDRON_LANES] += gz;
  sums[to + 4 * POLYHEDRON_LANES] += winding;
  if (SECOND != 0) {
    sums[to + 5 * POLYHEDRON_LANES] += hxx;
    sums[to + 6 * POLYHEDRON_LANES] += hxy;
    sums[to + 7 * POLYHEDRON_LANES] += hxz;
    sums[to + 8 * POLYHEDRON_LANES] += hyy;
    sums[to + 9 * POLYHEDRON_LANES] += hyz;
    sums[to + 10 * POLYHEDRON_LANES] += hzz;
    if (NEAR != 0) {
      sums[to + 11 * POLYHEDRON_LANES] += jxx;
      sums[to + 12 * POLYHEDRON_LANES] += jxy;
      sums[to + 13 * POLYHEDRON_LANES] += jxz;
      sums[to + 14 * POLYHEDRON_LANES] += jyy;
      sums[to + 15 * POLYHEDRON_LANES] += jyz;
      sums[to + 16 * POLYHEDRON_LANES] += jzz;
      sums[to + 17 * POLYHEDRON_LANES] += edges;
    }
  }
}

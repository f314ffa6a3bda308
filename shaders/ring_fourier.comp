// Fourier transforms of whole rings in private arrays: a lane is a pair of rings of one field. The passes are described in
// ring_fourier.h; longer rings and other devices take ring_fourier_pass.comp.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/ring_fourier.h"
#include "shaders/ring_fourier_lib.glsl"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;
layout(constant_id = COWGPU_LOCAL_SIZE_ID) const int LANES = 8;
layout(constant_id = RING_FOURIER_KIND_ID) const bool TO_WAVES = true;
layout(constant_id = RING_FOURIER_POINTS_ID) const int POINTS = 1024;
layout(constant_id = RING_FOURIER_RADICES_ID) const int RADICES = 0x13c;

layout(binding = RING_FOURIER_VALUES_IN) uniform usamplerBuffer values_in;
layout(binding = RING_FOURIER_WAVES_IN) uniform usamplerBuffer waves_in;
layout(binding = RING_FOURIER_TWIDDLES) uniform usamplerBuffer twiddles;
layout(binding = RING_FOURIER_RINGS) uniform usamplerBuffer rings;
layout(std430, binding = RING_FOURIER_VALUES_OUT) writeonly buffer Values { double values_out[]; };
layout(std430, binding = RING_FOURIER_WAVES_OUT) writeonly buffer Waves { dvec2 waves_out[]; };
layout(std430, binding = RING_FOURIER_COUNTS) writeonly buffer Counts { uint counts[]; };
layout(push_constant) uniform Push { RingFourierPush push; };

double re[2 * POINTS], im[2 * POINTS]; // a pass goes from one half to the other

// A pass of radix R, or where the pass is of another one, nothing. Loops that end at their foot: software devices run one
// that ends at its head once too often, masked.
#define PASS(R)                                                                                                        \
  if ((RADICES & (1 << R)) != 0 && radix == R) {                                                                       \
    const int parts = length / R;                                                                                      \
    int p = 0;                                                                                                         \
    do {                                                                                                               \
      ++count;                                                                                                         \
      dvec2 w[R];                                                                                                      \
      [[unroll]] for (int k = 0; k < R; ++k) w[k] = two_doubles(texelFetch(twiddles, p * k * stride));                 \
      int q = 0;                                                                                                       \
      do {                                                                                                             \
        ++count;                                                                                                       \
        double x[8], y[8];                                                                                             \
        [[unroll]] for (int j = 0; j < R; ++j) {                                                                       \
          x[j] = re[from + q + stride * (p + j * parts)];                                                              \
          y[j] = im[from + q + stride * (p + j * parts)];                                                              \
        }                                                                                                              \
        dft_##R(x, y);                                                                                                 \
        const int at = to + q + stride * R * p;                                                                        \
        re[at] = x[0];                                                                                                 \
        im[at] = y[0];                                                                                                 \
        [[unroll]] for (int k = 0; k < R; ++k)                                                                         \
          if (k > 0) {                                                                                                 \
            re[at + stride * k] = x[k] * w[k].x + y[k] * w[k].y;                                                       \
            im[at + stride * k] = y[k] * w[k].x - x[k] * w[k].y;                                                       \
          }                                                                                                            \
      } while (++q < stride);                                                                                          \
    } while (++p < parts);                                                                                             \
  }

void main() {
  const int n = int(push.points);
  const int pairs_a_field = int(gl_NumWorkGroups.x / push.fields) * LANES;
  const int field = int(gl_WorkGroupID.x) * LANES / pairs_a_field;
  const int pair = int(gl_WorkGroupID.x) * LANES - field * pairs_a_field + int(gl_LocalInvocationID.x);
  if (pair >= int(push.pairs)) return;
  const int north = (2 * field * int(push.pairs) + pair) * n, south = north + int(push.pairs) * n;
  const int waves_at = 2 * int((uint(pair) * push.fields + uint(field)) * push.wave_columns);
  const dvec2 ring = two_doubles(texelFetch(rings, int(push.first_pair) + pair));
  const double factor = push.weighted != 0 ? ring.x : 1.0lf;
  uint count = 0;

  if (TO_WAVES) {
    for (int j = 0; j < n; ++j) {
      ++count;
      re[j] = packDouble2x32(texelFetch(values_in, north + j).xy);
      im[j] = packDouble2x32(texelFetch(values_in, south + j).xy);
    }
  } else {
    const double odd_factor = factor * ring.y;
    for (int j = int(push.orders); j < n; ++j) {
      ++count;
      re[j] = 0;
      im[j] = 0;
    }
    for (int m = 0; m < int(push.orders); ++m) {
      ++count;
      const dvec2 even = factor * two_doubles(texelFetch(waves_in, waves_at + 2 * m));
      const dvec2 odd = odd_factor * two_doubles(texelFetch(waves_in, waves_at + 2 * m + 1));
      const dvec2 a = even + odd, b = even - odd;
      const int mirror = m == 0 ? 0 : n - m;
      re[m] = a.y + b.x;
      im[m] = a.x - b.y;
      re[mirror] = b.x - a.y;
      im[mirror] = a.x + b.y;
    }
  }

  int length = n, stride = 1, from = 0, to = POINTS;
  for (uint pass = 0; pass < push.passes; ++pass) {
    ++count;
    const int radix = int(push.radix[pass]);
    PASS(8)
    PASS(4)
    PASS(2)
    PASS(3)
    PASS(5)
    from = POINTS - from;
    to = POINTS - to;
    length /= radix;
    stride *= radix;
  }

  if (TO_WAVES) {
    const double half_factor = 0.5lf * factor, odd_factor = half_factor * ring.y;
    for (int m = 0; m < int(push.orders); ++m) {
      ++count;
      const int mirror = from + (m == 0 ? 0 : n - m);
      const double x = re[from + m], y = im[from + m], u = re[mirror], v = im[mirror];
      const dvec2 a = dvec2(x + u, y - v), b = dvec2(y + v, u - x);
      waves_out[waves_at + 2 * m] = half_factor * (a + b);
      waves_out[waves_at + 2 * m + 1] = odd_factor * (a - b);
    }
  } else {
    for (int j = 0; j < n; ++j) {
      ++count;
      values_out[north + j] = im[from + j];
      values_out[south + j] = re[from + j];
    }
  }
  // Software devices end loops early without a word; the host compares this count with what it asked for.
  if (gl_LocalInvocationID.x == 0) counts[gl_WorkGroupID.x] = count;
}

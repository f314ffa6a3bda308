// Fourier transforms of rings pass by pass through buffers, for rings of any length: one butterfly an invocation, or where
// the radix has none of its own here, one of its points. The passes are described in ring_fourier.h.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/ring_fourier.h"
#include "shaders/ring_fourier_lib.glsl"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;
layout(constant_id = RING_FOURIER_KIND_ID) const int KIND = RING_FOURIER_PASS;

layout(binding = RING_FOURIER_VALUES_IN) uniform usamplerBuffer values_in;
layout(binding = RING_FOURIER_WAVES_IN) uniform usamplerBuffer waves_in;
layout(binding = RING_FOURIER_TWIDDLES) uniform usamplerBuffer twiddles;
layout(binding = RING_FOURIER_RINGS) uniform usamplerBuffer rings;
layout(std430, binding = RING_FOURIER_VALUES_OUT) writeonly buffer Values { double values_out[]; };
layout(std430, binding = RING_FOURIER_WAVES_OUT) writeonly buffer Waves { dvec2 waves_out[]; };
layout(std430, binding = RING_FOURIER_COUNTS) readonly buffer Before { dvec2 before[]; };
layout(std430, binding = RING_FOURIER_WORK) writeonly buffer Work { dvec2 work[]; };
layout(push_constant) uniform Push { RingFourierPush push; };

dvec2 turned(dvec2 z, dvec2 w) { return dvec2(z.x * w.x + z.y * w.y, z.y * w.x - z.x * w.y); }

#define BUTTERFLY(R)                                                                                                   \
  if (radix == R) {                                                                                                    \
    double x[8], y[8];                                                                                                 \
    [[unroll]] for (uint j = 0; j < R; ++j) {                                                                          \
      const dvec2 z = before[sequence + q + stride * (p + j * parts)];                                                 \
      x[j] = z.x;                                                                                                      \
      y[j] = z.y;                                                                                                      \
    }                                                                                                                  \
    dft_##R(x, y);                                                                                                     \
    [[unroll]] for (uint k = 0; k < R; ++k)                                                                            \
      work[sequence + q + stride * (R * p + k)] =                                                                      \
          turned(dvec2(x[k], y[k]), two_doubles(texelFetch(twiddles, int(p * k * stride))));                           \
  }

void pass(uint sequence, uint i, uint n, uint radix) {
  const uint stride = n / push.span, parts = push.span / radix;
  if (radix <= 5 || radix == 8) {
    const uint p = i / stride, q = i - p * stride;
    BUTTERFLY(8)
    BUTTERFLY(4)
    BUTTERFLY(2)
    BUTTERFLY(3)
    BUTTERFLY(5)
  } else {
    const uint q = i % stride, k = i / stride % radix, p = i / stride / radix;
    dvec2 sum = dvec2(0);
    uint turn = 0; // j k mod radix
    for (uint j = 0; j < radix; ++j) {
      sum += turned(before[sequence + q + stride * (p + j * parts)],
                    two_doubles(texelFetch(twiddles, int(turn * (n / radix)))));
      turn += k;
      if (turn >= radix) turn -= radix;
    }
    work[sequence + q + stride * (radix * p + k)] =
        turned(sum, two_doubles(texelFetch(twiddles, int(p * k * stride))));
  }
}

void main() {
  const uint n = push.points, radix = push.radix[0];
  const uint each = KIND == RING_FOURIER_PASS           ? (radix <= 5 || radix == 8 ? n / radix : n)
                    : KIND == RING_FOURIER_WRITE_WAVES ? push.orders
                                                       : n;
  const uint all = push.pairs * push.fields * each, width = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  for (uint at = gl_GlobalInvocationID.x; at < all; at += width) {
    const uint row = at / each, i = at - row * each; // row: [pair][field]
    const uint sequence = row * n;
    const uint pair = row / push.fields, field = row - pair * push.fields;
    const uint north = (2 * field * push.pairs + pair) * n + i, south = north + push.pairs * n;
    const dvec2 ring = two_doubles(texelFetch(rings, int(push.first_pair + pair)));
    const double factor = push.weighted != 0 ? ring.x : 1.0lf;
    if (KIND == RING_FOURIER_READ_VALUES) {
      work[sequence + i] = dvec2(packDouble2x32(texelFetch(values_in, int(north)).xy),
                                 packDouble2x32(texelFetch(values_in, int(south)).xy));
    } else if (KIND == RING_FOURIER_READ_WAVES) {
      const bool mirrored = i >= push.orders;
      const uint m = mirrored ? n - i : i;
      dvec2 z = dvec2(0);
      if (m < push.orders) {
        const int wave = int(2 * (row * push.wave_columns + m));
        const dvec2 even = factor * two_doubles(texelFetch(waves_in, wave));
        const dvec2 odd = factor * ring.y * two_doubles(texelFetch(waves_in, wave + 1));
        const dvec2 a = even + odd, b = even - odd;
        z = mirrored ? dvec2(b.x - a.y, a.x + b.y) : dvec2(a.y + b.x, a.x - b.y);
      }
      work[sequence + i] = z;
    } else if (KIND == RING_FOURIER_WRITE_WAVES) {
      const double half_factor = 0.5lf * factor;
      const dvec2 z = before[sequence + i], u = before[sequence + (i == 0 ? 0 : n - i)];
      const dvec2 a = dvec2(z.x + u.x, z.y - u.y), b = dvec2(z.y + u.y, u.x - z.x);
      const uint wave = 2 * (row * push.wave_columns + i);
      waves_out[wave] = half_factor * (a + b);
      waves_out[wave + 1] = half_factor * ring.y * (a - b);
    } else if (KIND == RING_FOURIER_WRITE_VALUES) {
      const dvec2 z = before[sequence + i];
      values_out[north] = z.y;
      values_out[south] = z.x;
    } else {
      pass(sequence, i, n, radix);
    }
  }
}

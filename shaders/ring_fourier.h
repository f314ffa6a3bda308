// Interface of ring_fourier.comp and ring_fourier_pass.comp, read by GLSL and by C++.
//
// A pair of rings is transformed as one complex sequence z = north + i south; the other direction swaps real and imaginary
// parts on both ends. Stockham passes: of a sequence of n = length * stride points, one pass of radix r takes
//   y[q + stride (r p + k)] = w^(p k stride) sum_j x[q + stride (p + j length / r)] exp(-2 pi i j k / r),
// w = exp(-2 pi i / n), p < length / r, q < stride, and the next one has length / r and stride r.
#ifndef COWGPU_SHADERS_RING_FOURIER_H
#define COWGPU_SHADERS_RING_FOURIER_H
#include "shaders/layout.h"

// Specialization constants.
#define RING_FOURIER_KIND_ID 1   // ring_fourier: 1 values to waves, 0 waves to values; ring_fourier_pass: RING_FOURIER_...
#define RING_FOURIER_POINTS_ID 2 // ring_fourier: most points of a ring, which private arrays hold
#define RING_FOURIER_RADICES_ID 3 // ring_fourier: bit r is set where a pass of radix r is among them

// Bindings.
#define RING_FOURIER_VALUES_IN 0  // texels of one double: [field][north or south][pair][longitude]
#define RING_FOURIER_WAVES_IN 1   // texels of two doubles: [pair][field][order][E or O]
#define RING_FOURIER_TWIDDLES 2   // texels of two doubles: cos and sin of 2 pi j / n
#define RING_FOURIER_RINGS 3      // texels of two doubles: [pair], factor of the rings and cos theta
#define RING_FOURIER_VALUES_OUT 4 // as the first two
#define RING_FOURIER_WAVES_OUT 5
#define RING_FOURIER_COUNTS 6 // ring_fourier: loop iterations of each workgroup; ring_fourier_pass: sequences, read
#define RING_FOURIER_WORK 7   // ring_fourier_pass: sequences, written
#define RING_FOURIER_BINDINGS 8

// Kinds of ring_fourier_pass.
#define RING_FOURIER_READ_VALUES 0
#define RING_FOURIER_READ_WAVES 1
#define RING_FOURIER_WRITE_WAVES 2
#define RING_FOURIER_WRITE_VALUES 3
#define RING_FOURIER_PASS 4 // of any radix

#define RING_FOURIER_MOST_PASSES 12

#ifdef __cplusplus
namespace cowgpu::shaders {
#endif

struct RingFourierPush {
  uint points;       // n
  uint orders;       // m = 0 ... orders - 1, 2 orders - 1 <= n
  uint wave_columns; // orders in a row of the waves' buffer
  uint fields;
  uint pairs;      // of rings, of this dispatch's buffers
  uint first_pair; // of them in RING_FOURIER_RINGS
  uint weighted;   // 1: rings are multiplied by their factor
  uint passes;
  uint radix[RING_FOURIER_MOST_PASSES]; // ring_fourier_pass: radix[0] of this pass
  uint span;                            // ring_fourier_pass: length of this pass
};

#ifdef __cplusplus
static_assert(sizeof(RingFourierPush) == 84 && sizeof(RingFourierPush) <= 128);
} // namespace cowgpu::shaders
#endif
#endif

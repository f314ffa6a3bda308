// Interface of sample.comp and sample_weights.comp, read by GLSL and by C++.
#ifndef COWGPU_SHADERS_SAMPLE_H
#define COWGPU_SHADERS_SAMPLE_H
#include "shaders/layout.h"

// Bindings of sample.comp.
#define SAMPLE_SPANS 0      // four uints each: triangle, ring counted from the band's first, first point, points
#define SAMPLE_CORNERS 1    // nine doubles a triangle: corners a, b, c with det(a, b, c) > 0
#define SAMPLE_RINGS 2      // sin theta and cos theta of each ring of the band
#define SAMPLE_LONGITUDES 3 // cos phi and sin phi of each point of a ring
#define SAMPLE_OWNERS 4     // [ring][longitude]: triangles - the least triangle that holds the point, 0 if none does
#define SAMPLE_FOLDED 5     // [ring][longitude]: 1 where more than one triangle does
#define SAMPLE_OPEN 6       // points visited, pairs found, then pairs (point, triangle) that the filter cannot decide
#define SAMPLE_BINDINGS 7

// Of sample_weights.comp.
#define SAMPLE_WEIGHTS_CORNERS 0
#define SAMPLE_WEIGHTS_RINGS 1
#define SAMPLE_WEIGHTS_LONGITUDES 2
#define SAMPLE_WEIGHTS_OWNERS 3
#define SAMPLE_WEIGHTS_WEIGHTS 4 // three doubles a point, for the corners in the order of SAMPLE_CORNERS
#define SAMPLE_WEIGHTS_BINDINGS 5

#define SAMPLE_SPANS_PER_GROUP 64 // that a workgroup works through, one after the other
#define SAMPLE_SPAN_POINTS 512    // most points of a span: 64 * 512 iterations stay below every device's limit
#define SAMPLE_WEIGHTS_POINTS 16  // that an invocation works through

#ifdef __cplusplus
namespace cowgpu::shaders {
#endif

struct SamplePush {
  double margin; // a plane's value between -margin and margin decides nothing
  uint first_span;
  uint spans; // end of this dispatch's
  uint ring_length;
  uint triangles;
  uint capacity; // pairs that SAMPLE_OPEN holds
};

struct SampleWeightsPush {
  uint points;
  uint ring_length;
  uint triangles;
};

#ifdef __cplusplus
static_assert(sizeof(SamplePush) == 32);
static_assert(sizeof(SampleWeightsPush) == 12);
static_assert(SAMPLE_SPANS_PER_GROUP * (SAMPLE_SPAN_POINTS + 1) < 60000);
} // namespace cowgpu::shaders
#endif
#endif

// Interface of legendre_analysis.comp, legendre_synthesis.comp and legendre_sum.comp, read by GLSL and by C++.
#ifndef COWGPU_SHADERS_LEGENDRE_H
#define COWGPU_SHADERS_LEGENDRE_H
#include "shaders/layout.h"

// Specialization constants. The width of a workgroup is the number of consecutive orders m that it works on, one a lane.
#define LEGENDRE_STEPS_ID 1  // steps k of a segment, unrolled; even
#define LEGENDRE_RINGS_ID 2  // pairs of rings an iteration works on, unrolled; 2, 4 or 8
#define LEGENDRE_FIELDS_ID 3 // fields that share the recurrence
#define LEGENDRE_PAIRS_ID 4  // most pairs of rings of an item: sizes private arrays

// Bindings. Texels hold two doubles.
#define LEGENDRE_RECURRENCE 0 // texels [group][polar or not][k][lane]: a_k, b_k
#define LEGENDRE_SEEDS 1      // texels [group][pair][lane]: lambda_{k-1}, lambda_k where the pair starts
#define LEGENDRE_INPUT 2      // texels, two a complex pair: waves (analysis), [group][k][field][lane] (synthesis)
#define LEGENDRE_RINGS 3      // texels [pair]: t of host/plan/legendre.hpp, cos theta
#define LEGENDRE_OUTPUT 4     // what LEGENDRE_INPUT is in the other direction
#define LEGENDRE_ITEMS 5      // LegendreItem of each workgroup
#define LEGENDRE_FIRST 6      // [group][segment]: first pair that is active
#define LEGENDRE_COUNTS 7     // of each workgroup: loop iterations that really ran
#define LEGENDRE_BINDINGS 8

#define LEGENDRE_SUM_PARTIAL 0
#define LEGENDRE_SUM_TOTAL 1
#define LEGENDRE_SUM_BINDINGS 2

#ifdef __cplusplus
namespace cowgpu::shaders {
#endif

// A group of orders on a range of pairs of rings.
struct LegendreItem {
  uint group;      // orders group * lanes ...
  uint begin;      // pairs begin ... end - 1
  uint end;        // multiples of LEGENDRE_RINGS, as begin
  uint first_segment; // the first with an active pair; of the analysis 0
  uint segments;      // of the group
  uint recurrence; // texel of the group's first a_k, b_k; counted from the binding's start, as the two below
  uint seeds;      // texel of the group's pair 0
  uint series;     // step of the group's k = 0, so that k of field f and this lane is texel
                   // 2 (((series + k) fields + f) lanes + lane)
  uint result;     // analysis: the same for its result, which may be a partial sum
};

struct LegendrePush {
  uint first_item;
  uint first_pair;     // of the rings in the waves' buffer
  uint wave_columns;   // orders in a row of the waves' buffer: [pair][field][column]
  uint polar_pairs;    // pairs before this one take the polar recurrence
  uint first_segments; // length of a row of LEGENDRE_FIRST
};

struct LegendreSumPush {
  uint size;   // pairs of doubles to sum
  uint stride; // between partial sums
  uint count;  // partial sums
  uint add;    // 1: to what the total holds, 0: anew
};

#ifdef __cplusplus
static_assert(sizeof(LegendreItem) == 36);
static_assert(sizeof(LegendrePush) == 20 && sizeof(LegendreSumPush) == 16);
} // namespace cowgpu::shaders
#endif
#endif

// Interface of moments.comp and moments_sum.comp, read by GLSL and by C++.
#ifndef COWGPU_SHADERS_MOMENTS_H
#define COWGPU_SHADERS_MOMENTS_H
#include "shaders/layout.h"

// Specialization constants.
#define MOMENTS_LEVELS_ID 1         // degrees a sweep advances
#define MOMENTS_COLUMNS_ID 2        // columns of a row kept in private memory; 1 where rows live in the buffer
#define MOMENTS_ROWS_IN_BUFFER_ID 3 // rows live in the state buffer (discrete GPUs), not in private memory
#define MOMENTS_COLUMN_SCALE_ID 4   // s of host/plan/moments.hpp: 1 or 2

// Bindings.
#define MOMENTS_GROUPS 0  // MOMENTS_INPUTS doubles a pair, lanes innermost
#define MOMENTS_DEGREES 1 // last degree of each group
#define MOMENTS_STATE 2   // rows between dispatches: [group][column][MOMENTS_ROWS][lane]
#define MOMENTS_PARTIAL 3 // one partial sum a workgroup
#define MOMENTS_STEPS 4   // of each group: loop iterations that really ran, see moments.comp
#define MOMENTS_BINDINGS 5

#define MOMENTS_SUM_PARTIAL 0 // read and cleared
#define MOMENTS_SUM_TOTAL 1   // added to
#define MOMENTS_SUM_BINDINGS 2

// Inputs of a pair, in this order: directions a and b (x, y over twice the column scale; z), distance from the z axis
// (over twice the scale) and z of both outer vertices, cosine and sine of their longitudes, determinants.
#define MOMENTS_INPUTS 16
// Rows of a pair: v of both outer vertices, e and t (real, imaginary).
#define MOMENTS_ROWS 6

#ifdef __cplusplus
namespace cowgpu::shaders {
#endif

struct MomentsPush {
  double start;     // rows start at this power of two
  uint first_group; // of the chunk that the pairs and the state are bound for
  uint begin_group; // this dispatch works on groups begin ... end-1, counted from the chunk's first
  uint end_group;
  uint first_degree;   // of the slice, 1 or one past the end of the slice before
  uint last_degree;    // of the slice
  uint partial_stride; // doubles between two workgroups' partial sums
  uint state_columns;  // columns of a row in the state buffer
};

struct MomentsSumPush {
  uint size;   // doubles to sum
  uint stride; // between partial sums
  uint count;  // partial sums
};

#ifdef __cplusplus
static_assert(sizeof(MomentsPush) == 40 && sizeof(MomentsPush) <= 128, "push constants: 128 bytes everywhere");
static_assert(sizeof(MomentsSumPush) == 12);
} // namespace cowgpu::shaders
#endif
#endif

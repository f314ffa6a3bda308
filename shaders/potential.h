// Interface of potential.comp, read by GLSL and by C++.
#ifndef COWGPU_SHADERS_POTENTIAL_H
#define COWGPU_SHADERS_POTENTIAL_H
#include "shaders/layout.h"

#define POTENTIAL_TABLE 0  // texels of two doubles: of a range of orders, [m][l = m ... top]: a, b; c, s of each set
#define POTENTIAL_POINTS 1 // [lane][x', y', z', q, J_00] of four points
#define POTENTIAL_TOPS 2   // [lane]: degree up to which its points are summed
#define POTENTIAL_STATE 3  // [lane]: J_mm of the next order, real and imaginary part, then the sums of the sets
#define POTENTIAL_SEEN 4   // [lane]: entries of the table that were summed
#define POTENTIAL_BINDINGS 5

#define POTENTIAL_SETS_ID 1 // specialization constant: sets of coefficients, 1, 4 or 9
#define POTENTIAL_INPUTS 5  // of a point

#ifdef __cplusplus
namespace cowgpu::shaders {
#endif

struct PotentialPush {
  uint lanes;
  uint first, end; // orders
  uint top;        // degree that the table's rows end with
};

#ifdef __cplusplus
static_assert(sizeof(PotentialPush) == 16);
} // namespace cowgpu::shaders
#endif
#endif

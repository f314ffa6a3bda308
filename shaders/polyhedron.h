// Interface of polyhedron.comp, read by GLSL and by C++.
#ifndef COWGPU_SHADERS_POLYHEDRON_H
#define COWGPU_SHADERS_POLYHEDRON_H
#include "shaders/layout.h"

#define POLYHEDRON_STEPS 0  // texels of two doubles: [step][POLYHEDRON_STEP_TEXELS]
#define POLYHEDRON_RANGES 1 // [range]: first step and the step behind the last
#define POLYHEDRON_WORK                                                                                                \
  2 // [workgroup of all dispatches]: group and how many of its points, its first range, its first step, how many steps
#define POLYHEDRON_POINTS 3 // [group][x, y, z][lane]: pairs of points
#define POLYHEDRON_SUMS 4   // [group][row][lane]: pairs of points; added to
#define POLYHEDRON_SEEN 5   // [group][lane]: steps that were run; added to
#define POLYHEDRON_BINDINGS 6

#define POLYHEDRON_NEAR_ID                                                                                             \
  1 // specialization constant: 0 where all points are far_edges edges away from all faces, 1 anywhere
#define POLYHEDRON_SECOND_ID 2 // specialization constant: second derivatives too
#define POLYHEDRON_SEEDS_ID                                                                                            \
  3 // specialization constant: quotients and roots from single-precision ones, by Newton's steps

#define POLYHEDRON_LANES 32 // of a workgroup
#define POLYHEDRON_GROUP 64 // points of a workgroup
#define POLYHEDRON_COUNT_SHIFT 24 // the group's bits below the number of its points
#define POLYHEDRON_SHORT 64 // steps of a short sum
#define POLYHEDRON_STEP_TEXELS 10
#define POLYHEDRON_ROWS_FIRST 5   // V twice, -grad V, w
#define POLYHEDRON_ROWS_SECOND 18 // dd V (xx, xy, xz, yy, yz, zz), its jump, edges the point is on

// A step's numbers: the new corner N; of the face P Q N its normal, the normals m of PQ, QN and NP in its plane, four times its
// area, the height of N over PQ; the lengths of QN and NP; flags.
#define POLYHEDRON_FLAG_KEEP_P 1 // the next face is on the edge NP; else on QN
#define POLYHEDRON_FLAG_SHARP_PQ 2
#define POLYHEDRON_FLAG_SHARP_QN 4
#define POLYHEDRON_FLAG_SHARP_NP 8
#define POLYHEDRON_FLAG_FIRST 16 // a strip begins

#ifdef __cplusplus
namespace cowgpu::shaders {
#endif

struct PolyhedronPush {
  uint first; // of `work`
  uint unused;
  double touching;
};

#ifdef __cplusplus
static_assert(sizeof(PolyhedronPush) == 16);
} // namespace cowgpu::shaders
#endif
#endif

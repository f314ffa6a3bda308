// Interface of closest.comp, read by GLSL and by C++.
#ifndef COWGPU_SHADERS_CLOSEST_H
#define COWGPU_SHADERS_CLOSEST_H
#include "shaders/layout.h"

#define CLOSEST_NODES 0      // texels of four words, CLOSEST_NODE_TEXELS a node: low corner and index, high corner and
                             // count of the first child, the same of the second. Count 0: the index is a node's, else
                             // that of the first of so many triangles
#define CLOSEST_TRIANGLES 1  // texels, CLOSEST_TRIANGLE_TEXELS a triangle: u and its offset; v; n; length, cx, cy and
                             // c_inverse; ex, ey and e_inverse (TriangleFrame of host/plan/closest_tree.hpp)
#define CLOSEST_QUERIES 2    // [lane][x, y, z] of four queries
#define CLOSEST_LANES 3      // [lane]: first candidate, candidates or one of the words below
#define CLOSEST_CANDIDATES 4 // candidates in all, then each: triangle, from bit 28 on the queries it is one for
#define CLOSEST_BINDINGS 5

#define CLOSEST_NODE_TEXELS 4
#define CLOSEST_TRIANGLE_TEXELS 5
#define CLOSEST_LEAF 4          // most triangles of a leaf
#define CLOSEST_STACK 100       // most nodes that wait
#define CLOSEST_LIST 64         // candidates a lane holds
#define CLOSEST_ROUNDS 6        // times it filters them
#define CLOSEST_TRIANGLE_BITS 28

// In place of a number of candidates.
#define CLOSEST_LEFT 0xfffffffeu // too many steps, too many candidates: left to the host
#define CLOSEST_CUT 0xffffffffu  // the device ended a loop early

#ifdef __cplusplus
namespace cowgpu::shaders {
#endif

struct ClosestPush {
  float margin;      // that two distances of single precision may be wrong by, for coordinates up to 1
  float unreachable; // squared distance beyond every triangle's
  uint lanes;
  uint steps;    // nodes that a lane may visit
  uint capacity; // candidates that CLOSEST_CANDIDATES holds
};

#ifdef __cplusplus
static_assert(sizeof(ClosestPush) == 20);
} // namespace cowgpu::shaders
#endif
#endif

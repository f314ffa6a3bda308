// Interface of render.comp, read by GLSL and by C++.
#ifndef COWGPU_SHADERS_RENDER_H
#define COWGPU_SHADERS_RENDER_H
#include "shaders/layout.h"

#define RENDER_NODES 0     // texels of four words, RENDER_NODE_TEXELS a node (geometry/bvh.hpp): low corner, high corner,
                           // first, count
#define RENDER_TRIANGLES 1 // texels, RENDER_TRIANGLE_TEXELS a triangle in the order of the leaves: corner a, b - a, c - a as
                           // doubles, face
#define RENDER_RAYS 2      // seven doubles each: origin, direction, limit
#define RENDER_HITS 3      // RenderHit each
#define RENDER_BINDINGS 4

#define RENDER_NODE_TEXELS 4
#define RENDER_TRIANGLE_TEXELS 5
#define RENDER_LEAF 4   // most triangles of a leaf
#define RENDER_STACK 98 // most nodes that wait

// In place of a face.
#define RENDER_NOTHING 0xffffffffu // the ray hits none
#define RENDER_LEFT 0xfffffffeu    // too many steps: left to the host
#define RENDER_CUT 0xfffffffdu     // the device ended a loop early

#ifdef __cplusplus
namespace cowgpu::shaders {
#endif

struct RenderPush {
  uint rays;
  uint steps; // that a ray may take: nodes visited and taken up again
};

#ifdef __cplusplus
static_assert(sizeof(RenderPush) == 8);
} // namespace cowgpu::shaders
#endif
#endif

// Interface of flow.comp, read by GLSL and by C++.
#ifndef COWGPU_SHADERS_FLOW_H
#define COWGPU_SHADERS_FLOW_H
#include "shaders/layout.h"

// Specialization constant: the kernel of points on sheets (FLOW_ON_SHEET) alone.
#define FLOW_SHEET_ID 1

#define FLOW_FRAMES 0     // texels of two doubles, FLOW_FRAME_TEXELS a face: a, u, v, n, length, cx, cy, c_inverse, ex, ey,
                          // e_inverse (TriangleFrame of host/plan/closest_tree.hpp), then the outward normal
#define FLOW_LANES 1      // CLOSEST_LANES of shaders/closest.h
#define FLOW_CANDIDATES 2 // CLOSEST_CANDIDATES
#define FLOW_FACES 3      // [triangle of the search]: its face
#define FLOW_ENTRIES 4    // FlowEntry of each invocation
#define FLOW_NUMBERS 5    // [number][place]: doubles of the points' states
#define FLOW_WORDS 6      // [word][place]: words of them
#define FLOW_POINTS 7     // FlowPoint of each place
#define FLOW_BINDINGS 8

#define FLOW_FRAME_TEXELS 11
#define FLOW_CONTACTS 8     // most contacts of a point
#define FLOW_CONTACT_FACES 6 // most faces of a contact
#define FLOW_STATE_NUMBERS 54
#define FLOW_STATE_FACES 12 // the word where the contacts' faces begin
#define FLOW_STATE_WORDS (FLOW_STATE_FACES + FLOW_CONTACTS * FLOW_CONTACT_FACES)
#define FLOW_NO_FACE 0xffffffffu

// Iterations of the inner loops of one turn at most, and of the loop over candidates.
#define FLOW_TURN_ITERATIONS (8 + 50 + 93 * 10 + 9 + 9 * (9 + 7) + 9 + 9)
#define FLOW_OTHER_ITERATIONS (65 + 49 + 49) // candidates, faces loaded and saved

// What an invocation is to do.
#define FLOW_FIND 0u   // to find the face nearest to FlowPoint::query
#define FLOW_DEPART 1u // to begin with FlowPoint, whose query was answered
#define FLOW_GO_ON 2u  // to go on with its state, whose query was answered
#define FLOW_RESUME 3u // to go on where it ran out of turns

// What a query is for.
#define FLOW_LIFT 0u
#define FLOW_RAY 1u
#define FLOW_RESTART 2u
#define FLOW_SLIDE 3u
#define FLOW_LAST 4u

// What became of a point.
#define FLOW_ASKS 0u  // FlowPoint::query is to be answered
#define FLOW_BUSY 1u  // it ran out of turns
#define FLOW_FOUND 2u // FlowPoint::face is the nearest face
#define FLOW_LEFT 3u  // the search gave up: the host has to tell the face, and what to do then is what it was to do now
#define FLOW_DONE 4u  // FlowPoint holds the end
#define FLOW_CUT 5u   // the device ended a loop early

// Bits of FlowPoint::marks.
#define FLOW_INSIDE 1u   // it ended before it came out of the body
#define FLOW_TIGHTER 2u  // it takes the second tolerance
#define FLOW_RECORDED 4u // out: it passed FlowPoint::place at FlowPoint::time
#define FLOW_ON_SHEET 8u // out: it slides off two contacts with a face each

#ifdef __cplusplus
namespace cowgpu::shaders {
#endif

struct FlowEntry {
  uint place; // of the point
  uint what;  // FLOW_FIND ...
  uint face;  // the answer; FLOW_NO_FACE: among the candidates of query `query` of the search
  uint query;
};

// What host and device tell each other about a point; lengths and times are those of host/plan/flow_path.hpp.
struct FlowPoint {
  double query[3];
  double place[3];  // in: x; out: the end, or of FLOW_RECORDED
  double time;      // in: t; out: of FLOW_RECORDED
  double foot[3];   // in: of the ball; out: where the slide began
  double normal[3]; // in: of the ball
  double distance;  // in: of x from the foot; out: at the end
  double radius;    // in: of the ball; out: time when the slide began
  uint phase;       // in: what the query is for
  uint status;      // out
  uint face;        // in: of the foot; out: nearest at the end, or FLOW_FOUND
  uint flags;       // in and out, as the words below: cowgpu::FlowFlag
  uint marks;
  uint rounds;
  uint queries;
  uint events;
  uint steps;
  uint unused;
};

struct FlowPush {
  double time;
  double time_reached; // from which t is the end
  double scale;        // the body's diagonal
  double tolerance[2];
  double longest[2]; // step, of the distance
  double rounds[2];
  uint entries;
  uint capacity; // places of the arrays
  uint turns;    // of the loop an invocation may make
  uint first;    // entry
};

#ifdef __cplusplus
static_assert(sizeof(FlowEntry) == 16 && sizeof(FlowPoint) == 160 && sizeof(FlowPush) == 88);
} // namespace cowgpu::shaders
#endif
#endif

// Exact moments of triangle pairs; the mathematics stands in host/plan/moments.hpp.
//
// A lane is a pair of triangles, a subgroup a group of pairs, a workgroup one subgroup that works through its groups one
// after the other and adds to a partial sum of its own. A sweep runs once over the orders m and advances the rows by
// LEVELS degrees: level j works one column behind level j-1, so that a value is loaded and stored once per sweep.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#include "shaders/moments.h"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;
layout(constant_id = COWGPU_LOCAL_SIZE_ID) const uint LANES = 8;
layout(constant_id = MOMENTS_LEVELS_ID) const int LEVELS = 8;
layout(constant_id = MOMENTS_COLUMNS_ID) const int COLUMNS = 600;
layout(constant_id = MOMENTS_ROWS_IN_BUFFER_ID) const bool ROWS_IN_BUFFER = false;
layout(constant_id = MOMENTS_COLUMN_SCALE_ID) const int COLUMN_SCALE = 1;

layout(std430, binding = MOMENTS_GROUPS) readonly buffer Groups { double inputs[]; };
layout(std430, binding = MOMENTS_DEGREES) readonly buffer Degrees { uint last_degrees[]; };
layout(std430, binding = MOMENTS_STATE) buffer State { double state[]; };
layout(std430, binding = MOMENTS_PARTIAL) buffer Partial { double partial[]; };
layout(std430, binding = MOMENTS_STEPS) buffer Steps { uint steps_done[]; };
layout(push_constant) uniform Push { MomentsPush push; };

struct Column { double vc, vd, er, ei, tr, ti; };
struct Phase { double c_cos, c_sin, d_cos, d_sin; };

// Column of order m stands at m + LEVELS, so that columns -LEVELS ... -1 have a place.
double row0[COLUMNS], row1[COLUMNS], row2[COLUMNS], row3[COLUMNS], row4[COLUMNS], row5[COLUMNS];
uint state_base;

Column load_state(int column) {
  uint at = state_base + uint(column) * MOMENTS_ROWS * LANES;
  return Column(state[at], state[at + LANES], state[at + 2 * LANES], state[at + 3 * LANES], state[at + 4 * LANES],
                state[at + 5 * LANES]);
}
void store_state(int column, Column c) {
  uint at = state_base + uint(column) * MOMENTS_ROWS * LANES;
  state[at] = c.vc;
  state[at + LANES] = c.vd;
  state[at + 2 * LANES] = c.er;
  state[at + 3 * LANES] = c.ei;
  state[at + 4 * LANES] = c.tr;
  state[at + 5 * LANES] = c.ti;
}
Column load_column(int i) {
  if (ROWS_IN_BUFFER) return load_state(i);
  return Column(row0[i], row1[i], row2[i], row3[i], row4[i], row5[i]);
}
void store_column(int i, Column c) {
  if (ROWS_IN_BUFFER) {
    store_state(i, c);
  } else {
    row0[i] = c.vc;
    row1[i] = c.vd;
    row2[i] = c.er;
    row3[i] = c.ei;
    row4[i] = c.tr;
    row5[i] = c.ti;
  }
}

Phase turn(Phase f, double c_cos, double c_sin, double d_cos, double d_sin) {
  return Phase(f.c_cos * c_cos - f.c_sin * c_sin, f.c_cos * c_sin + f.c_sin * c_cos, f.d_cos * d_cos - f.d_sin * d_sin,
               f.d_cos * d_sin + f.d_sin * d_cos);
}

double below_scaled(double below) { return COLUMN_SCALE == 1 ? below : 4.0lf * below; }

// Values a lane holds after all steps.
const int KEPT = 2 * LEVELS / int(LANES) > 0 ? 2 * LEVELS / int(LANES) : 1;

// A macro, because the number of values has to be a constant for the loop to be unrolled.
#define SHARE(STEP)                                                                                                    \
  if (STEP < LANES) {                                                                                                  \
    const bool odd = (lane & STEP) != 0;                                                                               \
    if (2 * LEVELS / STEP > 1) {                                                                                       \
      [[unroll]] for (int i = 0; i < LEVELS / STEP; ++i) {                                                             \
        const double give = odd ? q[2 * i] : q[2 * i + 1];                                                             \
        const double keep = odd ? q[2 * i + 1] : q[2 * i];                                                             \
        q[i] = keep + subgroupShuffleXor(give, STEP);                                                                  \
      }                                                                                                                \
    } else {                                                                                                           \
      q[0] += subgroupShuffleXor(q[0], STEP);                                                                          \
    }                                                                                                                  \
  }

void main() {
  const uint lane = gl_SubgroupInvocationID;
  const Column nothing = Column(0, 0, 0, 0, 0, 0);
  const uint own_partial = gl_WorkGroupID.x * push.partial_stride;

  for (uint group = push.begin_group + gl_WorkGroupID.x; group < push.end_group; group += gl_NumWorkGroups.x) {
    const uint at = group * MOMENTS_INPUTS * LANES + lane;
    const double ax = inputs[at], ay = inputs[at + LANES], az = inputs[at + 2 * LANES];
    const double bx = inputs[at + 3 * LANES], by = inputs[at + 4 * LANES], bz = inputs[at + 5 * LANES];
    const double c_rho = inputs[at + 6 * LANES], c_z = inputs[at + 7 * LANES];
    const double d_rho = inputs[at + 8 * LANES], d_z = inputs[at + 9 * LANES];
    const double c_cos = inputs[at + 10 * LANES], c_sin = inputs[at + 11 * LANES];
    const double d_cos = inputs[at + 12 * LANES], d_sin = inputs[at + 13 * LANES];
    const double det_c = inputs[at + 14 * LANES], det_d = inputs[at + 15 * LANES];
    const int group_last = int(last_degrees[push.first_group + group]);
    const int last = min(group_last, int(push.last_degree));
    const int columns = last + 4 * LEVELS;
    state_base = group * push.state_columns * MOMENTS_ROWS * LANES + lane;

    // The rows as the last slice left them, and zeros beyond.
    int filled = 0;
    if (push.first_degree > 1) {
      filled = int(push.first_degree) + LEVELS;
      if (!ROWS_IN_BUFFER)
        for (int i = 0; i < filled; ++i) store_column(i, load_state(i));
    }
    for (int i = filled; i < columns; i += 4) {
      store_column(i, nothing);
      store_column(i + 1, nothing);
      store_column(i + 2, nothing);
      store_column(i + 3, nothing);
    }
    if (push.first_degree == 1) {
      const double det = (det_c + det_d) * push.start;
      store_column(LEVELS, Column(push.start, push.start, det, 0, det, 0));
    }

    // det exp(i m phi) at the first column of a sweep, m = 1 - LEVELS.
    Phase first_phase = Phase(det_c, 0, det_d, 0);
    [[unroll]] for (int m = 1; m < LEVELS; ++m) first_phase = turn(first_phase, c_cos, -c_sin, d_cos, -d_sin);

    // Software devices end loops early without a word; the host compares this count with what it asked for.
    uint steps = 0;
    uint sums = own_partial + lane;
    for (int degree = int(push.first_degree); degree <= last; degree += LEVELS) {
      // Three columns of each level's input; column i of a level sits in slot i mod 3.
      Column window[LEVELS * 3];
      Phase phase[LEVELS];
      [[unroll]] for (int j = 0; j < 3 * LEVELS; ++j) window[j] = nothing;
      [[unroll]] for (int j = 0; j < LEVELS; ++j) phase[j] = Phase(0, 0, 0, 0);
      window[0] = load_column(0);
      window[1] = load_column(1);
      phase[0] = first_phase;

      const int end = degree + 3 * LEVELS - 2;
      for (int ix = 1; ix <= end; ix += 3) {
        ++steps;
        [[unroll]] for (int p = 0; p < 3; ++p) {
          window[(p + 2) % 3] = load_column(ix + p + 1);
          double q[2 * LEVELS];
          [[unroll]] for (int j = 0; j < LEVELS; ++j) {
            const int same_slot = (p + 1 + 3 * LEVELS - j) % 3;
            const Column same = window[3 * j + same_slot];
            const Column above = window[3 * j + (same_slot + 1) % 3];
            const Column below = window[3 * j + (same_slot + 2) % 3];
            const Phase f = phase[j];
            Column o;
            o.vc = c_z * same.vc + c_rho * (above.vc - below_scaled(below.vc));
            o.vd = d_z * same.vd + d_rho * (above.vd - below_scaled(below.vd));
            const double ber = below_scaled(below.er), bei = below_scaled(below.ei);
            o.er = ((bz * same.er + bx * (above.er - ber)) + by * (above.ei + bei)) + (o.vc * f.c_cos + o.vd * f.d_cos);
            o.ei = ((bz * same.ei + bx * (above.ei - bei)) - by * (above.er + ber)) + (o.vc * f.c_sin + o.vd * f.d_sin);
            const double btr = below_scaled(below.tr), bti = below_scaled(below.ti);
            o.tr = ((az * same.tr + ax * (above.tr - btr)) + ay * (above.ti + bti)) + o.er;
            o.ti = ((az * same.ti + ax * (above.ti - bti)) - ay * (above.tr + btr)) + o.ei;
            q[2 * j] = o.tr;
            q[2 * j + 1] = o.ti;
            if (j + 1 < LEVELS)
              window[3 * (j + 1) + same_slot] = o;
            else
              store_column(max(ix + p - j, 0), o);
          }
          [[unroll]] for (int j = LEVELS - 1; j > 0; --j) phase[j] = phase[j - 1];
          phase[0] = turn(phase[0], c_cos, c_sin, d_cos, d_sin);

          // Sums over the lanes: at each step a lane keeps half of its values and gives the other half away.
          SHARE(1)
          SHARE(2)
          SHARE(4)
          SHARE(8)
          SHARE(16)
          SHARE(32)
          SHARE(64)
          if (2 * LEVELS >= LANES || lane < 2 * LEVELS)
            [[unroll]] for (int i = 0; i < KEPT; ++i) partial[sums + i * LANES] += q[i];
          sums += 2 * LEVELS;
        }
      }
      // Column -m is (-1)^m s^-2m times the conjugate of column m; the outer rows are real.
      double factor = 1;
      [[unroll]] for (int m = 1; m <= LEVELS; ++m) {
        factor = COLUMN_SCALE == 1 ? -factor : -0.25lf * factor;
        const Column c = load_column(LEVELS + m);
        store_column(LEVELS - m, Column(factor * c.vc, factor * c.vd, factor * c.er, -factor * c.ei, factor * c.tr,
                                        -factor * c.ti));
      }
    }
    if (lane == 0) steps_done[push.first_group + group] += steps;
    if (!ROWS_IN_BUFFER && group_last > last)
      for (int i = 0; i <= last + LEVELS; ++i) store_state(i, load_column(i));
  }
}

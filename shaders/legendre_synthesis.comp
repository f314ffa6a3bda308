// Sums over the steps, E = sum lambda_k qe_k and O / x = sum lambda_k qo_k; the mathematics stands in
// host/plan/legendre.hpp.
//
// A lane is an order m. A workgroup runs its orders through all segments of STEPS steps, and each segment over its rings,
// RINGS pairs at a time: the series of a segment stays in registers, the sums of the rings and the state of the
// recurrence wait in private arrays.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/legendre.h"
#include "shaders/legendre_lib.glsl"

const int PARTS = 4 * FIELDS; // real and imaginary part of E, then of O / x, a field
double sums[PAIRS * PARTS];

void main() {
  const int lane = int(gl_LocalInvocationID.x);
  const uint item_index = push.first_item + gl_WorkGroupID.x;
  const LegendreItem item = items[item_index];
  const int begin = int(item.begin), end = int(item.end);
  const int zone = begin < int(push.polar_pairs) ? 0 : 1; // items do not straddle
  const int recurrence_at = int(item.recurrence) + lane, seeds_at = int(item.seeds) + lane;
  uint count = 0;
  for (int pair = begin; pair < end; pair += RINGS) {
    ++count;
    const int at = slot(pair, begin) * PARTS;
    [[unroll]] for (int i = 0; i < RINGS * PARTS; ++i) sums[at + i] = 0;
  }
  int loaded = end; // pairs from here on have begun
  // Loops that end at their foot: software devices run one that ends at its head once too often, masked.
  int segment = int(item.first_segment);
  if (segment < int(item.segments)) do {
    ++count;
    const int begun = clamp(int(first_active[item.group * push.first_segments + uint(segment)]), begin, end);
    count += start_pairs(begin, begun, loaded, seeds_at);
    loaded = min(loaded, begun);

    double a[STEPS], b[STEPS], q[STEPS * PARTS];
    [[unroll]] for (int k = 0; k < STEPS; ++k) {
      const dvec2 ab = two_doubles(
          texelFetch(recurrence, recurrence_at + ((zone * int(item.segments) + segment) * STEPS + k) * LANES));
      a[k] = ab.x;
      b[k] = ab.y;
      const int row = (int(item.series) + segment * STEPS + k) * FIELDS;
      [[unroll]] for (int i = 0; i < 2 * FIELDS; ++i) {
        const dvec2 z = two_doubles(texelFetch(inputs, 2 * ((row + i / 2) * LANES + lane) + i % 2));
        q[k * PARTS + 2 * i] = z.x;
        q[k * PARTS + 2 * i + 1] = z.y;
      }
    }
    int pair = begun;
    do {
      ++count;
      const int at = slot(pair, begin);
      double t[RINGS], before[RINGS], now[RINGS], sum[RINGS * PARTS];
      [[unroll]] for (int r = 0; r < RINGS; ++r) {
        t[r] = packDouble2x32(texelFetch(rings, pair + r).xy);
        before[r] = previous[at + r];
        now[r] = current[at + r];
        [[unroll]] for (int i = 0; i < PARTS; ++i) sum[r * PARTS + i] = sums[(at + r) * PARTS + i];
      }
      [[unroll]] for (int k = 0; k < STEPS; k += 2) {
        [[unroll]] for (int r = 0; r < RINGS; ++r) {
          [[unroll]] for (int i = 0; i < PARTS; ++i) sum[r * PARTS + i] += now[r] * q[k * PARTS + i];
          before[r] += (a[k] * t[r] + b[k]) * now[r];
        }
        [[unroll]] for (int r = 0; r < RINGS; ++r) {
          [[unroll]] for (int i = 0; i < PARTS; ++i) sum[r * PARTS + i] += before[r] * q[(k + 1) * PARTS + i];
          now[r] += (a[k + 1] * t[r] + b[k + 1]) * before[r];
        }
      }
      [[unroll]] for (int r = 0; r < RINGS; ++r) {
        previous[at + r] = before[r];
        current[at + r] = now[r];
        [[unroll]] for (int i = 0; i < PARTS; ++i) sums[(at + r) * PARTS + i] = sum[r * PARTS + i];
      }
      pair += RINGS;
    } while (pair < end);
    ++segment;
  } while (segment < int(item.segments));
  const uint column = item.group * uint(LANES) + uint(lane);
  for (int pair = begin; pair < end; pair += RINGS) {
    ++count;
    const int at = slot(pair, begin) * PARTS;
    [[unroll]] for (int i = 0; i < 2 * FIELDS * RINGS; ++i) {
      const uint row = (uint(pair) - push.first_pair) * uint(FIELDS) + uint(i / 2);
      outputs[2 * (row * push.wave_columns + column) + uint(i % 2)] = dvec2(sums[at + 2 * i], sums[at + 2 * i + 1]);
    }
  }
  // Software devices end loops early without a word; the host compares this count with what it asked for.
  if (lane == 0) counts[item_index] = count;
}

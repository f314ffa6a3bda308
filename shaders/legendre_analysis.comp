// Sums over the pairs of rings, re_k = sum lambda_k f and ro_k = sum lambda_k g; the mathematics stands in
// host/plan/legendre.hpp.
//
// A lane is an order m, so that nothing is summed over lanes. A workgroup runs its orders through all segments of STEPS
// steps, and each segment over its rings, RINGS pairs at a time: the sums of a segment stay in registers, the state of the
// recurrence waits in private arrays.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/legendre.h"
#include "shaders/legendre_lib.glsl"

const int PARTS = 4 * FIELDS; // real and imaginary part of f, then of g, a field

void main() {
  const int lane = int(gl_LocalInvocationID.x);
  const uint item_index = push.first_item + gl_WorkGroupID.x;
  const LegendreItem item = items[item_index];
  const int begin = int(item.begin), end = int(item.end), polar = int(push.polar_pairs);
  const int recurrence_at = int(item.recurrence) + lane, seeds_at = int(item.seeds) + lane;
  const int column = int(item.group) * LANES + lane;
  uint count = 0;
  int loaded = end; // pairs from here on have begun
  // Loops that end at their foot: software devices run one that ends at its head once too often, masked.
  int segment = 0;
  do {
    ++count;
    const int begun = clamp(int(first_active[item.group * push.first_segments + uint(segment)]), begin, end);
    count += start_pairs(begin, begun, loaded, seeds_at);
    loaded = min(loaded, begun);

    double sum[STEPS * PARTS];
    [[unroll]] for (int i = 0; i < STEPS * PARTS; ++i) sum[i] = 0;
    // Polar pairs, then the others: each has recurrence coefficients of its own.
    const int last_zone = end > polar ? 1 : 0;
    int zone = begun < polar ? 0 : 1;
    if (begun < end) do {
      double a[STEPS], b[STEPS];
      [[unroll]] for (int k = 0; k < STEPS; ++k) {
        const dvec2 ab = two_doubles(texelFetch(
            recurrence, recurrence_at + ((zone * int(item.segments) + segment) * STEPS + k) * LANES));
        a[k] = ab.x;
        b[k] = ab.y;
      }
      const int zone_end = zone == 0 ? min(polar, end) : end;
      int pair = zone == 0 ? begun : max(begun, polar);
      do {
        ++count;
        const int at = slot(pair, begin);
        double t[RINGS], before[RINGS], now[RINGS], wave[RINGS * PARTS];
        [[unroll]] for (int r = 0; r < RINGS; ++r) {
          t[r] = packDouble2x32(texelFetch(rings, pair + r).xy);
          before[r] = previous[at + r];
          now[r] = current[at + r];
          const int row = (pair + r - int(push.first_pair)) * FIELDS;
          [[unroll]] for (int i = 0; i < 2 * FIELDS; ++i) {
            const dvec2 z =
                two_doubles(texelFetch(inputs, 2 * ((row + i / 2) * int(push.wave_columns) + column) + i % 2));
            wave[r * PARTS + 2 * i] = z.x;
            wave[r * PARTS + 2 * i + 1] = z.y;
          }
        }
        [[unroll]] for (int k = 0; k < STEPS; k += 2) {
          [[unroll]] for (int i = 0; i < PARTS; ++i) {
            double part = now[0] * wave[i];
            [[unroll]] for (int r = 1; r < RINGS; ++r) part += now[r] * wave[r * PARTS + i];
            sum[k * PARTS + i] += part;
          }
          [[unroll]] for (int r = 0; r < RINGS; ++r) before[r] += (a[k] * t[r] + b[k]) * now[r];
          [[unroll]] for (int i = 0; i < PARTS; ++i) {
            double part = before[0] * wave[i];
            [[unroll]] for (int r = 1; r < RINGS; ++r) part += before[r] * wave[r * PARTS + i];
            sum[(k + 1) * PARTS + i] += part;
          }
          [[unroll]] for (int r = 0; r < RINGS; ++r) now[r] += (a[k + 1] * t[r] + b[k + 1]) * before[r];
        }
        [[unroll]] for (int r = 0; r < RINGS; ++r) {
          previous[at + r] = before[r];
          current[at + r] = now[r];
        }
        pair += RINGS;
      } while (pair < zone_end);
      ++zone;
    } while (zone <= last_zone);
    const uint result_at = ((item.result + uint(segment * STEPS)) * FIELDS * LANES + lane) * 2;
    [[unroll]] for (int k = 0; k < STEPS; ++k)
      [[unroll]] for (int i = 0; i < 2 * FIELDS; ++i)
        outputs[result_at + uint((k * FIELDS + i / 2) * LANES * 2 + i % 2)] =
            dvec2(sum[k * PARTS + 2 * i], sum[k * PARTS + 2 * i + 1]);
    ++segment;
  } while (segment < int(item.segments));
  // Software devices end loops early without a word; the host compares this count with what it asked for.
  if (lane == 0) counts[item_index] = count;
}

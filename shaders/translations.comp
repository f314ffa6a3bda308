// Multipoles to local expansions: the mathematics stands in host/plan/translations.hpp. A lane takes a pair of cells, all four
// densities of it, through the records of an order: degree by degree it takes multipoles, turned so that the shift lies along
// z, shifts them, and gives what it turned back. A matrix's four numbers serve the densities of all lanes.
//
// Software devices end loops early without a word: lanes count their steps, and the host compares.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/translations.h"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;
layout(constant_id = TRANSLATIONS_PLACES_ID) const uint PLACES = 1024;

layout(binding = TRANSLATIONS_TABLE) uniform usamplerBuffer table;
layout(std430, binding = TRANSLATIONS_MULTIPOLES) readonly buffer Multipoles { dvec4 multipoles[]; };
layout(std430, binding = TRANSLATIONS_PAIRS) readonly buffer Pairs { dvec4 pairs[]; };
layout(std430, binding = TRANSLATIONS_EXPANDED) writeonly buffer Expanded { dvec4 expanded[]; };
layout(std430, binding = TRANSLATIONS_ROOM) buffer Room { dvec4 room[]; };
layout(std430, binding = TRANSLATIONS_SEEN) writeonly buffer Seen { uint seen[]; };
layout(push_constant) uniform Push { TranslationsPush push; };

dvec2 numbers(uint at) {
  const uvec4 texel = texelFetch(table, int(at));
  return dvec2(packDouble2x32(texel.xy), packDouble2x32(texel.zw));
}

uint room_index(uint place) {
  return (gl_WorkGroupID.x * PLACES + place) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
}
dvec4 at(uint place) { return room[room_index(place)]; }
void put(uint place, dvec4 value) { room[room_index(place)] = value; }

// The order m's next one: the angle once more.
dvec2 turned_by(dvec2 a, dvec2 by) { return dvec2(a.x * by.x - a.y * by.y, a.x * by.y + a.y * by.x); }

void main() {
  const uint pair = gl_GlobalInvocationID.x;
  if (pair >= push.pairs) return;
  const dvec4 own = pairs[pair];
  const uint source = unpackDouble2x32(own.w).x;
  const double across2 = own.x * own.x + own.y * own.y, across = sqrt(across2), far = sqrt(across2 + own.z * own.z);
  const bool is_turned = across > 1e-30LF * far;
  // About z so that the shift lies in the plane of y and z, then off z.
  const dvec2 turn = is_turned ? dvec2(own.y / across, -own.x / across) : dvec2(1, 0);
  const dvec2 tilt = is_turned ? dvec2(own.z / far, across / far) : dvec2(own.z / far, 0);
  const double inverse = 1.0LF / far;

  double scale = 1;
  uint count = 0, record = push.first;
  const uint end = push.first + 2 * push.records;
  do {
    const uvec4 what = texelFetch(table, int(record));
    if (what.x == TRANSLATIONS_MULTIPLY) {
      const uvec4 rows = texelFetch(table, int(record + 1));
      const uint columns = what.w & 0xffffu, stride = what.w >> 16;
      dvec4 a = dvec4(0), b = dvec4(0), c = dvec4(0), d = dvec4(0);
      uint matrix = what.y, from = what.z;
      const uint behind = what.y + 2 * columns;
      do {
        const dvec4 x = at(from);
        const dvec2 ab = numbers(matrix), cd = numbers(matrix + 1);
        a += ab.x * x;
        b += ab.y * x;
        c += cd.x * x;
        d += cd.y * x;
        from += stride;
        matrix += 2;
      } while (matrix < behind);
      count += columns;
      put(rows.x, a);
      put(rows.y, b);
      put(rows.z, c);
      put(rows.w, d);
    } else {
      const uint l = what.y, place = what.w;
      const bool take = what.x == TRANSLATIONS_TAKE, give = what.x == TRANSLATIONS_GIVE;
      const dvec2 by = take || give ? turn : tilt;
      const double sign = take || what.x == TRANSLATIONS_TILT ? 1.0LF : -1.0LF;
      if (give) scale = l == 0 ? inverse : scale * inverse;
      const uint from = source * push.harmonics + l * l, to = pair * push.harmonics + l * l;
      const double factor = take || give ? scale : 1.0LF;
      dvec4 zero = factor * (take ? multipoles[from] : at(place));
      if (give)
        expanded[to] = zero;
      else
        put(place, zero);
      dvec2 angle = by;
      for (uint m = 1; m <= l; ++m) {
        const dvec4 c = factor * (take ? multipoles[from + m] : at(place + m));
        const dvec4 s = factor * (take ? multipoles[from + l + m] : at(place + l + m));
        const dvec4 cosine = angle.x * c + (sign * angle.y) * s, sine = angle.x * s - (sign * angle.y) * c;
        if (give) {
          expanded[to + m] = cosine;
          expanded[to + l + m] = sine;
        } else {
          put(place + m, cosine);
          put(place + l + m, sine);
        }
        angle = turned_by(angle, by);
      }
      if (take) scale *= inverse;
      count += l;
    }
    ++count;
    record += 2;
  } while (record < end);
  seen[pair] = count;
}

// What both directions of the Legendre stage share.
layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;
layout(constant_id = COWGPU_LOCAL_SIZE_ID) const int LANES = 8;
layout(constant_id = LEGENDRE_STEPS_ID) const int STEPS = 32;
layout(constant_id = LEGENDRE_RINGS_ID) const int RINGS = 4;
layout(constant_id = LEGENDRE_FIELDS_ID) const int FIELDS = 1;
layout(constant_id = LEGENDRE_PAIRS_ID) const int PAIRS = 256;

layout(binding = LEGENDRE_RECURRENCE) uniform usamplerBuffer recurrence;
layout(binding = LEGENDRE_SEEDS) uniform usamplerBuffer seeds;
layout(binding = LEGENDRE_INPUT) uniform usamplerBuffer inputs;
layout(binding = LEGENDRE_RINGS) uniform usamplerBuffer rings;
layout(std430, binding = LEGENDRE_OUTPUT) writeonly buffer Output { dvec2 outputs[]; };
layout(std430, binding = LEGENDRE_ITEMS) readonly buffer Items { LegendreItem items[]; };
layout(std430, binding = LEGENDRE_FIRST) readonly buffer First { uint first_active[]; };
layout(std430, binding = LEGENDRE_COUNTS) writeonly buffer Counts { uint counts[]; };
layout(push_constant) uniform Push { LegendrePush push; };

dvec2 two_doubles(uvec4 texel) { return dvec2(packDouble2x32(texel.xy), packDouble2x32(texel.zw)); }

// lambda_{k-1}, lambda_k of the pairs of the item; the segment's steps run in registers.
double previous[PAIRS], current[PAIRS];
// Where a pair's state stands; with one iteration an item everything stays in registers.
int slot(int pair, int begin) { return PAIRS == RINGS ? 0 : pair - begin; }

// Starts pairs begin ... end-1 of an item; returns the iterations.
uint start_pairs(int first, int begin, int end, int seeds_at) {
  uint count = 0;
  for (int pair = begin; pair < end; pair += RINGS) {
    ++count;
    const int at = slot(pair, first);
    [[unroll]] for (int r = 0; r < RINGS; ++r) {
      const dvec2 start = two_doubles(texelFetch(seeds, seeds_at + (pair + r) * LANES));
      previous[at + r] = start.x;
      current[at + r] = start.y;
    }
  }
  return count;
}

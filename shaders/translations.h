// Interface of translations.comp and translations_sum.comp, read by GLSL and by C++.
#ifndef COWGPU_SHADERS_TRANSLATIONS_H
#define COWGPU_SHADERS_TRANSLATIONS_H
#include "shaders/layout.h"

#define TRANSLATIONS_TABLE 0      // texels: records of two each, and matrices [column][4 rows] of two doubles a texel
#define TRANSLATIONS_MULTIPOLES 1 // [source][harmonic]: four densities
#define TRANSLATIONS_PAIRS 2      // [pair]: the target's centre as seen from the source's, and 2^52 + the source
#define TRANSLATIONS_EXPANDED 3   // [pair][harmonic]: four densities
#define TRANSLATIONS_ROOM 4       // [workgroup][place][lane]: four densities
#define TRANSLATIONS_SEEN 5       // [pair]: records and columns that were run
#define TRANSLATIONS_BINDINGS 6

#define TRANSLATIONS_PLACES_ID 1 // specialization constant: places that a lane works in

#define TRANSLATIONS_SUM_RUNS 0 // [run]: its local expansion, its first pair, how many
#define TRANSLATIONS_SUM_EXPANDED 1
#define TRANSLATIONS_SUM_LOCALS 2 // [local expansion][harmonic]: four densities; added to
#define TRANSLATIONS_SUM_BINDINGS 3

// A record's first texel is its kind and three numbers, its second four places.
#define TRANSLATIONS_MULTIPLY 0 // matrix, first place of the column, columns + 2^16 stride; the rows' places
#define TRANSLATIONS_TAKE 1     // degree, -, place: multipoles of this degree, turned about z
#define TRANSLATIONS_TILT 2     // degree, -, place: turned by the shift's angle from z
#define TRANSLATIONS_TILT_BACK 3
#define TRANSLATIONS_GIVE 4 // degree, -, place: turned back about z, and given to the local expansion

#ifdef __cplusplus
namespace cowgpu::shaders {
#endif

struct TranslationsPush {
  uint pairs;     // of the dispatch
  uint first;     // texel of the order's first record
  uint records;   // of the order
  uint harmonics; // of the order
};

struct TranslationsSumPush {
  uint runs;
  uint harmonics; // of the order
  uint stride;    // harmonics of a local expansion
  uint unused;
};

#ifdef __cplusplus
static_assert(sizeof(TranslationsPush) == 16 && sizeof(TranslationsSumPush) == 16);
} // namespace cowgpu::shaders
#endif
#endif

// The arithmetic of translations, in vectors of pairs and densities.
#pragma once

#include "host/plan/translations.hpp"

namespace cowgpu::plan {

/// Doubles that translate() works in.
inline constexpr std::size_t translation_width = 32; // of one harmonic: pairs of one batch times densities, at most
inline constexpr std::size_t translation_room(int order) {
  const std::size_t degrees = std::size_t(order + 1);
  return translation_width * (2 * degrees * degrees + 2 * (2 * degrees) + 6 * (degrees + 1));
}

/// Translations::add() for shifts that are not 0.
void translate(const Translations& translations, Translation kind, int order, std::span<const TranslationPair> pairs,
               double* room);

} // namespace cowgpu::plan

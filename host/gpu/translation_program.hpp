// What a device does for translations of multipoles to local expansions, from the CPU's tables.
#pragma once

#include "engine/kernels/translations.hpp"
#include "host/plan/translations.hpp"

#include <cstdint>
#include <vector>

namespace cowgpu::gpu {

/// The steps of each order up to that of the translations, their matrices, and the places that a lane works in.
struct TranslationProgram {
  std::vector<double> matrix;
  std::vector<std::vector<engine::TranslationRecord>> orders; ///< [order]
  std::uint32_t places;
};
TranslationProgram translation_program(const plan::Translations& translations);

} // namespace cowgpu::gpu

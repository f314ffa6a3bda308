// The kernel translations: expansions in solid harmonics about cells' centres to local ones about others. The mathematics stands in
// host/plan/translations.hpp, the shader's interface in shaders/translations.h.
#pragma once

#include "engine/gpu.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace cowgpu::engine {

class Buffer;

/// Densities whose expansions move together, and rows of a matrix that are multiplied at once.
inline constexpr std::size_t translation_densities = 4, translation_rows = 4;

/// What a lane does one after the other. Places are those of its own room, each with all densities.
enum class TranslationStep : std::uint32_t { multiply, take, tilt, tilt_back, give };
struct TranslationRecord {
  TranslationStep step;
  std::uint32_t degree = 0; ///< all but multiply
  std::uint32_t place = 0;  ///< where the degree's harmonics are, or a column begins
  /// multiply: of `columns` places `stride` apart, by four numbers a column from matrix[`entries`] on; to the places `rows`.
  std::uint32_t entries = 0, columns = 0, stride = 0;
  std::array<std::uint32_t, translation_rows> rows = {};
};

struct TranslationsInput {
  std::span<const double> matrix;
  std::span<const std::vector<TranslationRecord>> orders; ///< [order]
  std::uint32_t places = 0;                               ///< size of a lane's room
  std::uint32_t iteration_budget = 60000;                 ///< loop iterations an invocation may run in one dispatch
};

/// A pair of cells: the target's centre as seen from the source's, and which multipoles.
struct TranslationPair {
  std::array<double, 3> shift;
  std::uint32_t source;
};

/// Pairs next to each other that have one target.
struct TranslationRun {
  std::uint32_t local, first, count;
};

/// Translations on a device.
class Translations {
public:
  /// Throws Error(out_of_range) for tables larger than the device reads and orders beyond the budget, Error(vulkan),
  /// Error(device_lost).
  Translations(Device& device, const TranslationsInput& input);
  ~Translations();
  Translations(const Translations&) = delete;
  Translations& operator=(const Translations&) = delete;

  /// Makes room for so many local expansions of the highest order: zeros.
  void begin(std::size_t locals);
  /// Upper bound of pairs and of sources that add() takes at once.
  std::size_t most_pairs(int order) const;
  std::size_t most_sources(int order) const;
  /// `multipoles` [source][harmonic][density] to the local expansions of the pairs' targets, both to this order. Throws
  /// Error(cut_short), Error(vulkan), Error(device_lost), Error(stopped).
  void add(int order, std::span<const double> multipoles, std::span<const TranslationPair> pairs,
           std::span<const TranslationRun> runs);
  /// [local][harmonic of the highest order][density]
  void read(std::span<double> locals);

  /// Upper bound of the bytes on the device beside the table, with so many local expansions.
  static std::uint64_t device_bytes(int highest_order, std::uint64_t locals);

private:
  struct Order {
    std::uint32_t first, records, steps;
  };
  std::uint32_t highest() const { return std::uint32_t(orders_.size() - 1); }

  Device& device_;
  std::uint32_t width_, groups_, places_;
  std::vector<Order> orders_;
  std::unique_ptr<Buffer> table_, multipoles_, pairs_, expanded_, room_, seen_, runs_, locals_;
};

} // namespace cowgpu::engine

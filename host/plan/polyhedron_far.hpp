// What multipoles of faces make at points: the far field's second half.
#pragma once

#include "host/plan/polyhedron_pairs.hpp"
#include "host/plan/polyhedron_sources.hpp"
#include "host/plan/translations.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cowgpu::plan {

/// Local expansions of one task's cells, and what comes of them at the points of its leaves. One for each thread.
class FarSums {
public:
  FarSums(const PolyhedronSources& sources, const Translations& translations)
      : sources_(&sources), translations_(&translations), room_(translations.order()) {}

  /// Makes locals of the task's cells: zeros.
  void begin(const TaskPairs& pairs);
  /// Adds what the pairs' multipoles make of them.
  void translate(const PlaceTree& targets, const TaskPairs& pairs);
  /// Of a cell of the task: [harmonic][density].
  double* local(std::uint32_t cell) { return &locals_[(cell - first_) * densities * harmonics(sources_->order())]; }
  /// The locals down to the task's leaves.
  void pass_down(const PlaceTree& targets, const TaskPairs& pairs);

  /// Rows that add_leaf() adds to: V, grad V, w/4 pi; then, if `second`, dd V (xx, xy, xz, yy, yz, zz).
  static constexpr std::size_t first_rows = 5, second_rows = 11;

  /// Adds to sums[row][count] what all that is far makes at the leaf's points[3][count], `count` a multiple of 8; both are
  /// in units, and aligned to 64 bytes.
  void add_leaf(const PlaceTree& targets, const TaskPairs& pairs, std::uint32_t leaf, const double* points,
                std::size_t count, bool second, double* sums);

  /// The same of one cell's multipoles, at points outside its ball.
  void add_multipoles(std::uint32_t source, const double* points, std::size_t count, bool second, double* sums);

  /// Upper bound of the bytes that a task of so many points takes.
  static std::uint64_t bytes(std::uint64_t points, std::uint32_t largest_leaf, int order);

private:
  void see_from(const Vec3& centre, const double* points, std::size_t count);
  void add(int order, const double* points, std::size_t count, const double* expanded, const double* factors,
           bool second, double* sums);

  const PolyhedronSources* sources_;
  const Translations* translations_;
  Translations::Room room_;
  std::uint32_t first_ = 0;
  std::vector<double> locals_, derived_, values_;
  std::vector<TranslationPair> shifts_;
  struct alignas(64) Line {
    double values[8];
  };
  std::vector<Line> seen_; // points from a centre
};

/// Coefficients of the four densities, and of combinations of A's derivatives: its divergence (`sets` 5), or
/// d_j A_i for ij = xx, xy, xz, yy, yz, zz (`sets` 10). derived[harmonic][sets]. Locals stay of their order; multipoles go up
/// by one.
void derive_locals(int order, const double* local, std::size_t sets, double* derived);
void derive_multipoles(int order, const double* multipole, std::size_t sets, double* derived);

} // namespace cowgpu::plan

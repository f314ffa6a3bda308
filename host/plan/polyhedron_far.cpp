#include "host/plan/polyhedron_far.hpp"

#include "host/plan/solid_sums_kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace cowgpu::plan {
namespace {

// Calls term(component, low, high, factor): the derivative of the harmonic `high` of degree l along a component has `factor`
// times the harmonic `low` of degree l - 1, as HarmonicFactors has them.
template <class Term>
void for_derivatives(int l, const Term& term) {
  const HarmonicFactors& factors = harmonic_factors();
  const auto row = std::size_t(l);
  for (int m = 0; m <= l; ++m) {
    const auto column = std::size_t(m);
    const double along = factors.along[row][column], down = factors.down[row][column], up = factors.up[row][column];
    const std::size_t c = cosine_index(l, m), s = sine_index(l, m);
    if (m < l) term(2, cosine_index(l - 1, m), c, along);
    if (m > 0 && m < l) term(2, sine_index(l - 1, m), s, along);
    if (m > 0) {
      term(0, cosine_index(l - 1, m - 1), c, down);
      term(1, cosine_index(l - 1, m - 1), s, down);
    }
    if (m > 1) {
      term(0, sine_index(l - 1, m - 1), s, down);
      term(1, sine_index(l - 1, m - 1), c, -down);
    }
    if (m + 1 <= l - 1) {
      term(0, cosine_index(l - 1, m + 1), c, -up);
      term(1, sine_index(l - 1, m + 1), c, -up);
      if (m > 0) term(0, sine_index(l - 1, m + 1), s, -up);
      if (m > 0) term(1, cosine_index(l - 1, m + 1), s, up);
    }
  }
}

// The set of d_i A_j; none where i < j: those of i >= j are taken for both, as sums over all faces are symmetric.
std::optional<std::size_t> set_of(std::size_t i, std::size_t j, std::size_t sets) {
  if (sets == 5) return i == j ? std::optional<std::size_t>(4) : std::nullopt;
  constexpr std::array<std::array<std::size_t, 3>, 3> of = {{{4, 5, 6}, {5, 7, 8}, {6, 8, 9}}};
  return i < j ? std::nullopt : std::optional(of[j][i]);
}

void derive(int order, const double* from, std::size_t sets, bool local, double* derived) {
  const int top = local ? order : order + 1;
  std::fill(derived, derived + sets * harmonics(top), 0.0);
  for (std::size_t k = 0; k < harmonics(order); ++k)
    std::copy(from + densities * k, from + densities * (k + 1), derived + sets * k);
  for (int l = 1; l <= top; ++l)
    for_derivatives(l, [&](std::size_t i, std::size_t low, std::size_t high, double factor) {
      // Of a local expansion's harmonic of degree l, or of a multipole's of degree l - 1 with the sign turned.
      const double* coefficients = from + densities * (local ? high : low);
      double* to = derived + sets * (local ? low : high);
      for (std::size_t j = 0; j < 3; ++j)
        if (const auto set = set_of(i, j, sets)) to[*set] += (local ? factor : -factor) * coefficients[j];
    });
}

} // namespace

void derive_locals(int order, const double* local, std::size_t sets, double* derived) {
  derive(order, local, sets, true, derived);
}

void derive_multipoles(int order, const double* multipole, std::size_t sets, double* derived) {
  derive(order, multipole, sets, false, derived);
}

void FarSums::begin(const TaskPairs& pairs) {
  first_ = pairs.first;
  locals_.assign((pairs.last - pairs.first) * densities * harmonics(sources_->order()), 0.0);
}

void FarSums::translate(const PlaceTree& targets, const TaskPairs& pairs) {
  const std::span<const TreeCell> to = targets.cells, from = sources_->cells();
  for (int p = 0; p <= sources_->order(); ++p) {
    shifts_.clear();
    for (const CellPair& pair : pairs.to_locals[std::size_t(p)])
      shifts_.push_back(
          {sources_->multipoles(pair.source), local(pair.target), to[pair.target].centre - from[pair.source].centre});
    translations_->add(Translation::multipole_to_local, p, shifts_, room_);
  }
}

void FarSums::pass_down(const PlaceTree& targets, const TaskPairs& pairs) {
  const std::span<const TreeCell> to = targets.cells;
  const int order = sources_->order();
  // Level by level, so that many go together.
  std::vector<std::vector<std::uint32_t>> levels;
  for (std::uint32_t cell = pairs.first; cell < pairs.last; ++cell) {
    if (to[cell].leaf()) continue;
    const std::size_t level = to[cell].depth - to[pairs.first].depth;
    if (levels.size() <= level) levels.resize(level + 1);
    levels[level].push_back(cell);
  }
  for (const auto& level : levels) {
    shifts_.clear();
    for (const std::uint32_t cell : level)
      for (const std::uint32_t child : {cell + 1, to[cell].right})
        shifts_.push_back({local(cell), local(child), to[child].centre - to[cell].centre});
    translations_->add(Translation::local_to_local, order, shifts_, room_);
  }
}

void FarSums::add(int order, const double* points, std::size_t count, const double* expanded, const double* factors,
                  bool second, double* sums) {
  const std::size_t sets = second ? 10 : 5;
  values_.resize(sets * count);
  sum_harmonics(order, sets, expanded, &seen_.front().values[0], count, values_.data());
  if (factors)
    for (std::size_t set = 0; set < sets; ++set)
      for (std::size_t i = 0; i < count; ++i) values_[set * count + i] *= factors[i];
  const double* value = values_.data();
  const Vec3& origin = sources_->origin();
  for (std::size_t i = 0; i < count; ++i) {
    double along = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      along += (points[k * count + i] - origin[Eigen::Index(k)]) * value[k * count + i];
      sums[(1 + k) * count + i] -= value[k * count + i];
    }
    sums[i] += (value[3 * count + i] - along) / 2;
    constexpr double turn = 1 / (4 * std::numbers::pi);
    if (!second) {
      sums[4 * count + i] += turn * value[4 * count + i];
      continue;
    }
    sums[4 * count + i] += turn * (value[4 * count + i] + value[7 * count + i] + value[9 * count + i]);
    for (std::size_t k = 0; k < 6; ++k) sums[(5 + k) * count + i] -= value[(4 + k) * count + i];
  }
}

void FarSums::see_from(const Vec3& centre, const double* points, std::size_t count) {
  seen_.resize((4 * count + 7) / 8);
  double* seen = seen_.front().values;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < count; ++i) seen[k * count + i] = points[k * count + i] - centre[Eigen::Index(k)];
}

void FarSums::add_leaf(const PlaceTree& targets, const TaskPairs& pairs, std::uint32_t leaf, const double* points,
                       std::size_t count, bool second, double* sums) {
  const int order = sources_->order();
  const std::size_t sets = second ? 10 : 5;
  derived_.resize(sets * harmonics(order + 1));
  derive_locals(order, local(leaf), sets, derived_.data());
  see_from(targets.cells[leaf].centre, points, count);
  add(order, points, count, derived_.data(), nullptr, second, sums);
  for (const CellPair& pair : TaskPairs::of_leaf(pairs.at_points, leaf))
    add_multipoles(pair.source, points, count, second, sums);
}

void FarSums::add_multipoles(std::uint32_t source, const double* points, std::size_t count, bool second, double* sums) {
  const int order = sources_->order();
  const std::size_t sets = second ? 10 : 5;
  derived_.resize(sets * harmonics(order + 1));
  derive_multipoles(order, sources_->multipoles(source), sets, derived_.data());
  see_from(sources_->cells()[source].centre, points, count);
  // R(x)/|x|^(2l+1) is R(x/|x|^2)/|x|.
  double *seen = seen_.front().values, *inverse = seen + 3 * count;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = seen[i], y = seen[count + i], z = seen[2 * count + i], square = x * x + y * y + z * z;
    inverse[i] = 1 / std::sqrt(square);
    for (std::size_t k = 0; k < 3; ++k) seen[k * count + i] /= square;
  }
  add(order + 1, points, count, derived_.data(), inverse, second, sums);
}

std::uint64_t FarSums::bytes(std::uint64_t points, std::uint32_t largest_leaf, int order) {
  return PlaceTree::cell_count(points, largest_leaf) * densities * harmonics(order) * sizeof(double) +
         Translations::Room::bytes(order) + 20 * harmonics(order + 1) * sizeof(double) + (1 << 16);
}

} // namespace cowgpu::plan

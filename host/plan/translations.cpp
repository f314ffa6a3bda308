#include "host/plan/translations.hpp"

#include "host/plan/translations_kernel.hpp"

#include <cmath>

namespace cowgpu::plan {
namespace {

// Order by order: the harmonics (m, m) ... (order, m) of cosine, then those of sine.
int upright_index(int order, int m, bool sine) {
  int first = 0;
  for (int k = 0; k < m; ++k) first += (k > 0 ? 2 : 1) * (order - k + 1);
  return first + (sine ? order - m + 1 : 0);
}

// The matrix value(row, column) in blocks of about as many rows each.
template <class Value>
void add_blocks(std::vector<Translations::Block>& blocks, std::vector<double>& matrix, const std::vector<int>& rows,
                const std::vector<int>& outputs, const std::vector<int>& columns, int first, int stride,
                const Value& value) {
  const int count = int(rows.size()),
            parts = (count + Translations::Block::most_rows - 1) / Translations::Block::most_rows;
  for (int part = 0, at = 0; part < parts; ++part) {
    const int size = (count - at) / (parts - part);
    Translations::Block block{};
    block.matrix = std::uint32_t(matrix.size());
    block.count = std::uint16_t(size);
    block.columns = std::uint16_t(columns.size());
    block.first = std::uint16_t(first);
    block.stride = std::uint16_t(stride);
    for (const int column : columns)
      for (int r = 0; r < size; ++r) matrix.push_back(value(rows[std::size_t(at + r)], column));
    for (int r = 0; r < size; ++r) block.rows[std::size_t(r)] = std::uint16_t(outputs[std::size_t(at + r)]);
    blocks.push_back(block);
    at += size;
  }
}

} // namespace

Translations::Translations(int order) : order_(order), exchanges_(std::size_t(order + 1)) {
  for (int l = 0; l <= order; ++l) add_exchange(l);
  for (int p = 0; p <= order; ++p) to_locals_.push_back(make_shift(Translation::multipole_to_local, p));
  between_multipoles_ = make_shift(Translation::multipole_to_multipole, order);
  between_locals_ = make_shift(Translation::local_to_local, order);
}

void Translations::add_exchange(int l) {
  const HarmonicFactors& factors = harmonic_factors();
  for (const bool upright : {false, true})
    for (const bool sine : {false, true})
      for (int parity = 0; parity < 2; ++parity) {
        const int least = sine ? 1 : 0;
        std::vector<int> rows, outputs, columns;
        for (int m = least; m <= l; ++m) {
          if (m % 2 == parity) {
            rows.push_back(m);
            outputs.push_back(upright ? upright_index(order_, m, sine) + l - m : (sine ? l : 0) + m);
          }
          if ((l + parity + least + m) % 2 == 0) columns.push_back(m);
        }
        if (rows.empty()) continue;
        // Rows that vanish take a column of zeros.
        const bool vanish = columns.empty();
        if (vanish) columns.push_back(least);
        const std::vector<double>& matrix = (sine ? factors.sines : factors.cosines)[std::size_t(l)];
        Exchange& to = exchanges_[std::size_t(l)];
        add_blocks(upright ? to.upright : to.flat, exchange_matrix_, rows, outputs, columns,
                   (sine ? l : 0) + columns[0], 2,
                   [&](int m, int k) { return vanish ? 0 : matrix[std::size_t(m * (l + 1) + k)]; });
      }
}

// Along z, with powers of the shift left out: multipole l to local j by (-1)^(j+m) (l+j)!/(a_l a_j), a_l = sqrt((l-m)! (l+m)!),
// multipole l to multipole j >= l by (-1)^(j+l) a_j/(a_l (j-l)!), local l to local j <= l by a_l/(a_j (l-j)!).
auto Translations::make_shift(Translation kind, int order) const -> Shift {
  std::array<double, 2 * largest_expansion_order + 1> factorial{1};
  for (std::size_t k = 1; k < factorial.size(); ++k) factorial[k] = factorial[k - 1] * double(k);
  const HarmonicFactors& factors = harmonic_factors();
  Shift shift;
  for (int m = 0; m <= order; ++m)
    for (int sine = 0; sine < (m > 0 ? 2 : 1); ++sine) {
      std::vector<int> rows, outputs;
      for (int l = m; l <= order; ++l) {
        rows.push_back(l);
        outputs.push_back(int(sine > 0 ? sine_index(l, m) : cosine_index(l, m)));
      }
      add_blocks(shift.blocks, shift.matrix, rows, outputs, rows, upright_index(order_, m, sine > 0), 1,
                 [&](int j, int l) {
                   const auto a = [&](int degree) {
                     return factors.norm[std::size_t(degree)][std::size_t(m)] / std::sqrt(m > 0 ? 2. : 1.);
                   };
                   const auto odd = [](int power) { return power % 2 != 0 ? -1. : 1.; };
                   if (kind == Translation::multipole_to_local)
                     return odd(j + m) * (factorial[std::size_t(l + j)] / a(l) / a(j));
                   if (kind == Translation::multipole_to_multipole)
                     return l <= j ? odd(j + l) * (a(j) / a(l) / factorial[std::size_t(j - l)]) : 0;
                   return l >= j ? a(l) / a(j) / factorial[std::size_t(l - j)] : 0;
                 });
    }
  return shift;
}

double Translations::multiply_adds(int order) const {
  const auto of = [](const std::vector<Block>& blocks) {
    double sum = 0;
    for (const Block& block : blocks) sum += double(densities) * block.count * block.columns;
    return sum;
  };
  double sum = of(shift(Translation::multipole_to_local, order).blocks);
  for (std::size_t l = 0; l <= std::size_t(order); ++l) sum += 3 * of(exchanges_[l].flat) + of(exchanges_[l].upright);
  return sum;
}

Translations::Room::Room(int order) : lines_(translation_room(order) / 8) {}

std::size_t Translations::Room::bytes(int order) {
  return 8 * translation_room(order);
}

void Translations::add(Translation kind, int order, std::span<const TranslationPair> pairs, Room& room) const {
  if (kind == Translation::multipole_to_local) return translate(*this, kind, order, pairs, room.data());
  // Where there is no shift the coefficients stay.
  std::size_t first = 0;
  for (std::size_t i = 0; i <= pairs.size(); ++i) {
    const bool stays = i < pairs.size() && pairs[i].shift.cwiseAbs().maxCoeff() <= least_shift;
    if (i < pairs.size() && !stays) continue;
    translate(*this, kind, order, pairs.subspan(first, i - first), room.data());
    first = i + 1;
    if (!stays) continue;
    for (std::size_t k = 0; k < densities * harmonics(order); ++k) pairs[i].to[k] += pairs[i].from[k];
  }
}

} // namespace cowgpu::plan

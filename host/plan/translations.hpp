// Expansions in solid harmonics moved to other centres, many at once.
#pragma once

#include "host/plan/solid_harmonics.hpp"
#include "host/types.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// Densities whose expansions move together: coefficients are [harmonic][density].
inline constexpr std::size_t densities = 4;

enum class Translation { multipole_to_local, multipole_to_multipole, local_to_local };

/// Shifts from which on powers up to the largest order neither overflow nor vanish, in a body of size 1.
inline constexpr double least_shift = 0x1p-28;

struct TranslationPair {
  const double* from;
  double* to;
  Vec3 shift; ///< the new centre seen from the old one; no component larger than least_shift: no shift at all
};

/// What multiplies vectors of several pairs: a turn about z brings the shift into the plane of y and z, an exchange of x and z
/// and a second turn bring it onto x, another exchange onto z, along which the orders m do not mix; then all the way back (of the
/// kind C. A. White and M. Head-Gordon, J. Chem. Phys. 105 (1996) 5061, with matrices that no angle enters). About
/// 2 p^3 + 18 p^2 multiply-adds a density.
class Translations {
public:
  /// Multipoles to locals of each order up to this one; the other two of this order.
  explicit Translations(int order);

  int order() const { return order_; }

  /// Memory of add(), one for each thread.
  class Room {
  public:
    explicit Room(int order);
    static std::size_t bytes(int order);
    double* data() { return lines_.front().values; }

  private:
    struct alignas(64) Line {
      double values[8];
    };
    std::vector<Line> lines_;
  };

  /// Adds from each pair's expansion, of which the degrees up to `order` count, to the other, the same degrees. A multipole's
  /// sum converges where the shift is longer than the radii of both sides together. The bits do not depend on which pairs
  /// come in one call, but on their order where several have one target.
  void add(Translation kind, int order, std::span<const TranslationPair> pairs, Room& room) const;

  /// out[rows[r]] = sum over c of matrix[c count + r] in[first + c stride]: up to 6 rows of a constant matrix.
  struct Block {
    static constexpr int most_rows = 6;
    std::uint32_t matrix;
    std::uint16_t count, columns, first, stride;
    std::array<std::uint16_t, most_rows> rows;
  };
  /// Blocks of the exchange of degree l, whose results lie as harmonics of this degree do (`flat`) or order by order (`upright`).
  struct Exchange {
    std::vector<Block> flat, upright;
  };
  struct Shift {
    std::vector<Block> blocks; ///< from order by order to harmonics
    std::vector<double> matrix;
  };
  std::span<const Exchange> exchanges() const { return exchanges_; }
  const double* exchange_matrix() const { return exchange_matrix_.data(); }
  const Shift& shift(Translation kind, int order) const {
    return kind == Translation::multipole_to_local       ? to_locals_[std::size_t(order)]
           : kind == Translation::multipole_to_multipole ? between_multipoles_
                                                         : between_locals_;
  }

  /// Of one pair's multipole to local of this order, for all densities.
  double multiply_adds(int order) const;

private:
  void add_exchange(int l);
  Shift make_shift(Translation kind, int order) const;

  int order_;
  std::vector<Exchange> exchanges_;
  std::vector<double> exchange_matrix_;
  std::vector<Shift> to_locals_;
  Shift between_multipoles_, between_locals_;
};

} // namespace cowgpu::plan

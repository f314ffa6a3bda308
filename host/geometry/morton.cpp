#include "host/geometry/morton.hpp"

#include "host/parallel.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace cowgpu {
namespace {

constexpr int key_bits = 30, digit_bits = 10;
constexpr std::size_t digits = std::size_t(1) << digit_bits;

struct Keyed {
  std::uint32_t key, id;
};

// Two zero bits after every one of ten.
std::uint32_t spread(std::uint32_t v) {
  v = (v | v << 16) & 0x030000ffU;
  v = (v | v << 8) & 0x0300f00fU;
  v = (v | v << 4) & 0x030c30c3U;
  return (v | v << 2) & 0x09249249U;
}

} // namespace

std::vector<std::uint32_t> morton_order(std::span<const Vec3> points, const Vec3& low, const Vec3& high,
                                        unsigned threads) {
  const std::size_t n = points.size();
  // One cell size for all axes.
  const double side = (high - low).maxCoeff(), scale = side > 0 ? 1024 / side : 0;
  std::vector<Keyed> from(n), to(n);
  const std::size_t parts = std::clamp<std::size_t>(n / 16384, 1, std::max(1U, threads ? threads : all_threads()));
  const auto part_begin = [&](std::size_t part) { return n * part / parts; };
  parallel_for(threads, parts, [&](std::size_t part, unsigned) {
    for (std::size_t i = part_begin(part); i < part_begin(part + 1); ++i) {
      std::uint32_t cell[3];
      for (int c = 0; c < 3; ++c) cell[c] = std::uint32_t(std::clamp((points[i][c] - low[c]) * scale, 0.0, 1023.0));
      from[i] = {spread(cell[0]) << 2 | spread(cell[1]) << 1 | spread(cell[2]), std::uint32_t(i)};
    }
  });
  // By the lowest digit first; every pass keeps the order of equal digits.
  std::vector<std::array<std::size_t, digits>> next(parts);
  for (int shift = 0; shift < key_bits; shift += digit_bits) {
    const auto digit = [shift](const Keyed& k) { return k.key >> shift & (digits - 1); };
    parallel_for(threads, parts, [&](std::size_t part, unsigned) {
      next[part].fill(0);
      for (std::size_t i = part_begin(part); i < part_begin(part + 1); ++i) ++next[part][digit(from[i])];
    });
    std::size_t sum = 0;
    for (std::size_t d = 0; d < digits; ++d)
      for (auto& counts : next) sum += std::exchange(counts[d], sum);
    parallel_for(threads, parts, [&](std::size_t part, unsigned) {
      for (std::size_t i = part_begin(part); i < part_begin(part + 1); ++i) to[next[part][digit(from[i])]++] = from[i];
    });
    from.swap(to);
  }
  std::vector<std::uint32_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = from[i].id;
  return order;
}

} // namespace cowgpu

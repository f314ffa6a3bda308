#include "host/mesh/marching_tetrahedra.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace cowgpu {
namespace {

// From corner 0 to corner 7 of a cube along the axes in each order; bits of a corner are x, y, z. Odd orders turn the other way.
struct Path {
  std::array<int, 4> corners;
  bool odd;
};
constexpr std::array<Path, 6> paths = {Path{{0, 1, 3, 7}, false}, Path{{0, 2, 6, 7}, false}, Path{{0, 4, 5, 7}, false},
                                       Path{{0, 1, 5, 7}, true},  Path{{0, 2, 3, 7}, true},  Path{{0, 4, 6, 7}, true}};

struct EdgeHash {
  std::size_t operator()(const std::array<std::uint64_t, 2>& edge) const {
    return std::size_t(edge[0] * 0x9e3779b97f4a7c15ULL ^ (edge[1] + 0x7f4a7c15ULL) * 0xbf58476d1ce4e5b9ULL);
  }
};

class Marching {
public:
  Marching(std::span<const double> values, double level) : values_(values), level_(level) {}

  void tetrahedron(std::array<std::uint64_t, 4> corners, bool odd) {
    // Those with less first; an odd number of swaps turns it over.
    std::size_t less = 0;
    for (std::size_t i = 0; i < 4; ++i)
      if (values_[corners[i]] < level_) {
        if (i != less) std::swap(corners[i], corners[less]), odd = !odd;
        ++less;
      }
    const auto on = [&](std::size_t i, std::size_t j) { return vertex(corners[i], corners[j]); };
    const auto put = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      if (odd)
        surface.faces.push_back({a, b, c});
      else
        surface.faces.push_back({a, c, b});
    };
    if (less == 1)
      put(on(0, 1), on(0, 2), on(0, 3));
    else if (less == 3)
      put(on(0, 3), on(1, 3), on(2, 3));
    else if (less == 2) {
      const std::uint32_t a = on(0, 2), b = on(0, 3), c = on(1, 3), d = on(1, 2);
      put(a, b, c);
      put(a, c, d);
    }
  }

  LatticeSurface surface;

private:
  std::uint32_t vertex(std::uint64_t below, std::uint64_t above) {
    const auto [found, is_new] = known_.try_emplace({below, above}, std::uint32_t(surface.edges.size()));
    if (is_new) surface.edges.push_back({below, above});
    return found->second;
  }

  std::span<const double> values_;
  double level_;
  std::unordered_map<std::array<std::uint64_t, 2>, std::uint32_t, EdgeHash> known_;
};

} // namespace

LatticeSurface march_tetrahedra(std::span<const double> values, const std::array<int, 3>& points, double level) {
  std::uint64_t count = 1;
  for (const int n : points) count *= std::uint64_t(std::max(n, 0));
  if (*std::min_element(points.begin(), points.end()) < 2 || count != values.size())
    throw Error(Fault::bad_argument,
                fmt::format("a lattice of {} x {} x {} points, with {} values: it takes two points "
                            "along each side, and a value each",
                            points[0], points[1], points[2], values.size()));
  const auto nx = std::uint64_t(points[0]), ny = std::uint64_t(points[1]);
  Marching marching(values, level);
  for (std::uint64_t z = 0; z + 1 < std::uint64_t(points[2]); ++z)
    for (std::uint64_t y = 0; y + 1 < ny; ++y)
      for (std::uint64_t x = 0; x + 1 < nx; ++x) {
        std::array<std::uint64_t, 8> corner{};
        int less = 0;
        for (std::uint64_t k = 0; k < 8; ++k) {
          corner[k] = ((z + (k >> 2)) * ny + y + (k >> 1 & 1)) * nx + x + (k & 1);
          less += values[corner[k]] < level;
        }
        if (less == 0 || less == 8) continue;
        for (const Path& path : paths) {
          std::array<std::uint64_t, 4> four{};
          for (std::size_t i = 0; i < 4; ++i) four[i] = corner[std::size_t(path.corners[i])];
          marching.tetrahedron(four, path.odd);
        }
        if (marching.surface.edges.size() > 0x7fffffffULL)
          throw Error(Fault::too_large, "a level set has more than 2^31 vertices: take a coarser lattice");
      }
  return std::move(marching.surface);
}

} // namespace cowgpu

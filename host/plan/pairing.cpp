#include "host/plan/pairing.hpp"

#include <algorithm>
#include <array>

namespace cowgpu::plan {
namespace {

using Neighbours = std::array<std::uint32_t, 3>;

// For each face the faces across its edges. Edges are bucketed by their lower vertex; where more than two faces share an
// edge they are joined two by two.
std::vector<Neighbours> neighbours(std::span<const Face> faces, std::size_t vertices) {
  struct Side {
    std::uint32_t upper, face;
  };
  std::vector<std::uint32_t> first(vertices + 1, 0);
  const auto each_side = [&](auto&& visit) {
    for (std::uint32_t f = 0; f < faces.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t a = faces[f][k], b = faces[f][(k + 1) % 3];
        if (a != b) visit(std::min(a, b), std::max(a, b), f);
      }
  };
  each_side([&](std::uint32_t lower, std::uint32_t, std::uint32_t) { ++first[lower + 1]; });
  for (std::size_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
  std::vector<Side> sides(first[vertices]);
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  each_side([&](std::uint32_t lower, std::uint32_t upper, std::uint32_t f) { sides[next[lower]++] = {upper, f}; });

  std::vector<Neighbours> result(faces.size(), {unpaired, unpaired, unpaired});
  const auto join = [&](std::uint32_t f, std::uint32_t g) {
    *std::find(result[f].begin(), result[f].end(), unpaired) = g;
  };
  for (std::size_t v = 0; v < vertices; ++v) {
    const auto begin = sides.begin() + first[v], end = sides.begin() + first[v + 1];
    std::stable_sort(begin, end, [](const Side& x, const Side& y) { return x.upper < y.upper; });
    for (auto s = begin; end - s >= 2;) {
      if (s[0].upper == s[1].upper && s[0].face != s[1].face) {
        join(s[0].face, s[1].face);
        join(s[1].face, s[0].face);
        s += 2;
      } else {
        ++s;
      }
    }
  }
  return result;
}

// Two faces over the same three vertices share all corners, so there is no outer one.
bool same_vertices(const Face& f, const Face& g) {
  return std::is_permutation(f.begin(), f.end(), g.begin());
}

bool degenerate(const Face& f) {
  return f[0] == f[1] || f[1] == f[2] || f[2] == f[0];
}

} // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> pair_faces(std::span<const Face> faces, std::size_t vertices) {
  const auto across = neighbours(faces, vertices);
  std::vector<char> used(faces.size(), 0);
  const auto usable = [&](std::uint32_t f) { return f != unpaired && !used[f] && !degenerate(faces[f]); };
  const auto free_neighbours = [&](std::uint32_t f) {
    return std::count_if(across[f].begin(), across[f].end(), usable);
  };

  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  pairs.reserve(faces.size() / 2 + 1);
  // waiting[n]: faces that had n free neighbours when they were put there; stale entries are skipped.
  std::array<std::vector<std::uint32_t>, 4> waiting;
  for (std::uint32_t f = 0; f < faces.size(); ++f) waiting[3].push_back(std::uint32_t(faces.size()) - 1 - f);
  const auto take = [&]() {
    for (auto& stack : waiting)
      while (!stack.empty()) {
        const std::uint32_t f = stack.back();
        stack.pop_back();
        if (!used[f]) return f;
      }
    return unpaired;
  };
  for (std::uint32_t f = take(); f != unpaired; f = take()) {
    std::uint32_t partner = unpaired;
    std::ptrdiff_t fewest = 4;
    if (!degenerate(faces[f]))
      for (const std::uint32_t g : across[f])
        if (usable(g) && !same_vertices(faces[f], faces[g]) && free_neighbours(g) < fewest) {
          fewest = free_neighbours(g);
          partner = g;
        }
    pairs.emplace_back(f, partner);
    used[f] = 1;
    if (partner != unpaired) used[partner] = 1;
    for (const std::uint32_t g : {f, partner})
      if (g != unpaired)
        for (const std::uint32_t h : across[g])
          if (usable(h)) waiting[free_neighbours(h)].push_back(h);
  }
  return pairs;
}

} // namespace cowgpu::plan

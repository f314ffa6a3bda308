#include "host/plan/polyhedron_tree.hpp"

#include "host/parallel.hpp"
#include "host/plan/translations.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace cowgpu::plan {
namespace {

struct Place {
  Vec3 x;
  double key;
  std::uint32_t index;
};

// How many of a cell's places its first child has.
template <class Integer>
Integer middle(Integer count) {
  return (count / 2 + tree_group - 1) / tree_group * tree_group;
}

// The cells with what depends on the number of places alone.
void add_cells(std::vector<TreeCell>& cells, std::uint32_t begin, std::uint32_t end, std::uint32_t depth,
               std::uint32_t largest_leaf) {
  const auto id = std::uint32_t(cells.size());
  cells.push_back({});
  if (end - begin > largest_leaf) {
    const std::uint32_t cut = begin + middle(end - begin);
    add_cells(cells, begin, cut, depth + 1, largest_leaf);
    cells[id].right = std::uint32_t(cells.size());
    add_cells(cells, cut, end, depth + 1, largest_leaf);
  }
  cells[id].begin = begin;
  cells[id].end = end;
  cells[id].depth = depth;
  cells[id].last = std::uint32_t(cells.size());
}

// Centre and radius of a cell; its places are then cut in two at the median.
void place_cell(TreeCell& cell, const TreeCell* parent, std::span<Place> places) {
  Vec3 low = places.front().x, high = low;
  for (const Place& place : places) {
    low = low.cwiseMin(place.x);
    high = high.cwiseMax(place.x);
  }
  cell.centre = low + (high - low) / 2;
  if (parent && (cell.centre - parent->centre).cwiseAbs().maxCoeff() <= least_shift) cell.centre = parent->centre;
  double radius2 = 0;
  for (const Place& place : places) radius2 = std::max(radius2, (place.x - cell.centre).squaredNorm());
  cell.radius = std::sqrt(radius2) * (1 + 1e-14);
  if (cell.leaf()) return;
  int axis = 0;
  (high - low).maxCoeff(&axis);
  for (Place& place : places) place.key = place.x[axis];
  std::nth_element(places.begin(), places.begin() + middle(cell.count()), places.end(),
                   [](const Place& a, const Place& b) { return a.key < b.key; });
}

} // namespace

PlaceTree::PlaceTree(std::size_t count, const std::function<Vec3(std::size_t)>& place, std::uint32_t largest_leaf,
                     unsigned threads) {
  cells.reserve(cell_count(count, largest_leaf));
  add_cells(cells, 0, std::uint32_t(count), 0, largest_leaf);
  std::vector<Place> places(count);
  constexpr std::size_t block = 16384;
  parallel_for(threads, (count + block - 1) / block, [&](std::size_t task, unsigned) {
    for (std::size_t i = task * block; i < std::min(count, (task + 1) * block); ++i)
      places[i] = {place(i), 0, std::uint32_t(i)};
  });

  // Level by level, since a cell's places are known once its parent is cut; below `tops` subtrees go by themselves.
  struct Step {
    std::uint32_t cell, parent;
  };
  const auto place_one = [&](const Step& step) {
    TreeCell& cell = cells[step.cell];
    place_cell(cell, step.cell == step.parent ? nullptr : &cells[step.parent],
               std::span(places).subspan(cell.begin, cell.count()));
  };
  constexpr std::size_t tops = 64;
  std::vector<Step> level = {{0, 0}};
  while (!level.empty() && level.size() < tops) {
    parallel_for(threads, level.size(), [&](std::size_t i, unsigned) { place_one(level[i]); });
    std::vector<Step> next;
    for (const Step& step : level) {
      depth_ = std::max(depth_, cells[step.cell].depth);
      if (cells[step.cell].leaf()) continue;
      next.push_back({step.cell + 1, step.cell});
      next.push_back({cells[step.cell].right, step.cell});
    }
    level = std::move(next);
  }
  parallel_for(threads, level.size(), [&](std::size_t i, unsigned) {
    std::vector<Step> waiting = {level[i]};
    while (!waiting.empty()) {
      const Step step = waiting.back();
      waiting.pop_back();
      place_one(step);
      if (cells[step.cell].leaf()) continue;
      waiting.push_back({cells[step.cell].right, step.cell});
      waiting.push_back({step.cell + 1, step.cell});
    }
  });
  for (const TreeCell& cell : cells) depth_ = std::max(depth_, cell.depth);
  order.resize(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = places[i].index;
}

std::uint64_t PlaceTree::cell_count(std::uint64_t count, std::uint32_t largest_leaf) {
  // At one depth there are two sizes, that of the last cell aside.
  std::map<std::uint64_t, std::uint64_t> sizes = {{count, 1}};
  std::uint64_t cells = 0;
  while (!sizes.empty()) {
    std::map<std::uint64_t, std::uint64_t> halves;
    for (const auto& [size, times] : sizes) {
      cells += times;
      if (size <= largest_leaf) continue;
      const std::uint64_t first = middle(size);
      halves[first] += times;
      halves[size - first] += times;
    }
    sizes = std::move(halves);
  }
  return cells;
}

std::uint64_t PlaceTree::bytes_while_made(std::uint64_t count) {
  return count * sizeof(Place) + (1 << 16);
}

std::uint64_t PlaceTree::bytes(std::uint64_t count, std::uint32_t largest_leaf) {
  return count * sizeof(std::uint32_t) + cell_count(count, largest_leaf) * sizeof(TreeCell);
}

} // namespace cowgpu::plan

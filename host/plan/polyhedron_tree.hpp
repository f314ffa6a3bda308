// Binary trees over places: the centroids of a surface's faces, and the points its field is asked for at.
#pragma once

#include "host/types.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// Halves are cut at multiples of this, the group that the near field takes at once; only the last cell's end may not be one.
inline constexpr std::uint32_t tree_group = 8;

struct TreeCell {
  Vec3 centre = Vec3::Zero();
  double radius = 0;                ///< of the ball about the centre that holds the places
  std::uint32_t begin = 0, end = 0; ///< in PlaceTree::order
  std::uint32_t right = 0;          ///< the second child; the first one is the next cell. 0: a leaf
  std::uint32_t last = 0;           ///< behind the last cell of its subtree
  std::uint32_t depth = 0;
  bool leaf() const { return right == 0; }
  std::uint32_t count() const { return end - begin; }
};

/// Each cell is cut at the median along the longest side of its box. How many cells there are and which places each one holds
/// depends on the number of places alone, so that no input makes a tree deep: places that coincide as well are halved.
/// A child's centre is its parent's where they differ by least_shift (host/plan/translations.hpp) or less.
struct PlaceTree {
  std::vector<TreeCell> cells; ///< parents before children, each subtree in one piece
  std::vector<std::uint32_t> order;

  /// Place i is place(i), finite. No leaf holds more than `largest_leaf` (at least 16), nor fewer than about half of that.
  /// At least one place. The same tree with any number of threads.
  PlaceTree(std::size_t count, const std::function<Vec3(std::size_t)>& place, std::uint32_t largest_leaf,
            unsigned threads);

  std::uint32_t depth() const { return depth_; }

  static std::uint64_t cell_count(std::uint64_t count, std::uint32_t largest_leaf);
  /// Upper bound of what is allocated, of which the first part is given back after construction.
  static std::uint64_t bytes_while_made(std::uint64_t count);
  static std::uint64_t bytes(std::uint64_t count, std::uint32_t largest_leaf);

private:
  std::uint32_t depth_ = 0;
};

} // namespace cowgpu::plan

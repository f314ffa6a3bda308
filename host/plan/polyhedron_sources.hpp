// Multipoles of a surface's faces, in a tree: the far field's first half.
//
// With unit density and G, r = y - x, outward normals n: the field of a body is that of single layers on its surface,
//   A(x) = integral of n/|r| dS,  psi(x) = integral of (n.y)/|r| dS,  grad V = -A,  V = (psi - x.A)/2,
// whose four parts are harmonic off the surface, for any set of its faces; -dd V is the derivative of A, and 4 pi times the
// winding number its divergence. y and x are seen from the body's origin here, and moments are exact.
#pragma once

#include "host/monitor.hpp"
#include "host/plan/polyhedron_tree.hpp"
#include "host/plan/translations.hpp"
#include "host/types.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// A surface's faces as a tree, in units (host/plan/polyhedron.hpp).
class PolyhedronSources {
public:
  /// `translations` of the order that multipoles are to have.
  PolyhedronSources(std::span<const Vec3> vertices, std::span<const Face> faces, double unit,
                    std::uint32_t largest_leaf, const Translations& translations, unsigned threads, Monitor& monitor);

  int order() const { return order_; }
  const PlaceTree& tree() const { return tree_; } ///< of the faces' centroids; radii are those of their corners
  std::span<const TreeCell> cells() const { return tree_.cells; }
  const Vec3& origin() const { return tree_.cells[0].centre; }
  double volume() const { return volume_; } ///< in units

  /// [harmonic][n_x, n_y, n_z, n.y] about a cell's centre.
  const double* multipoles(std::uint32_t cell) const { return &multipoles_[cell * densities * harmonics(order_)]; }
  /// Of degree l = 0 ... order: the root of the sum of squares of the first three densities' multipoles, so that no component
  /// of A of this degree is longer than norm(l)/|x|^(l+1).
  const double* norms(std::uint32_t cell) const { return &norms_[cell * std::size_t(order_ + 1)]; }
  /// Integral of the (order + 1)th power of the largest distance of a face's corners, or more.
  double reach(std::uint32_t cell) const { return reach_[cell]; }
  /// The leaf's number, in the order of the leaves.
  std::uint32_t leaf_number(std::uint32_t cell) const { return leaf_[cell]; }
  /// [leaf number]: its cell.
  std::span<const std::uint32_t> leaves() const { return leaves_; }

  /// Upper bound of the bytes held, and of those while it is made.
  static std::uint64_t bytes(std::uint64_t faces, std::uint32_t largest_leaf, int order);
  static std::uint64_t bytes_while_made(std::uint64_t faces, int order, unsigned threads);

private:
  struct Surface;
  struct Reaches;
  void add_subtree(const Surface& surface, std::uint32_t top, const Translations& translations, Reaches& reaches);
  void gather_up(std::span<const std::uint32_t> parents, const Translations& translations, Translations::Room& room);
  void find_norms(std::uint32_t cell);

  PlaceTree tree_;
  int order_;
  double volume_ = 0;
  std::vector<double> multipoles_, norms_, reach_;
  std::vector<std::uint32_t> leaf_, leaves_;
};

} // namespace cowgpu::plan

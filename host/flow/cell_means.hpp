// The fields of a level set's map as means over the cells of a grid where they jump or have a spike.
#pragma once

#include "host/flow/level_set.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu {

/// How far cells were cut.
struct CellMeansOptions {
  /// Parts a side that a cell is cut into: 1 (values of the grid's points as they are) or 4.
  int parts = 4;
  /// Directions that cells cut more than once may take beyond those cut once, as a share of the grid's points; at least 131,072.
  double finer = 0.25;
};

struct CellMeansReport {
  std::uint64_t cells = 0, points = 0; ///< cells that were averaged; points of the grid
  int depth = 0;                       ///< times that the finest parts were cut
  double unsettled_angle = 0;          ///< solid angle of the cells' unsettled directions, as in LevelSetReport
  /// Sums over parts that were not cut further of their solid angle times what a point of the surface that is seen in them
  /// sticks out of the values about it: what spikes that are narrower than a part leave open, of lengths and of angles.
  double missed_length = 0, missed_angle = 0;
};

/// The six fields over the level set's map (host/spectrum/surface_fields.hpp), [field][ring][longitude], without most of the
/// grid's error at jumps and spikes.
///
/// Cells are marked where a field differs from a neighbour's by more than 0.02 diagonals (0.2 mean distances from the origin, where
/// that is less) or 0.05 rad, and where a point of
/// the mesh's edges, which is the foot of a point of the level set that is known beforehand, differs so from the cell's value:
/// a spike between the grid's points is seen by that. The value of a marked cell is the mean over 16 directions of equal solid
/// angle that fill it, each in another of 4 x 4 parts and of 16 strips either way (Hammersley's points). Parts that differ so
/// from a neighbour in their cell, or from an edge's point in them, are cut again, the largest solid angle times difference
/// first, as long as the options' share of directions lasts. A cell has the solid angle weight_i 2 pi / ring_length; its edges
/// in colatitude are where the weights add up to 1 - cos theta. Angles are those of the turned directions.
///
/// `positions` is what level_set_positions() gives on the grid with the same `turn`; `vertices` and `faces` are the surface's.
/// Throws Error(bad_argument) for sizes that do not fit, and what level_set_points() throws.
std::vector<double> cell_mean_fields(const LevelSet& set, std::span<const Vec3> vertices, std::span<const Face> faces,
                                     const SphereGrid& grid, std::span<const double> positions, bool signed_dphi,
                                     const CellMeansOptions& options, Monitor& monitor,
                                     CellMeansReport* report = nullptr,
                                     const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity());

} // namespace cowgpu

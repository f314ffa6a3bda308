// The graph Laplacians of a surface that its maps are made with.
#pragma once

#include "host/mesh/closed_surface.hpp"
#include "host/mesh/half_edges.hpp"

#include <Eigen/SparseCore>

#include <string_view>
#include <vector>

namespace cowgpu {

using SparseMatrix = Eigen::SparseMatrix<double>; ///< columns, 32-bit indices

/// What an edge from vertex i to vertex j weighs.
enum class EdgeWeights {
  cotangent,  ///< (cot a + cot b) / 2, a and b the angles that face the edge; symmetric, negative where a + b > pi.
              ///< U. Pinkall, K. Polthier, Experimental Mathematics 2 (1993) 15
  mean_value, ///< (tan(c / 2) + tan(d / 2)) / |ij|, c and d the angles at i beside the edge; positive, not symmetric.
              ///< M. Floater, Comput. Aided Geom. Design 20 (2003) 19
  tutte,      ///< 1: knows the connections only
};

/// "cotangent", "mean value", "tutte".
std::string_view name(EdgeWeights weights);

/// L_ij = -w_ij for an edge, L_ii = sum_j w_ij; a square matrix with one row a vertex, zero for unused ones. Its rows add
/// up to zero. With cotangent weights x^T L x / 2 is the Dirichlet energy of a function that is linear on the triangles,
/// so L is positive semidefinite although weights may be negative; no unit of length is left in it. Mean-value weights
/// are per length of the surface's longest side.
///
/// Throws Error(map_failed), naming the first face, where weights are not defined: with cotangent weights a triangle
/// whose height is at most degenerate_height of its longest side, with mean-value weights an edge without length, or two
/// edges that go opposite ways from their vertex; likewise if double precision cannot hold a weight.
SparseMatrix laplacian(const ManifoldSurface& surface, const HalfEdges& half_edges, EdgeWeights weights);

/// A flatter triangle has cotangents of rounding errors only.
inline constexpr double degenerate_height = 1e-15;

/// A third of the areas of the faces at each vertex, over the whole area: they add up to 1 (zero for unused vertices).
std::vector<double> vertex_areas(const ManifoldSurface& surface);

} // namespace cowgpu

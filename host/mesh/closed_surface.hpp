// Surfaces whose type says what holds: ClosedSurface is enough for volume integrals, ManifoldSurface for maps.
#pragma once

#include "host/mesh/raw_mesh.hpp"

namespace cowgpu {

/// A closed, consistently oriented surface that encloses a positive volume.
///
/// Guaranteed: at least one face; every index valid; every coordinate finite; every directed edge occurs as often as its
/// reverse (so the sum of signed tetrahedra does not depend on the origin); total signed volume > 0. Several shells,
/// inward-looking inner shells (cavities), any genus, edges with four faces, self-intersections and degenerate faces are
/// allowed: a region's weight in an integral is the surface's winding number about it.
class ClosedSurface {
public:
  /// Checks `mesh` and takes it over. Throws Error with Fault mesh_empty, mesh_index_range, mesh_not_finite, mesh_range,
  /// mesh_open, mesh_unbalanced, mesh_inside_out or mesh_no_volume; the message names the first offending vertices, edges
  /// or faces (with the file's line where known) and says what to do.
  static ClosedSurface from(RawMesh mesh);

  const RawMesh& mesh() const { return mesh_; }
  const std::vector<Vec3>& vertices() const { return mesh_.vertices; }
  const std::vector<Face>& faces() const { return mesh_.faces; }

private:
  explicit ClosedSurface(RawMesh mesh) : mesh_(std::move(mesh)) {}
  RawMesh mesh_;
};

/// A closed surface that is also a 2-manifold: every edge has exactly two faces and the faces round every vertex form one
/// fan.
class ManifoldSurface {
public:
  /// Checks and takes over. Throws Error with Fault mesh_edge_manifold or mesh_vertex_manifold, naming the first
  /// offending edges or vertices.
  static ManifoldSurface from(ClosedSurface surface);

  const ClosedSurface& closed() const { return surface_; }
  const std::vector<Vec3>& vertices() const { return surface_.vertices(); }
  const std::vector<Face>& faces() const { return surface_.faces(); }

private:
  explicit ManifoldSurface(ClosedSurface surface) : surface_(std::move(surface)) {}
  ClosedSurface surface_;
};

} // namespace cowgpu

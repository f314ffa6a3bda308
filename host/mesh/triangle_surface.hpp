// A triangle surface to be shown or written: with normals and numbers at its vertices, closed or not.
#pragma once

#include "host/types.hpp"

#include <span>
#include <string>
#include <vector>

namespace cowgpu {

/// A number at every vertex.
struct VertexScalar {
  std::string name; ///< letters, digits and underscores: "area_distortion"
  std::string unit; ///< in words, "" for a pure number
  std::vector<double> values;
};

/// Vertices are never merged or reordered.
struct TriangleSurface {
  std::string name;
  std::vector<Vec3> vertices; ///< mesh length unit and axes
  std::vector<Face> faces;
  std::vector<Vec3> normals; ///< unit vectors, one per vertex; or empty
  std::vector<VertexScalar> scalars;
};

/// Unit normals at the vertices: the mean of the faces' normals, weighed by their angles at the vertex (Thuermer and
/// Wuethrich, Journal of Graphics Tools 3 (1998) 43), so that they do not depend on how flat parts are cut into triangles.
/// +z at vertices whose faces have no normal or one that cancels, and at vertices of no face. Indices must be valid.
std::vector<Vec3> vertex_normals(std::span<const Vec3> vertices, std::span<const Face> faces);

/// Throws Error(mesh_index_range) for a face with a vertex that does not exist, mesh_not_finite for coordinates, normals
/// or scalars that are not finite, bad_argument for normals or scalars of another number than the vertices, a normal whose
/// length is not 1 to 1e-6, or a scalar's name that is empty, used twice or holds other characters.
void check(const TriangleSurface& surface);

} // namespace cowgpu

// Where quantities on a body's surface are asked for: at its faces, its vertices, or some height above them.
#pragma once

#include "host/mesh/closed_surface.hpp"
#include "host/mesh_values.hpp"
#include "host/types.hpp"

#include <vector>

namespace cowgpu::physics {

/// Places in the order of the mesh's faces or vertices, or any points.
struct SurfacePlaces {
  ValuePlace place = ValuePlace::faces;
  std::vector<Vec3> at;
  std::vector<Vec3>
      normals; ///< outward, of length 1; 0 for a face without area and a vertex of such faces alone; empty at points
  std::vector<double> areas; ///< of faces; of vertices a third of the faces that meet there; empty at points
};

/// From 0 to pi; 0 where one of the vectors is 0.
double angle_between(const Vec3& a, const Vec3& b);

/// Centroids of faces, `height` along the faces' normals.
SurfacePlaces face_places(const ClosedSurface& surface, double height);

/// Vertices, `height` along their normals: the means of those of the faces that meet there, by the faces' angles.
SurfacePlaces vertex_places(const ClosedSurface& surface, double height);

SurfacePlaces point_places(std::vector<Vec3> points);

} // namespace cowgpu::physics

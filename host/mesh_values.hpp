// Quantities at the faces or vertices of a mesh, or at points: what files and pictures of fields on bodies show.
#pragma once

#include "host/types.hpp"

#include <string>
#include <vector>

namespace cowgpu {

/// Where values stand.
enum class ValuePlace { faces, vertices, points };

/// A quantity, one value or one vector a place.
struct ValueColumn {
  std::string name;    ///< a word for columns and arrays: "slope", "g"
  std::string unit;    ///< "m/s^2"; "1" for numbers; empty where no units are stated
  std::string meaning; ///< a sentence, with signs: "angle between -g_effective and the outward normal of the face"
  int components = 1;  ///< 1, or 3: x, y, z of a vector
  std::vector<double> values; ///< components times the places, the components of a place beside each other
};

/// Values at the places of a mesh in their order, or at points, whose faces are empty.
struct MeshValues {
  std::string title; ///< names the body
  ValuePlace place = ValuePlace::faces;
  std::vector<Vec3> vertices; ///< of the mesh; the points themselves for ValuePlace::points
  std::vector<Face> faces;
  std::vector<Vec3>
      places; ///< where the values are: face centroids, vertices or points, some height above them where asked
  std::string length_unit; ///< of vertices and places: "m", or empty where no units are stated
  std::vector<ValueColumn> columns;
  std::vector<std::string> notes; ///< sentences on signs, units and what was asked for
};

} // namespace cowgpu

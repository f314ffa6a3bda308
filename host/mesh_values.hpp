// Quantities at the faces or vertices of a mesh, or at points: what files and pictures of fields on bodies show.
#pragma once

#include "host/types.hpp"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace cowgpu {

/// Where values stand.
enum class ValuePlace { faces, vertices, points };

/// "faces", "vertices", "points"; and of one of them.
std::string name_of(ValuePlace place);
std::string name_of_one(ValuePlace place);

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
  std::vector<std::pair<std::string, std::string>> facts =
      {}; ///< where it comes from: {"mesh_sha256", "9f..."}, {"density", "2670 kg/m^3"}
};

/// Throws Error with
/// - bad_argument: places or values of another number than the faces, vertices or points; a column that is not of one or three
///   components; a name that is no word of at most 40 letters, digits and '_', a letter first, that files use themselves (id, x,
///   y, z, red ...), or that two numbers have (a vector g has g_x, g_y and g_z, so a number g may stand beside it);
/// - mesh_empty: no place at all;
/// - mesh_index_range: a face that names a vertex that does not exist; mesh_not_finite: a vertex or place that is not finite.
/// Values may be NaN: there is none.
void check(const MeshValues& values);

/// Names of the numbers of a column: its own, or NAME_x, NAME_y and NAME_z.
std::vector<std::string> number_names(const ValueColumn& column);

/// The column to show in colours: of that name, a number before a vector; "": "slope" where there is one, else the first
/// number, else the first. Throws Error(bad_argument), with the names there are.
const ValueColumn& shown_column(const MeshValues& values, const std::string& name);

/// One number a place: the values, or the lengths of vectors.
std::vector<double> numbers_of(const ValueColumn& column);

} // namespace cowgpu

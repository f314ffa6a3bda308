// The faces of mesh files as triangles; for every reader of a format that has polygons.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

struct CutPolygon;

/// A note about what bounds no volume and was left out of a mesh: faces of one corner or points, and faces of two corners or
/// lines. Empty if there were none.
std::string left_out_note(std::uint64_t points, std::uint64_t lines);

/// Takes faces corner by corner and makes triangles of them, in the file's order. Polygons are cut at the end, as their
/// vertices may come after them (host/mesh/polygon.hpp): into the fan from their first corner where that is right.
///
/// Memory beside the mesh: a bit per triangle, and what one polygon takes while it is cut.
class MeshFaces {
public:
  /// `first_number`: what the file calls its first vertex.
  explicit MeshFaces(RawMesh& mesh, std::uint32_t first_number = 0) : mesh_(mesh), first_number_(first_number) {}

  /// A face begins, on this line of the file where lines are known.
  void begin(std::optional<std::size_t> line = {});
  void corner(std::uint32_t vertex);
  std::uint64_t corners() const { return corners_; }
  /// The face is complete. One of one or two corners is left out and counted.
  void end();

  /// Room for this many triangles more.
  void reserve(std::size_t triangles);

  /// Cuts the polygons, once every vertex is known, and adds the notes: how many were cut, how many are bent, what was left
  /// out besides these `points` and `lines`. Where a polygon names a vertex twice in a row, once is taken. Throws
  /// Error(file_syntax) for one that has no cut: with its line, its vertices and where it is at fault.
  void finish(std::uint64_t points = 0, std::uint64_t lines = 0);

private:
  void cut_polygons();
  void refuse_repeats(const std::vector<std::uint32_t>& corners, std::uint32_t line) const;
  [[noreturn]] void refuse(const std::vector<std::uint32_t>& corners, const CutPolygon& cut, std::uint32_t line) const;

  RawMesh& mesh_;
  std::uint32_t first_number_;
  std::uint32_t first_ = 0, previous_ = 0, line_ = 0;
  bool has_line_ = false;
  std::uint64_t corners_ = 0, points_ = 0, lines_ = 0, polygons_ = 0;
  std::uint64_t not_fans_ = 0, bent_ = 0, repeats_ = 0;
  double most_bent_ = 0;
  std::vector<bool> goes_on_; ///< by triangle: it belongs to the polygon of the triangle before
};

} // namespace cowgpu

// Polygons of mesh files as triangles.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <optional>

namespace cowgpu {

/// Cuts polygons into fans from their first corner, in the order in which corners come.
class FaceFans {
public:
  explicit FaceFans(RawMesh& mesh) : mesh_(mesh) {}

  /// A polygon begins, on this line of the file where lines are known.
  void begin(std::optional<std::size_t> line = {}) {
    corners_ = 0;
    has_line_ = line.has_value();
    line_ = static_cast<std::uint32_t>(std::min<std::size_t>(line.value_or(0), 0xffffffff));
  }

  void corner(std::uint32_t vertex) {
    if (corners_ >= 2) {
      mesh_.faces.push_back({first_, previous_, vertex});
      if (has_line_) mesh_.face_lines.push_back(line_);
    }
    if (corners_ == 0) first_ = vertex;
    previous_ = vertex;
    polygons_ += ++corners_ == 4;
  }

  std::uint64_t corners() const { return corners_; }

  /// Says how many polygons were cut, if any.
  void note() const {
    if (polygons_ != 0)
      mesh_.notes.push_back(
          fmt::format("{} {} of more than three corners {} cut into triangles, fans from the first corner.", polygons_,
                      polygons_ == 1 ? "polygon" : "polygons", polygons_ == 1 ? "was" : "were"));
  }

private:
  RawMesh& mesh_;
  std::uint32_t first_ = 0, previous_ = 0, line_ = 0;
  bool has_line_ = false;
  std::uint64_t corners_ = 0, polygons_ = 0;
};

} // namespace cowgpu

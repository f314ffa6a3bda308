// CGAL's tree of boxes: closest points and sides, to compare with. CGAL's packages used here are under the GPL; nothing of
// this is linked into the program.
#pragma once

#include "host/types.hpp"

#include <memory>
#include <span>

namespace cowgpu::test {

class CgalTree {
public:
  /// Faces with area only.
  CgalTree(std::span<const Vec3> vertices, std::span<const Face> faces);
  ~CgalTree();
  CgalTree(const CgalTree&) = delete;
  CgalTree& operator=(const CgalTree&) = delete;

  /// In double precision. Safe from several threads.
  Vec3 closest(const Vec3& query) const;
  /// 1 inside, 0 on the surface, -1 outside: by exact crossings of a ray. For surfaces that do not intersect themselves.
  int side(const Vec3& query) const;

private:
  struct Trees;
  std::unique_ptr<Trees> trees_;
};

} // namespace cowgpu::test

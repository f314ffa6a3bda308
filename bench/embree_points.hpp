// Closest points by Embree's point query, in single precision, to compare with.
#pragma once

#include "host/types.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace cowgpu::bench {

class EmbreePoints {
public:
  EmbreePoints(std::span<const Vec3> vertices, std::span<const Face> faces);
  ~EmbreePoints();
  EmbreePoints(const EmbreePoints&) = delete;
  EmbreePoints& operator=(const EmbreePoints&) = delete;

  struct Found {
    Vec3 point = Vec3::Zero();
    std::uint32_t face = 0;
  };
  /// Safe from several threads.
  Found closest(const Vec3& query) const;

private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

} // namespace cowgpu::bench

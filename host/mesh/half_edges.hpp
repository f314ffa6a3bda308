// Who is next to whom on a manifold surface.
#pragma once

#include "host/mesh/closed_surface.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu {

/// Half-edge 3 f + k runs from corner k of face f to corner k + 1 (modulo 3).
class HalfEdges {
public:
  static constexpr std::uint32_t none = 0xffffffffu;

  /// Of a closed, oriented manifold: every half-edge has a twin. `faces` as in ManifoldSurface.
  HalfEdges(std::span<const Face> faces, std::size_t vertex_count);
  explicit HalfEdges(const ManifoldSurface& surface) : HalfEdges(surface.faces(), surface.vertices().size()) {}

  std::uint32_t twin(std::uint32_t half_edge) const { return twin_[half_edge]; }
  /// A half-edge that leaves the vertex; none for a vertex of no face.
  std::uint32_t leaving(std::uint32_t vertex) const { return leaving_[vertex]; }
  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

  /// The vertices round `vertex`, counter-clockwise seen from outside, starting at the smallest index; empty for a vertex
  /// of no face.
  std::vector<std::uint32_t> ring(std::span<const Face> faces, std::uint32_t vertex) const;

private:
  std::vector<std::uint32_t> twin_, leaving_;
};

/// Throws Error(Fault::map_topology) unless the surface is one component of genus 0: the message gives the number of
/// components and the genus, and what to do.
void require_sphere(const ManifoldSurface& surface);

} // namespace cowgpu

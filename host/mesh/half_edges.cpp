#include "host/mesh/half_edges.hpp"

#include "host/error.hpp"
#include "host/mesh/topology.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {

HalfEdges::HalfEdges(std::span<const Face> faces, std::size_t vertex_count)
    : twin_(3 * faces.size(), none), leaving_(vertex_count, none) {
  const auto half_edge_from = [&](std::uint32_t face, std::uint32_t vertex) {
    const Face& f = faces[face];
    return 3 * face + (f[0] == vertex ? 0U : f[1] == vertex ? 1U : 2U);
  };
  for (std::size_t f = faces.size(); f-- > 0;)
    for (std::uint32_t k = 0; k < 3; ++k) leaving_[faces[f][k]] = std::uint32_t(3 * f) + k;
  const auto uses = edge_uses(faces, vertex_count);
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    if (edge.size() != 2) return;
    std::uint32_t h[2];
    for (std::size_t i = 0; i < 2; ++i)
      h[i] = half_edge_from(edge[i].face, edge[i].forward ? edge[i].low : edge[i].high);
    twin_[h[0]] = h[1];
    twin_[h[1]] = h[0];
  });
}

std::vector<std::uint32_t> HalfEdges::ring(std::span<const Face> faces, std::uint32_t vertex) const {
  std::vector<std::uint32_t> around;
  const std::uint32_t first = leaving_[vertex];
  if (first == none) return around;
  std::uint32_t h = first;
  do {
    const std::uint32_t end = next(h);
    around.push_back(faces[end / 3][end % 3]);
    h = twin_[previous(h)];
  } while (h != first && h != none);
  std::rotate(around.begin(), std::min_element(around.begin(), around.end()), around.end());
  return around;
}

void require_sphere(const ManifoldSurface& surface) {
  const auto& faces = surface.faces();
  const std::size_t vertices = surface.vertices().size();
  const auto uses = edge_uses(faces, vertices);
  std::size_t components = 0;
  shells(faces, uses, components);
  const auto used = std::int64_t(vertices - unused_vertices(faces, vertices));
  const std::int64_t euler = used - std::int64_t(uses.size() / 2) + std::int64_t(faces.size());
  if (components != 1)
    throw Error(Fault::map_topology,
                fmt::format("the surface consists of {} separate shells, and a map to the sphere takes one: keep the "
                            "outer shell only",
                            components));
  if (euler != 2)
    throw Error(Fault::map_topology,
                fmt::format("the surface has genus {} ({} {}), and a map to the sphere needs genus 0: fill the holes "
                            "that go through the body",
                            (2 - euler) / 2, (2 - euler) / 2, euler == 0 ? "handle" : "handles"));
}

} // namespace cowgpu

#include "host/physics/feet.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>
#include <set>

namespace cowgpu::physics {
namespace {

constexpr int near_edges = 3;
constexpr double near_distance = 0.1, rise = 0.02;

// The neighbours of every vertex, in one row after the other.
struct Neighbours {
  std::vector<std::size_t> start, list;

  Neighbours(std::size_t count, std::span<const Face> faces) : start(count + 1, 0) {
    for (const Face& face : faces)
      for (const std::uint32_t v : face) ++start[v + 1]; // each directed edge leaves its first vertex
    for (std::size_t i = 0; i < count; ++i) start[i + 1] += start[i];
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    list.resize(start.back());
    for (const Face& face : faces)
      for (std::size_t c = 0; c < 3; ++c) list[next[face[c]]++] = face[(c + 1) % 3];
  }
  std::span<const std::size_t> of(std::size_t vertex) const {
    return {list.data() + start[vertex], start[vertex + 1] - start[vertex]};
  }
};

// The vertices that `steps` edges lead to, over such as `open` lets pass.
template <class Open>
std::set<std::size_t> reached(const Neighbours& neighbours, std::size_t from, int steps, const Open& open) {
  std::set<std::size_t> found = {from};
  std::vector<std::size_t> border = {from};
  for (int step = 0; step < steps && !border.empty(); ++step) {
    std::vector<std::size_t> next;
    for (const std::size_t v : border)
      for (const std::size_t w : neighbours.of(v))
        if (open(w) && found.insert(w).second) next.push_back(w);
    border.swap(next);
  }
  return found;
}

} // namespace

std::vector<Foot> feet(std::span<const Vec3> vertices, std::span<const Face> faces,
                       std::span<const std::size_t> touching, double ground, double size) {
  const Neighbours neighbours(vertices.size(), faces);
  std::vector<std::size_t> group(touching.size()); // the first member of each one's foot
  for (std::size_t i = 0; i < group.size(); ++i) group[i] = i;
  const auto join = [&](std::size_t a, std::size_t b) {
    const std::size_t from = std::max(group[a], group[b]), to = std::min(group[a], group[b]);
    std::replace(group.begin(), group.end(), from, to);
  };
  for (std::size_t i = 0; i < touching.size(); ++i) {
    const auto close = reached(neighbours, touching[i], near_edges, [](std::size_t) { return true; });
    for (std::size_t j = i + 1; j < touching.size(); ++j) {
      if (group[i] == group[j]) continue;
      const double distance = (vertices[touching[i]] - vertices[touching[j]]).norm();
      if (close.count(touching[j])) {
        join(i, j);
      } else if (distance <= near_distance * size) {
        const double top = ground + rise * distance;
        const auto low = reached(neighbours, touching[i], std::numeric_limits<int>::max(),
                                 [&](std::size_t v) { return vertices[v].y() <= top || v == touching[j]; });
        if (low.count(touching[j])) join(i, j);
      }
    }
  }
  std::map<std::size_t, Foot> found;
  for (std::size_t i = 0; i < touching.size(); ++i) {
    const double z = vertices[touching[i]].z();
    Foot& foot = found.try_emplace(group[i], Foot{z, z}).first->second;
    foot.left = std::min(foot.left, z);
    foot.right = std::max(foot.right, z);
  }
  std::vector<Foot> all;
  for (const auto& [first, foot] : found) all.push_back(foot);
  return all;
}

} // namespace cowgpu::physics

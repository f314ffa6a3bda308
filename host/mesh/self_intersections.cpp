#include "host/mesh/self_intersections.hpp"

#include "host/mesh/topology.hpp"
#include "host/parallel.hpp"

#include <algorithm>

namespace cowgpu {
namespace {

struct Bounds {
  Vec3 low, high;
  bool meets(const Vec3& other_low, const Vec3& other_high) const {
    return (low.array() <= other_high.array()).all() && (other_low.array() <= high.array()).all();
  }
};

class Search {
public:
  Search(std::span<const Vec3> vertices, std::span<const Face> faces, const Bvh& tree)
      : vertices_(vertices), faces_(faces), tree_(tree), bounds_(faces.size()), flat_(faces.size()) {
    for (std::size_t i = 0; i < tree.nodes().size(); ++i)
      if (tree.nodes()[i].count) leaves_.push_back(std::uint32_t(i));
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const Vec3 &a = vertices[faces[f][0]], &b = vertices[faces[f][1]], &c = vertices[faces[f][2]];
      flat_[f] = repeats_vertex(faces[f]) || axis_with_area(a, b, c) < 0;
      bounds_[f] = {a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
    }
  }

  std::size_t leaves() const { return leaves_.size(); }

  /// Pairs of the faces of a leaf with each other and with those of later leaves.
  void leaf_pairs(std::size_t leaf, std::vector<FacePair>& found) const {
    const std::span<const Bvh::Node> nodes = tree_.nodes();
    const std::uint32_t own = leaves_[leaf];
    const Bvh::Node& node = nodes[own];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
      for (std::uint32_t j = i + 1; j < node.first + node.count; ++j) add(i, j, found);
    struct Waiting {
      std::uint32_t node, end; // the nodes of the subtree: [node, end)
    };
    Waiting stack[Bvh::deepest + 1] = {{0, std::uint32_t(nodes.size())}};
    int waiting = 1;
    while (waiting) {
      const Waiting at = stack[--waiting];
      const Bvh::Node& other = nodes[at.node];
      if (at.end <= own + 1 || !Bounds{node.low, node.high}.meets(other.low, other.high)) continue;
      if (other.count == 0) {
        stack[waiting++] = {other.first, at.end};
        stack[waiting++] = {at.node + 1, other.first};
      } else if (at.node > own) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
          for (std::uint32_t j = other.first; j < other.first + other.count; ++j) add(i, j, found);
      }
    }
  }

private:
  void add(std::uint32_t i, std::uint32_t j, std::vector<FacePair>& found) const {
    const std::uint32_t f = std::min(tree_.faces()[i], tree_.faces()[j]),
                        g = std::max(tree_.faces()[i], tree_.faces()[j]);
    if (flat_[f] || flat_[g] || !bounds_[f].meets(bounds_[g].low, bounds_[g].high)) return;
    const TrianglePair how = meet(vertices_, faces_[f], faces_[g]);
    if (how.meeting != Meeting::none) found.push_back({f, g, how});
  }

  std::span<const Vec3> vertices_;
  std::span<const Face> faces_;
  const Bvh& tree_;
  std::vector<std::uint32_t> leaves_;
  std::vector<Bounds> bounds_;
  std::vector<std::uint8_t> flat_;
};

} // namespace

SelfIntersections self_intersections(std::span<const Vec3> vertices, std::span<const Face> faces, const Bvh& tree,
                                     Monitor& monitor, unsigned threads) {
  const Search search(vertices, faces, tree);
  constexpr std::size_t leaves_a_task = 512, tasks_a_part = 64;
  const std::size_t tasks = (search.leaves() + leaves_a_task - 1) / leaves_a_task;
  SelfIntersections result;
  // Parts are searched whole or not at all, so that an early end is the same on any number of threads.
  for (std::size_t part = 0; part < tasks && result.complete; part += tasks_a_part) {
    monitor.progress("self-intersections", double(part) / double(tasks));
    std::vector<std::vector<FacePair>> found(std::min(tasks_a_part, tasks - part));
    parallel_for(threads, found.size(), [&](std::size_t task, unsigned) {
      const std::size_t first = (part + task) * leaves_a_task;
      for (std::size_t leaf = first; leaf < std::min(first + leaves_a_task, search.leaves()); ++leaf) {
        check_stop(monitor);
        if (found[task].size() <= most_pairs) search.leaf_pairs(leaf, found[task]);
      }
    });
    for (const std::vector<FacePair>& pairs : found) {
      const std::size_t room = most_pairs - result.pairs.size();
      result.complete &= pairs.size() <= room;
      result.pairs.insert(result.pairs.end(), pairs.begin(),
                          pairs.begin() + std::ptrdiff_t(std::min(room, pairs.size())));
    }
  }
  std::sort(result.pairs.begin(), result.pairs.end(), [](const FacePair& a, const FacePair& b) {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  });
  std::vector<bool> met(faces.size());
  for (const FacePair& pair : result.pairs) {
    result.crossing += pair.how.meeting == Meeting::crossing;
    result.overlapping += pair.how.meeting == Meeting::overlapping;
    result.touching += pair.how.meeting == Meeting::touching;
    if (pair.how.meeting != Meeting::touching) met[pair.first] = met[pair.second] = true;
  }
  result.faces = std::size_t(std::count(met.begin(), met.end(), true));
  return result;
}

} // namespace cowgpu

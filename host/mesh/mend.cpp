#include "host/mesh/mend.hpp"

#include "host/counted.hpp"
#include "host/error.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/self_intersections.hpp"
#include "host/mesh/topology.hpp"
#include "host/mesh/weld.hpp"
#include "host/mesh/winding.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace cowgpu {
namespace {

void require_two_faces_at_most(const RawMesh& mesh, std::span<const EdgeUse> uses) {
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (repeats_vertex(mesh.faces[f]))
      throw Error(
          Fault::mesh_edge_manifold,
          fmt::format("{}: --orient: {} names a vertex twice and has no sides to choose from. Remove such faces.",
                      called(mesh), where(mesh, f)));
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    if (edge.size() > 2)
      throw Error(
          Fault::mesh_edge_manifold,
          fmt::format("{}: --orient: the edge between vertices {} and {} has {} faces, the first is {}; which of "
                      "them belong together cannot be told. Separate the sheets by doubling the edge's vertices.",
                      called(mesh), edge[0].low, edge[0].high, edge.size(), where(mesh, edge[0].face)));
  });
}

/// Whether each face has to be flipped so that neighbours agree with the first face of their shell.
std::vector<bool> consistent_flips(const RawMesh& mesh, std::span<const EdgeUse> uses) {
  struct Neighbour {
    const EdgeUse *own, *other;
  };
  std::vector<std::size_t> start(mesh.faces.size() + 1);
  const auto each_pair = [&](auto&& f) {
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
      if (edge.size() == 2) f(edge[0], edge[1]), f(edge[1], edge[0]);
    });
  };
  each_pair([&](const EdgeUse& own, const EdgeUse&) { ++start[own.face + 1]; });
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) start[f + 1] += start[f];
  std::vector<Neighbour> neighbours(start.back());
  std::vector<std::size_t> at(start.begin(), start.end() - 1);
  each_pair([&](const EdgeUse& own, const EdgeUse& other) { neighbours[at[own.face]++] = {&own, &other}; });

  std::vector<bool> flip(mesh.faces.size()), seen(mesh.faces.size());
  std::vector<std::uint32_t> front;
  for (std::uint32_t first = 0; first < mesh.faces.size(); ++first) {
    if (seen[first]) continue;
    seen[first] = true;
    front.assign(1, first);
    for (std::size_t i = 0; i < front.size(); ++i)
      for (std::size_t n = start[front[i]]; n < start[front[i] + 1]; ++n) {
        const auto& [own, other] = neighbours[n];
        const bool wanted = flip[own->face] != (own->forward == other->forward);
        if (!seen[other->face]) {
          seen[other->face] = true;
          flip[other->face] = wanted;
          front.push_back(other->face);
        } else if (flip[other->face] != wanted) {
          throw Error(
              Fault::mesh_unbalanced,
              fmt::format("{}: --orient: the shell of {} has one side only, as a Moebius strip: walking round it "
                          "comes back reversed at the edge between vertices {} and {} ({}). It bounds no body.",
                          called(mesh), where(mesh, first), own->low, own->high, where(mesh, other->face)));
        }
      }
  }
  return flip;
}

void flip_face(Face& face) {
  std::swap(face[1], face[2]);
}

/// Points of a face that lie on no line through corners of neighbours but by chance.
std::array<Vec3, 4> generic_points(std::span<const Vec3> vertices, const Face& f) {
  constexpr double weights[4][3] = {{0.31, 0.27, 0.42}, {0.8, 0.11, 0.09}, {0.09, 0.8, 0.11}, {0.11, 0.09, 0.8}};
  std::array<Vec3, 4> points;
  for (std::size_t i = 0; i < 4; ++i)
    points[i] = weights[i][0] * vertices[f[0]] + weights[i][1] * vertices[f[1]] + weights[i][2] * vertices[f[2]];
  return points;
}

/// Whether a point of the plane of a face lies in the face, or within rounding of it.
bool lies_in(const Vec3& point, std::span<const Vec3> vertices, const Face& f) {
  const std::array<Vec3, 3> corner = {vertices[f[0]], vertices[f[1]], vertices[f[2]]};
  const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &from = corner[i], &to = corner[(i + 1) % 3];
    if ((to - from).cross(point - from).dot(normal) < -1e-9 * normal.squaredNorm()) return false;
  }
  return true;
}

/// Which shells lie inside which, of those that are closed.
class Nesting {
public:
  Nesting(const RawMesh& mesh, std::span<const std::uint32_t> shell, const std::vector<bool>& closed, Monitor& monitor)
      : mesh_(mesh), shell_(shell), closed_(closed), tree_(mesh.vertices, mesh.faces), meets_(closed.size()),
        start_(closed.size() + 1), faces_(mesh.faces.size()), winding_(closed.size()), tally_(closed.size()) {
    for (const std::uint32_t s : shell) ++start_[s + 1];
    for (std::size_t s = 0; s < closed.size(); ++s) start_[s + 1] += start_[s];
    std::vector<std::size_t> at(start_.begin(), start_.end() - 1);
    for (std::uint32_t f = 0; f < faces_.size(); ++f) faces_[at[shell[f]]++] = f;
    const SelfIntersections found = self_intersections(mesh.vertices, mesh.faces, tree_, monitor);
    complete_ = found.complete;
    for (const FacePair& pair : found.pairs) {
      const std::uint32_t a = shell[pair.first], b = shell[pair.second];
      if (a == b) continue;
      meets_[a] = meets_[b] = true;
      if (pair.how.meeting == Meeting::crossing) through_.emplace_back(std::min(a, b), std::max(a, b));
      if (pair.how.meeting != Meeting::overlapping) continue;
      on_.emplace_back(pair.first, pair.second);
      on_.emplace_back(pair.second, pair.first);
    }
    std::sort(through_.begin(), through_.end());
    std::sort(on_.begin(), on_.end());
  }

  bool complete() const { return complete_; }

  /// Calls inside(o, coincides) for each shell that holds shell `s`, or lies where it does.
  template <class Inside>
  void each_around(std::uint32_t s, Inside&& inside) {
    std::size_t asked = 0;
    const auto ask = [&](std::uint32_t f, const Vec3& point) {
      ++asked;
      on_now_.clear();
      for (auto at = std::lower_bound(on_.begin(), on_.end(), std::pair(f, 0U)); at != on_.end() && at->first == f;
           ++at)
        if (lies_in(point, mesh_.vertices, mesh_.faces[at->second])) on_now_.push_back(shell_[at->second]);
      std::sort(on_now_.begin(), on_now_.end());
      on_now_.erase(std::unique(on_now_.begin(), on_now_.end()), on_now_.end());
      for (const std::uint32_t o : on_now_) seen(o).on += 1;
      crossings(tree_, mesh_.vertices, mesh_.faces, point, crossed_);
      for (const Crossing& c : crossed_) winding_[shell_[c.face]] += c.sign;
      for (const Crossing& c : crossed_) {
        const std::uint32_t o = shell_[c.face];
        if (winding_[o] != 0 && !std::binary_search(on_now_.begin(), on_now_.end(), o)) seen(o).in += 1;
        winding_[o] = 0; // counted
      }
    };
    for (std::size_t i = start_[s]; i < start_[s + 1]; ++i) {
      const std::uint32_t f = faces_[i];
      const Face& face = mesh_.faces[f];
      if (axis_with_area(mesh_.vertices[face[0]], mesh_.vertices[face[1]], mesh_.vertices[face[2]]) < 0) continue;
      const auto points = generic_points(mesh_.vertices, face);
      const auto lies = std::lower_bound(on_.begin(), on_.end(), std::pair(f, 0U));
      const bool lies_on_others = lies != on_.end() && lies->first == f;
      for (std::size_t p = 0; p < (lies_on_others ? points.size() : 1); ++p) ask(f, points[p]);
      if (!meets_[s]) break; // one place says it for the whole shell
    }
    for (const std::uint32_t o : seen_) {
      const Tally tally = std::exchange(tally_[o], {});
      if (o == s || !closed_[o] ||
          std::binary_search(through_.begin(), through_.end(), std::pair(std::min(s, o), std::max(s, o))))
        continue;
      if (tally.in + tally.on == asked) inside(o, tally.in == 0);
    }
    seen_.clear();
  }

private:
  struct Tally {
    std::size_t in = 0, on = 0; ///< places inside another shell, and on it
  };

  Tally& seen(std::uint32_t o) {
    Tally& tally = tally_[o];
    if (tally.in + tally.on == 0) seen_.push_back(o);
    return tally;
  }

  const RawMesh& mesh_;
  std::span<const std::uint32_t> shell_;
  const std::vector<bool>& closed_;
  Bvh tree_;
  std::vector<bool> meets_;
  std::vector<std::size_t> start_;   // of each shell in faces_
  std::vector<std::uint32_t> faces_; // by shell
  std::vector<int> winding_;
  std::vector<Tally> tally_;
  std::vector<std::uint32_t> seen_, on_now_;
  std::vector<Crossing> crossed_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> through_; // shells that pass through each other
  std::vector<std::pair<std::uint32_t, std::uint32_t>> on_;      // faces that lie on each other, of two shells
  bool complete_ = true;
};

/// For each shell whether it lies inside an odd number of others. `closed` says which shells count.
std::vector<bool> cavities(const RawMesh& mesh, std::span<const std::uint32_t> shell, const std::vector<bool>& closed,
                           Monitor& monitor, Orienting& result) {
  std::vector<bool> inside(closed.size());
  if (closed.size() < 2) return inside;
  Nesting nesting(mesh, shell, closed, monitor);
  result.complete = nesting.complete();
  for (std::uint32_t s = 0; s < closed.size(); ++s) {
    if (!closed[s]) continue;
    check_stop(monitor);
    bool again = false;
    nesting.each_around(s, [&](std::uint32_t other, bool coincides) {
      if (coincides && other > s) return; // of two at one place the later one counts as inside
      inside[s] = !inside[s];
      again = again || coincides;
    });
    result.coinciding += again;
  }
  return inside;
}

} // namespace

Orienting orient(RawMesh& mesh, Monitor& monitor) {
  const std::vector<EdgeUse> uses = edge_uses(mesh.faces, mesh.vertices.size());
  require_two_faces_at_most(mesh, uses);
  std::vector<bool> flip = consistent_flips(mesh, uses);
  Orienting result;
  const std::vector<std::uint32_t> shell = shells(mesh.faces, uses, result.shells);
  std::vector<bool> closed(result.shells, true);
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    if (edge.size() != 2) closed[shell[edge[0].face]] = false;
  });

  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (flip[f]) flip_face(mesh.faces[f]);
  const std::vector<ShellSize> sizes = shell_sizes(mesh.vertices, mesh.faces, shell, result.shells);
  const double noise = volume_noise(mesh.vertices, mesh.faces), all = area(mesh.vertices, mesh.faces);
  std::vector<std::size_t> faces(result.shells), turned(result.shells);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) ++faces[shell[f]], turned[shell[f]] += flip[f];
  const std::vector<bool> inside = cavities(mesh, shell, closed, monitor, result);
  std::vector<bool> again(result.shells);
  for (std::size_t s = 0; s < result.shells; ++s) {
    if (!closed[s] || std::abs(sizes[s].volume) <= noise * (sizes[s].area / all)) {
      ++result.undecided;
      again[s] = 2 * turned[s] > faces[s];
      continue;
    }
    again[s] = (sizes[s].volume < 0) != inside[s];
    result.cavities += inside[s];
  }
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (again[shell[f]]) flip_face(mesh.faces[f]);
    result.flipped += flip[f] != again[shell[f]];
  }
  return result;
}

ShellChoice keep_largest_shell(RawMesh& mesh) {
  ShellChoice choice;
  const std::vector<std::uint32_t> shell =
      shells(mesh.faces, edge_uses(mesh.faces, mesh.vertices.size()), choice.shells);
  if (choice.shells < 2) return choice;
  const std::vector<ShellSize> sizes = shell_sizes(mesh.vertices, mesh.faces, shell, choice.shells);
  const auto largest = std::max_element(sizes.begin(), sizes.end(), [](const ShellSize& a, const ShellSize& b) {
    return std::abs(a.volume) < std::abs(b.volume);
  });
  choice.kept = largest->volume;
  for (const ShellSize& size : sizes)
    if (&size != &*largest) choice.dropped += std::abs(size.volume);

  const auto keep = static_cast<std::uint32_t>(largest - sizes.begin());
  std::vector<std::uint32_t> to(mesh.vertices.size(), 0);
  std::size_t kept = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (shell[f] != keep) continue;
    for (const std::uint32_t v : mesh.faces[f]) to[v] = 1;
    mesh.faces[kept] = mesh.faces[f];
    if (!mesh.face_lines.empty()) mesh.face_lines[kept] = mesh.face_lines[f];
    ++kept;
  }
  choice.faces = mesh.faces.size() - kept;
  mesh.faces.resize(kept);
  if (!mesh.face_lines.empty()) mesh.face_lines.resize(kept);
  std::uint32_t vertices = 0;
  for (std::size_t v = 0; v < to.size(); ++v) {
    if (to[v] == 0) continue;
    mesh.vertices[vertices] = mesh.vertices[v];
    to[v] = vertices++;
  }
  mesh.vertices.resize(vertices);
  for (Face& face : mesh.faces)
    for (std::uint32_t& v : face) v = to[v];
  return choice;
}

namespace {

void mend_weld(RawMesh& mesh, double distance) {
  const Box box = bounding_box(mesh.vertices, mesh.faces);
  if (!(distance >= 0 && distance <= box.longest_side() / 10))
    throw Error(
        Fault::bad_argument,
        fmt::format("--weld {}: it is a length in the mesh's unit, from 0 (vertices at one point exactly) to a tenth "
                    "of the longest side of the mesh's box, {:.6g}",
                    distance, box.longest_side() / 10));
  double largest = 0;
  for (const Vec3& p : mesh.vertices) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  const Weld weld = distance <= 0x1p-60 * largest ? weld_equal_points(mesh) : weld_near_points(mesh, distance);
  mesh.notes.push_back(fmt::format("--weld {}: {} into another, up to {:.3g} away; {} collapsed and left out.",
                                   distance, counted(weld.merged, "vertex was merged", "vertices were merged"),
                                   weld.farthest, counted(weld.collapsed, "face", "faces")));
}

void mend_orientation(RawMesh& mesh, Monitor& monitor) {
  const Orienting done = orient(mesh, monitor);
  std::string note = fmt::format("--orient: {} of {} flipped; {}", counted(done.flipped, "face", "faces"),
                                 mesh.faces.size(), counted(done.shells, "shell", "shells"));
  if (done.cavities)
    note += fmt::format(", {} inside an odd number of others and looking inwards as {}", done.cavities,
                        done.cavities == 1 ? "a cavity" : "cavities");
  if (done.coinciding) note += fmt::format(", {} where an earlier one lies and taken as inside that", done.coinciding);
  if (!done.complete) note += ", which meet in too many places to be sure of what lies inside what";
  if (done.undecided)
    note += fmt::format(", {} open or without volume and left as most of the faces looked", done.undecided);
  mesh.notes.push_back(note + ".");
}

void mend_shells(RawMesh& mesh) {
  const ShellChoice choice = keep_largest_shell(mesh);
  mesh.notes.push_back(
      choice.shells < 2
          ? "--largest-shell: there is one shell; nothing was left out."
          : fmt::format("--largest-shell: {} of {} shells left out, {} of |volume| {:.6g} in all; the one "
                        "kept has the volume {:.6g}.",
                        choice.shells - 1, choice.shells, counted(choice.faces, "face", "faces"), choice.dropped,
                        choice.kept));
}

} // namespace

bool was_oriented(const RawMesh& mesh) {
  return std::any_of(mesh.notes.begin(), mesh.notes.end(),
                     [](const std::string& note) { return note.starts_with("--orient: "); });
}

void mend(RawMesh& mesh, const Mending& mending, Monitor& monitor) {
  if (!mending.any()) return;
  require_valid_indices(mesh);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!mesh.vertices[v].allFinite())
      throw Error(
          Fault::mesh_not_finite,
          fmt::format("{}: vertex {} has no finite coordinates; a mesh is mended only where all have. Repair or "
                      "export it again.",
                      called(mesh), v));
  if (mending.weld) mend_weld(mesh, *mending.weld);
  if (mending.orient) mend_orientation(mesh, monitor);
  if (mending.largest_shell) mend_shells(mesh);
}

} // namespace cowgpu

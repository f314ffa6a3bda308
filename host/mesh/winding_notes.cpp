#include "host/mesh/winding_notes.hpp"

#include "host/counted.hpp"
#include "host/geometry/orientation.hpp"
#include "host/mesh/cures.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/overlap.hpp"
#include "host/mesh/topology.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

namespace cowgpu {
namespace {

constexpr double least_part = 1e-6;    // of the volume
constexpr std::size_t most_tests = 64; // of a point against all faces

struct Shell {
  std::uint32_t first_face = 0;
  double volume = 0, area = 0;
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;

  bool within(const Shell& other) const {
    return (low.array() >= other.low.array()).all() && (high.array() <= other.high.array()).all();
  }
  bool same(const Shell& other) const {
    return low == other.low && high == other.high && std::abs(volume) == std::abs(other.volume);
  }
};

class Shells {
public:
  explicit Shells(const ClosedSurface& surface) : vertices_(surface.vertices()), faces_(surface.faces()) {
    std::size_t count = 0;
    of_face_ = shells(faces_, edge_uses(faces_, vertices_.size()), count);
    all_.resize(count);
    if (count < 2) return;
    const std::vector<ShellSize> sizes = shell_sizes(vertices_, faces_, of_face_, count);
    for (std::size_t s = 0; s < count; ++s) all_[s].volume = sizes[s].volume, all_[s].area = sizes[s].area;
    for (std::size_t f = faces_.size(); f-- > 0;) {
      Shell& shell = all_[of_face_[f]];
      shell.first_face = std::uint32_t(f);
      for (const std::uint32_t v : faces_[f])
        shell.low = shell.low.cwiseMin(vertices_[v]), shell.high = shell.high.cwiseMax(vertices_[v]);
    }
  }

  std::size_t count() const { return all_.size(); }
  const Shell& operator[](std::size_t s) const { return all_[s]; }

  struct Others {
    int winding = 0;    ///< how often the others wind about a shell
    bool holds = false; ///< whether any of them does by itself
  };

  /// Nothing where there were too many such questions.
  std::optional<Others> others_about(std::size_t s) {
    bool held = false;
    for (std::size_t o = 0; o < all_.size() && !held; ++o) held = o != s && all_[s].within(all_[o]);
    if (!held) return Others{};
    if (tests_ == most_tests) return {};
    ++tests_;
    const Face& f = faces_[all_[s].first_face];
    const Vec3 point = (vertices_[f[0]] + vertices_[f[1]] + vertices_[f[2]]) / 3;
    std::vector<int> winding(all_.size());
    for (std::size_t g = 0; g < faces_.size(); ++g)
      if (const std::uint32_t o = of_face_[g]; o != s && !all_[s].same(all_[o]) && all_[s].within(all_[o]))
        winding[o] +=
            vertical_crossing(vertices_[faces_[g][0]], vertices_[faces_[g][1]], vertices_[faces_[g][2]], point, true);
    Others others;
    for (const int one : winding) others.winding += one, others.holds = others.holds || one != 0;
    return others;
  }

  /// Whether an earlier shell is the same and looks the same way.
  bool repeats_earlier(std::size_t s) const {
    for (std::size_t o = 0; o < s; ++o)
      if (all_[s].same(all_[o]) && all_[s].volume == all_[o].volume) return true;
    return false;
  }

private:
  const std::vector<Vec3>& vertices_;
  const std::vector<Face>& faces_;
  std::vector<std::uint32_t> of_face_;
  std::vector<Shell> all_;
  std::size_t tests_ = 0;
};

/// Shells of one kind, and their volume together.
struct InwardCount {
  std::size_t count = 0;
  double volume = 0;
  void add(double v) { ++count, volume += v; }
  const char* pick(const char* one, const char* many) const { return count == 1 ? one : many; }
};

std::string part_of(double volume, double whole) {
  return fmt::format("{:.6g} ({:.3g} %)", volume, 100 * volume / whole);
}

/// Whether it is known to be there, and changes a sixth digit.
bool counts(const RegionVolume& region, double whole) {
  return region.volume > region.uncertainty && region.volume > least_part * whole;
}

} // namespace

std::vector<std::string> body_notes(const ClosedSurface& surface, Monitor& monitor, unsigned threads) {
  std::vector<std::string> notes = surface.mesh().notes;
  const std::vector<std::string> winding = winding_notes(surface, monitor, threads);
  notes.insert(notes.end(), winding.begin(), winding.end());
  return notes;
}

std::vector<std::string> winding_notes(const ClosedSurface& surface, Monitor& monitor, unsigned threads) {
  std::vector<std::string> notes;
  if (surface.mesh().name.starts_with("builtin:")) return notes;
  const std::vector<Vec3>& vertices = surface.vertices();
  const std::vector<Face>& faces = surface.faces();
  const bool measured = faces.size() <= most_measured_faces;
  const double whole = volume(surface);
  Shells all(surface);
  InwardCount outside, in_cavities, twice; // the first two look inwards
  std::size_t left_out = 0;
  if (all.count() > 1) {
    const double noise = volume_noise(vertices, faces), whole_area = area(surface);
    for (std::size_t s = 0; s < all.count(); ++s) {
      check_stop(monitor);
      const Shell& shell = all[s];
      if (std::abs(shell.volume) <= noise * (shell.area / whole_area)) continue;
      if (shell.volume > 0 && measured) continue;
      if (shell.volume > 0 && left_out == 0 && all.repeats_earlier(s)) {
        twice.add(shell.volume);
        continue;
      }
      const auto others = all.others_about(s);
      if (!others)
        ++left_out;
      else if (shell.volume < 0 && others->winding <= 0)
        (others->holds ? in_cavities : outside).add(-shell.volume);
      else if (shell.volume > 0 && others->winding > 0)
        twice.add(shell.volume);
    }
  }
  std::optional<std::string> found_cure;
  const auto cure = [&] { // once, as it is tried on the whole mesh
    if (!found_cure) found_cure = all.count() > 1 ? cure_of_shells(surface.mesh(), monitor) : "";
    return *found_cure;
  };
  for (const auto& [inwards, where] : {std::pair(outside, "outside of all others"), {in_cavities, "in cavities"}})
    if (inwards.count != 0)
      notes.push_back(fmt::format(
          "{} {} and {} inwards: {} volume of {} is subtracted{}.", counted(inwards.count, "shell lies", "shells lie"),
          inwards.count == 1 && where[0] == 'i' ? "in a cavity" : where, inwards.pick("looks", "look"),
          inwards.pick("its", "their"), part_of(inwards.volume, whole), cure().empty() ? "" : "; " + cure()));
  if (!measured) {
    if (twice.count != 0)
      notes.push_back(fmt::format("{} is counted twice or more often: {} inside others, or {} the same as one of them, "
                                  "and {} outwards like it.",
                                  part_of(twice.volume, whole),
                                  twice.count == 1 ? "1 shell lies" : fmt::format("{} shells lie", twice.count),
                                  twice.pick("is", "are"), twice.pick("looks", "look")));
    notes.push_back(fmt::format(
        "The mesh has more than {} faces: whether they pass through each other, so that volume is "
        "counted twice or inside out, was not looked at{}; `cowgpu inspect` looks.",
        most_measured_faces, left_out == 0 ? std::string() : fmt::format(", nor how {} shells lie", left_out)));
    return notes;
  }
  const Bvh tree(vertices, faces);
  const SelfIntersections pairs = self_intersections(vertices, faces, tree, monitor, threads);
  if (!pairs.complete) {
    notes.push_back("Too many faces pass through each other for the volume that is counted twice to be measured.");
    return notes;
  }
  if (pairs.pairs.empty() && all.count() == 1) return notes;
  const Overlap found = overlap(vertices, faces, tree, pairs, monitor, threads);
  if (counts(found.overlapped, whole))
    notes.push_back(
        fmt::format("{} is counted twice or more often, as the surface winds round it; `cowgpu inspect` shows "
                    "where faces meet.",
                    part_of(found.overlapped.volume, whole)));
  const double inwards = outside.volume + in_cavities.volume;
  if (counts(found.inverted, whole) &&
      std::abs(found.inverted.volume - inwards) > 1e-6 * inwards + found.inverted.uncertainty)
    notes.push_back(fmt::format("{} is inside out, and subtracted; {}`cowgpu inspect` shows where faces meet.",
                                part_of(found.inverted.volume, whole), cure().empty() ? "" : cure() + ", "));
  return notes;
}

} // namespace cowgpu

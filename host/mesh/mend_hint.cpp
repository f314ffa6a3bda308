#include "host/mesh/mend_hint.hpp"

#include "host/counted.hpp"
#include "host/error.hpp"
#include "host/mesh/cures.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/mend.hpp"
#include "host/mesh/topology.hpp"
#include "host/mesh/weld.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

namespace cowgpu {
namespace {

constexpr std::size_t most_faces = std::size_t{1} << 20, most_faces_of_shells = std::size_t{1} << 16;

bool holds_volume(const RawMesh& mesh) {
  return !mesh.faces.empty() && seems_balanced(mesh.faces) &&
         volume(mesh.vertices, mesh.faces) > volume_noise(mesh.vertices, mesh.faces);
}

/// How many faces were turned; nothing where they cannot be.
std::optional<std::size_t> turned(RawMesh& mesh) {
  if (mesh.faces.size() > most_faces_of_shells) {
    std::size_t count = 0;
    shells(mesh.faces, edge_uses(mesh.faces, mesh.vertices.size()), count);
    if (count > 1) return {};
  }
  try {
    return orient(mesh, silent_monitor()).flipped;
  } catch (const Error&) {
    return {};
  }
}

/// What an option does, and the volume of the result that is counted twice or subtracted, where it is known.
struct Cure {
  std::string sentence;
  double amiss = 0;
};

Cure cure(const std::string& options, const RawMesh& mended, const std::string& done) {
  const double amiss = volume_amiss(mended, silent_monitor()).value_or(0);
  return {
      fmt::format(" With {0} it is closed and oriented and has the volume {1:.6g}{3} ({2}); `cowgpu inspect MESH {0} "
                  "-o FILE.ply` writes that.",
                  options, volume(mended.vertices, mended.faces), done,
                  amiss > 0 ? fmt::format(", {:.6g} of it counted twice or subtracted", amiss) : ""),
      amiss};
}

/// The mesh as it is, or welded.
std::optional<Cure> cure_by_turning(RawMesh mesh, const std::string& options, const std::string& done) {
  if (!options.empty() && holds_volume(mesh)) return cure(options, mesh, done);
  // Only where no edge has one face or more than two.
  const std::optional<std::size_t> flipped = turned(mesh);
  if (!flipped || !holds_volume(mesh)) return {};
  return cure(options + (options.empty() ? "" : " ") + "--orient", mesh,
              done + (done.empty() ? "" : ", ") + counted(*flipped, "face turned", "faces turned"));
}

std::optional<Cure> cure_by_largest_shell(const RawMesh& mesh) {
  RawMesh largest;
  largest.vertices = mesh.vertices;
  largest.faces = mesh.faces;
  const ShellChoice choice = keep_largest_shell(largest);
  if (choice.shells < 2 || !holds_volume(largest)) return {};
  return cure(
      "--largest-shell", largest,
      fmt::format("{} of {} shells left out, of |volume| {:.6g}", choice.shells - 1, choice.shells, choice.dropped));
}

} // namespace

std::string mend_hint(const RawMesh& mesh) {
  if (mesh.faces.size() > most_faces ||
      !std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& v) { return v.allFinite(); }))
    return {};
  std::string second_best;
  const auto best = [&](const std::optional<Cure>& found) {
    if (found && second_best.empty()) second_best = found->sentence;
    return found && found->amiss == 0;
  };
  if (const auto found = cure_by_turning(mesh, "", ""); best(found)) return found->sentence;
  const double side = bounding_box(mesh.vertices, mesh.faces).longest_side();
  if (!(side > 0 && std::isfinite(side))) return second_best;
  const int power = static_cast<int>(std::floor(std::log10(side)));
  std::size_t merged_before = 0;
  for (const int digits : {0, 6, 5, 4}) {
    const bool exactly = digits == 0;
    RawMesh welded;
    welded.vertices = mesh.vertices;
    welded.faces = mesh.faces;
    const std::string distance = exactly ? "0" : fmt::format("1e{}", power - digits);
    const Weld weld = exactly ? weld_equal_points(welded) : weld_near_points(welded, std::pow(10.0, power - digits));
    if (weld.merged <= merged_before) continue;
    merged_before = weld.merged;
    const std::string done =
        counted(weld.merged, "vertex merged", "vertices merged") +
        (weld.collapsed == 0 ? "" : ", " + counted(weld.collapsed, "face left out", "faces left out"));
    if (const auto found = cure_by_turning(std::move(welded), "--weld " + distance, done); best(found))
      return found->sentence;
  }
  if (!second_best.empty()) return second_best; // it leaves nothing out
  const auto found = cure_by_largest_shell(mesh);
  return best(found) ? found->sentence : "";
}

std::string repeated_faces(const RawMesh& mesh) {
  constexpr std::size_t named = 5;
  const auto turned_to_least = [&](std::uint32_t f) {
    Face face = mesh.faces[f];
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    return face;
  };
  std::vector<std::uint32_t> order(mesh.faces.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Face fa = turned_to_least(a), fb = turned_to_least(b);
    return fa != fb ? fa < fb : a < b;
  });
  std::vector<std::array<std::uint32_t, 2>> pairs; // repeating, first
  for (std::size_t i = 1, first = 0; i < order.size(); ++i)
    if (turned_to_least(order[i]) == turned_to_least(order[first]))
      pairs.push_back({order[i], order[first]});
    else
      first = i;
  std::sort(pairs.begin(), pairs.end());
  std::string text;
  for (std::size_t i = 0; i < std::min(named, pairs.size()); ++i)
    text += fmt::format("{}{} repeats {}", i == 0 ? "" : "; ", where(mesh, pairs[i][0]), where(mesh, pairs[i][1]));
  if (pairs.size() > named) text += fmt::format("; and {} more", pairs.size() - named);
  return text;
}

} // namespace cowgpu

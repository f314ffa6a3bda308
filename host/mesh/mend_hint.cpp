#include "host/mesh/mend_hint.hpp"

#include "host/error.hpp"
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

std::string sentence(const std::string& options, const RawMesh& mended, const std::string& done) {
  return fmt::format(
      " With {0} it is closed and oriented and has the volume {1:.6g} ({2}); `cowgpu inspect MESH {0} -o "
      "FILE.ply` writes that.",
      options, volume(mended.vertices, mended.faces), done);
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// The mesh as it is, or welded.
std::string hint_by_turning(RawMesh mesh, const std::string& options, const std::string& done) {
  if (!options.empty() && holds_volume(mesh)) return sentence(options, mesh, done);
  // Only where no edge has one face or more than two.
  const std::optional<std::size_t> flipped = turned(mesh);
  if (!flipped || !holds_volume(mesh)) return {};
  return sentence(options + (options.empty() ? "" : " ") + "--orient", mesh,
                  done + (done.empty() ? "" : ", ") + counted(*flipped, "face turned", "faces turned"));
}

} // namespace

std::string mend_hint(const RawMesh& mesh) {
  if (mesh.faces.size() > most_faces ||
      !std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& v) { return v.allFinite(); }))
    return {};
  if (std::string hint = hint_by_turning(mesh, "", ""); !hint.empty()) return hint;
  const double side = bounding_box(mesh.vertices, mesh.faces).longest_side();
  if (!(side > 0 && std::isfinite(side))) return {};
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
    if (std::string hint = hint_by_turning(std::move(welded), "--weld " + distance, done); !hint.empty()) return hint;
  }
  return {};
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

#include "host/io/mesh_faces.hpp"

#include "host/counted.hpp"
#include "host/error.hpp"
#include "host/mesh/polygon.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

const char* were(std::uint64_t count) {
  return count == 1 ? "was" : "were";
}

} // namespace

std::string left_out_note(std::uint64_t points, std::uint64_t lines) {
  if (points + lines == 0) return "";
  std::string what;
  if (lines != 0) what = counted(lines, "line or face of two corners", "lines or faces of two corners");
  if (points != 0)
    what +=
        (what.empty() ? "" : ", ") + counted(points, "point or face of one corner", "points or faces of one corner");
  return fmt::format("Left out, as they bound no volume: {}.", what);
}

void MeshFaces::begin(std::optional<std::size_t> line) {
  corners_ = 0;
  has_line_ = line.has_value();
  line_ = static_cast<std::uint32_t>(std::min<std::size_t>(line.value_or(0), 0xffffffff));
}

void MeshFaces::corner(std::uint32_t vertex) {
  if (corners_ >= 2) {
    mesh_.faces.push_back({first_, previous_, vertex});
    if (has_line_) mesh_.face_lines.push_back(line_);
    goes_on_.push_back(corners_ > 2);
  }
  if (corners_ == 0) first_ = vertex;
  previous_ = vertex;
  polygons_ += ++corners_ == 4;
}

void MeshFaces::end() {
  points_ += corners_ == 1;
  lines_ += corners_ == 2;
}

void MeshFaces::reserve(std::size_t triangles) {
  const auto grow = [&](auto& list) {
    if (const std::size_t room = list.size() + triangles; room > list.capacity())
      list.reserve(std::max(room, list.capacity() + list.capacity() / 2));
  };
  grow(mesh_.faces);
  if (has_line_) grow(mesh_.face_lines);
}

void MeshFaces::finish(std::uint64_t points, std::uint64_t lines) {
  if (polygons_ != 0) {
    cut_polygons();
    const std::string how = not_fans_ == 0 ? "fans from the first corner"
                            : not_fans_ == polygons_
                                ? "not as fans from the first corner, which would overlap or have no area"
                                : fmt::format("fans from the first corner, but for {} whose fan would "
                                              "overlap itself or have parts without area",
                                              not_fans_);
    mesh_.notes.push_back(fmt::format("{} of more than three corners {} cut into triangles, {}.",
                                      counted(polygons_, "polygon", "polygons"), were(polygons_), how));
    if (bent_ != 0)
      mesh_.notes.push_back(
          fmt::format("{} of more than three corners {} not flat (corners up to {:.2g} of the polygon's "
                      "size off its plane): the surface is that of the triangles.",
                      counted(bent_, "polygon", "polygons"), bent_ == 1 ? "is" : "are", most_bent_));
    if (repeats_ != 0)
      mesh_.notes.push_back(fmt::format("{} of polygons named the vertex of the corner before and {} left out.",
                                        counted(repeats_, "corner", "corners"), were(repeats_)));
  }
  if (const std::string note = left_out_note(points + points_, lines + lines_); !note.empty())
    mesh_.notes.push_back(note);
}

void MeshFaces::cut_polygons() {
  std::vector<Face>& faces = mesh_.faces;
  std::vector<std::uint32_t>& of_line = mesh_.face_lines;
  PolygonCutter cutter;
  std::vector<std::uint32_t> corners;
  std::vector<Vec3> places;
  std::size_t kept = 0; // polygons may come out smaller
  const auto keep = [&](const Face& face, std::size_t from) {
    faces[kept] = face;
    if (!of_line.empty()) of_line[kept] = of_line[from];
    ++kept;
  };
  for (std::size_t from = 0, end; from < faces.size(); from = end) {
    for (end = from + 1; end < faces.size() && goes_on_[end];) ++end;
    if (end == from + 1) {
      keep(Face(faces[from]), from);
      continue;
    }
    corners.assign(faces[from].begin(), faces[from].end());
    for (std::size_t f = from + 1; f < end; ++f) corners.push_back(faces[f][2]);
    const auto line = of_line.empty() ? 0 : of_line[from];
    const std::size_t named = corners.size();
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    while (corners.size() > 1 && corners.back() == corners.front()) corners.pop_back();
    repeats_ += named - corners.size();
    if (corners.size() < 3) {
      lines_ += corners.size() == 2, points_ += corners.size() == 1;
      continue;
    }
    refuse_repeats(corners, line);
    places.clear();
    for (const std::uint32_t c : corners) places.push_back(mesh_.vertices[c]);
    const CutPolygon cut = cutter.cut(places);
    if (cut.result != PolygonCut::fan && cut.result != PolygonCut::cut) refuse(corners, cut, line);
    bent_ += cut.bend > 0;
    most_bent_ = std::max(most_bent_, cut.bend);
    if (cut.result == PolygonCut::cut) {
      ++not_fans_;
      for (const Face& f : cutter.triangles()) keep({corners[f[0]], corners[f[1]], corners[f[2]]}, from);
    } else {
      for (std::size_t i = 1; i + 1 < corners.size(); ++i) keep({corners[0], corners[i], corners[i + 1]}, from);
    }
  }
  faces.resize(kept);
  if (!of_line.empty()) of_line.resize(kept);
}

/// Polygons of more corners than there are vertices, which would take more room than the file justifies.
void MeshFaces::refuse_repeats(const std::vector<std::uint32_t>& corners, std::uint32_t line) const {
  if (corners.size() <= mesh_.vertices.size()) return;
  constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> first(mesh_.vertices.size(), none);
  for (std::uint32_t i = 0;; ++i) {
    std::uint32_t& seen = first[corners[i]];
    if (seen != none) refuse(corners, {PolygonCut::touches, {seen, i}}, line);
    seen = i;
  }
}

void MeshFaces::refuse(const std::vector<std::uint32_t>& corners, const CutPolygon& cut, std::uint32_t line) const {
  const auto number = [&](std::size_t corner) { return std::uint64_t(corners[corner]) + first_number_; };
  const auto edge = [&](std::size_t corner) {
    return fmt::format("{}-{}", number(corner), number((corner + 1) % corners.size()));
  };
  std::string text = fmt::format("{}:{} the polygon of {} corners, vertices ", mesh_.name,
                                 line == 0 ? "" : fmt::format("{}:", line), corners.size());
  for (std::size_t i = 0; i < std::min<std::size_t>(corners.size(), 6); ++i)
    text += fmt::format("{}{}", i == 0 ? "" : ", ", number(i));
  text += corners.size() > 6 ? " ..., " : ", ";
  switch (cut.result) {
  case PolygonCut::touches:
    text += number(cut.at[0]) == number(cut.at[1])
                ? fmt::format("names vertex {} twice", number(cut.at[0]))
                : fmt::format("touches itself: its vertices {} and {} lie at one place", number(cut.at[0]),
                              number(cut.at[1]));
    break;
  case PolygonCut::crosses:
    text += fmt::format("crosses itself: its edges {} and {} meet", edge(cut.at[0]), edge(cut.at[1]));
    break;
  default:
    text += cut.bend > 0
                ? fmt::format("has no plane in which it does not cross itself (corners lie {:.2g} of its size off)",
                              cut.bend)
                : "has no plane: its corners lie on a line";
  }
  throw Error(Fault::file_syntax,
              text + ". No triangles follow from it; cut it into triangles in the program that made it, or remove it.");
}

} // namespace cowgpu

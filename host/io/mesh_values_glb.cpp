#include "host/error.hpp"
#include "host/io/glb.hpp"
#include "host/io/mesh_values_formats.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace cowgpu::mesh_values_file {
namespace {

/// A surface whose faces share no vertices, so that each is flat and has one colour.
TriangleSurface apart(const MeshValues& values) {
  TriangleSurface surface;
  surface.vertices.reserve(3 * values.faces.size());
  surface.normals.reserve(3 * values.faces.size());
  surface.faces.reserve(values.faces.size());
  for (const Face& f : values.faces) {
    const std::array<Vec3, 3> p = {values.vertices[f[0]], values.vertices[f[1]], values.vertices[f[2]]};
    const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]).stableNormalized();
    const auto first = std::uint32_t(surface.vertices.size());
    surface.faces.push_back({first, first + 1, first + 2});
    for (const Vec3& corner : p) {
      surface.vertices.push_back(corner);
      surface.normals.push_back(normal.allFinite() && normal.norm() > 0.5 ? normal : Vec3::UnitZ());
    }
  }
  return surface;
}

} // namespace

void write_glb(const Job& job) {
  const MeshValues& values = job.values;
  if (values.faces.empty())
    throw Error(
        Fault::bad_argument,
        fmt::format("{}: GLB files show surfaces, and here are points without faces; write .vtp, .ply, .csv or .nc",
                    values.title));
  const bool of_faces = values.place == ValuePlace::faces;
  const Shown shown(values, job.colour);
  TriangleSurface surface;
  if (of_faces) {
    if (values.faces.size() > 0xffffffff / 3)
      throw Error(Fault::too_large, fmt::format("{}: a GLB file holds {} faces that stand apart; write .vtp or .ply",
                                                values.title, 0xffffffff / 3));
    surface = apart(values);
  } else {
    surface.vertices = values.vertices;
    surface.faces = values.faces;
  }
  surface.name = values.title;
  GlbAbout about;
  if (!values.length_unit.empty()) about.length_unit = values.length_unit;
  const std::vector<std::string> lines = sentences(values);
  for (std::size_t i = 0; i < lines.size(); ++i) about.facts.emplace_back(fmt::format("about_{:02}", i), lines[i]);
  std::vector<Colour> colours;
  if (shown.column) {
    about.facts.emplace_back("colours", shown.sentence());
    const std::size_t repeat = of_faces ? 3 : 1;
    const bool all_finite =
        std::all_of(shown.numbers.begin(), shown.numbers.end(), [](double value) { return std::isfinite(value); });
    VertexScalar scalar{shown.column->name, shown.column->unit == "1" ? "" : shown.column->unit, {}};
    colours.reserve(surface.vertices.size());
    if (all_finite) scalar.values.reserve(surface.vertices.size());
    for (std::size_t i = 0; i < shown.numbers.size(); ++i) {
      const auto srgb = viridis_colour(shown.range.place(shown.numbers[i]));
      const Colour linear = {float(to_linear(srgb[0])), float(to_linear(srgb[1])), float(to_linear(srgb[2]))};
      colours.insert(colours.end(), repeat, linear);
      if (all_finite) scalar.values.insert(scalar.values.end(), repeat, shown.numbers[i]);
    }
    if (all_finite) surface.scalars.push_back(std::move(scalar));
  }
  check_stop(job.monitor);
  const std::array part = {GlbPart{.surface = &surface, .colours = colours}};
  cowgpu::write_glb(part, about, job.file);
}

} // namespace cowgpu::mesh_values_file

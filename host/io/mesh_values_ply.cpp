#include "host/error.hpp"
#include "host/io/mesh_values_formats.hpp"

#include <fmt/format.h>

#include <bit>

namespace cowgpu::mesh_values_file {
namespace {

static_assert(std::endian::native == std::endian::little, "the writer copies memory");

constexpr std::uint64_t most_written = 0x7fffffff; // indices are ints

std::string properties(const MeshValues& values, const Shown& shown) {
  std::string text;
  for (const ValueColumn& column : values.columns)
    for (const std::string& name : number_names(column)) text += fmt::format("property double {}\n", name);
  if (shown.column) text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  return text;
}

std::string header(const MeshValues& values, const Shown& shown) {
  const bool of_faces = values.place == ValuePlace::faces;
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& line : sentences(values)) text += fmt::format("comment {}\n", line);
  if (shown.column) text += fmt::format("comment {}\n", shown.sentence());
  text += fmt::format("element vertex {}\nproperty double x\nproperty double y\nproperty double z\n",
                      values.vertices.size());
  if (!of_faces) text += properties(values, shown);
  text += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", values.faces.size());
  if (of_faces) text += properties(values, shown);
  return text + "end_header\n";
}

void add_values(Pieces& out, const MeshValues& values, const Shown& shown, std::size_t i) {
  for (const ValueColumn& column : values.columns)
    for (std::size_t c = 0, n = std::size_t(column.components); c < n; ++c) out.add(column.values[n * i + c]);
  if (shown.column) out.add(shown.bytes(i));
}

} // namespace

void write_ply(const Job& job) {
  const MeshValues& values = job.values;
  if (values.vertices.size() > most_written || values.faces.size() > most_written)
    throw Error(Fault::too_large,
                fmt::format("{}: PLY files hold up to {} vertices and faces; write .vtp", values.title, most_written));
  const Shown shown(values, job.colour);
  const bool of_faces = values.place == ValuePlace::faces;
  Pieces out(job);
  out.bytes() = header(values, shown);
  // Vertices stay where the mesh has them, also when their values are of places above them.
  for (std::size_t v = 0; v < values.vertices.size(); ++v) {
    out.add(values.vertices[v]);
    if (!of_faces) add_values(out, values, shown, v);
    out.more();
  }
  for (std::size_t f = 0; f < values.faces.size(); ++f) {
    out.add(std::uint8_t(3));
    out.add(values.faces[f]);
    if (of_faces) add_values(out, values, shown, f);
    out.more();
  }
  out.end();
}

} // namespace cowgpu::mesh_values_file

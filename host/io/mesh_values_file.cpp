#include "host/io/mesh_values_file.hpp"

#include "host/error.hpp"
#include "host/io/mesh_values_formats.hpp"
#include "host/io/shown.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

namespace cowgpu {
namespace {

namespace fs = std::filesystem;

fs::path name_beside(const fs::path& path) {
  return path.string() + ".json";
}

} // namespace

namespace mesh_values_file {

Shown::Shown(const MeshValues& values, const std::string& colour) {
  if (values.columns.empty() && colour.empty()) return;
  column = &shown_column(values, colour);
  numbers = numbers_of(*column);
  range = colour_range(numbers);
}

std::array<std::uint8_t, 3> Shown::bytes(std::size_t i) const {
  const auto colour = viridis_colour(range.place(numbers[i]));
  std::array<std::uint8_t, 3> all{};
  for (std::size_t c = 0; c < 3; ++c) all[c] = std::uint8_t(255 * colour[c] + 0.5);
  return all;
}

std::string Shown::sentence() const {
  return fmt::format(
      "colours: {} from {:.6g} to {:.6g}{}, the scale viridis; beyond the ends, where one value in two hundred "
      "may lie, their colours go on",
      column->name, range.low, range.high, column->unit.empty() || column->unit == "1" ? "" : " " + column->unit);
}

std::vector<std::string> sentences(const MeshValues& values) {
  std::vector<std::string> all = {
      fmt::format("cowgpu {}", version), fmt::format("body: {}", values.title),
      fmt::format("length unit: {}", values.length_unit.empty() ? "not stated" : values.length_unit)};
  for (const ValueColumn& column : values.columns)
    all.push_back(fmt::format("{}: {}; {}", column.name,
                              column.unit.empty()  ? "no unit stated"
                              : column.unit == "1" ? "a pure number"
                                                   : column.unit,
                              column.meaning));
  for (const auto& [key, text] : values.facts) all.push_back(fmt::format("{}: {}", key, text));
  for (const std::string& note : values.notes) all.push_back("note: " + note);
  for (std::string& line : all) line = one_line(line);
  return all;
}

} // namespace mesh_values_file

MeshValuesFormat mesh_values_format(const fs::path& path) {
  const fs::path suffix = path.extension();
  if (suffix == ".vtp") return MeshValuesFormat::vtp;
  if (suffix == ".ply") return MeshValuesFormat::ply;
  if (suffix == ".glb") return MeshValuesFormat::glb;
  if (suffix == ".csv") return MeshValuesFormat::csv;
  if (suffix == ".nc") return MeshValuesFormat::netcdf;
  throw Error(
      Fault::bad_argument,
      fmt::format("{}: the name must end in .vtp (VTK), .ply, .glb (glTF), .csv or .nc (netCDF)", path.string()));
}

MeshValuesFile::MeshValuesFile(const fs::path& path) : path_(path), format_(mesh_values_format(path)), file_(path) {
  if (format_ == MeshValuesFormat::csv) beside_.emplace(name_beside(path));
}

void MeshValuesFile::write(const MeshValues& values, const std::string& colour, const Monitor& monitor) {
  check(values);
  const mesh_values_file::Job job = {values, colour, file_, monitor};
  switch (format_) {
  case MeshValuesFormat::vtp: mesh_values_file::write_vtp(job); break;
  case MeshValuesFormat::ply: mesh_values_file::write_ply(job); break;
  case MeshValuesFormat::glb: mesh_values_file::write_glb(job); break;
  case MeshValuesFormat::netcdf: mesh_values_file::write_netcdf(job); break;
  case MeshValuesFormat::csv: mesh_values_file::write_table(job); break;
  }
  if (beside_) mesh_values_file::write_about(values, path_.filename().string(), *beside_);
  file_.commit();
  if (beside_) beside_->commit();
}

void write_mesh_values(const fs::path& path, const MeshValues& values, const std::string& colour,
                       const Monitor& monitor) {
  MeshValuesFile(path).write(values, colour, monitor);
}

std::uint64_t mesh_values_file_memory(MeshValuesFormat format, ValuePlace place, std::uint64_t vertices,
                                      std::uint64_t faces, std::uint64_t numbers) {
  constexpr std::uint64_t fixed = std::uint64_t{4} << 20;
  const std::uint64_t places = place == ValuePlace::faces ? faces : vertices;
  switch (format) {
  case MeshValuesFormat::csv:
  case MeshValuesFormat::vtp: return fixed;
  case MeshValuesFormat::ply: return fixed + 16 * places; // the numbers that are shown, and a copy to sort
  case MeshValuesFormat::
      netcdf: // netCDF keeps an image of the file, which grows by copies, and a variable is gathered first
    return fixed + 3 * 8 * (3 * vertices + 3 * faces + (3 + numbers) * places);
  case MeshValuesFormat::glb: {
    const std::uint64_t shown = place == ValuePlace::faces ? 3 * faces : vertices;
    return fixed + 16 * places + shown * (24 + 24 + 8 + 12) + faces * 12 + 5 * (shown * 36 + faces * 12);
  }
  }
  return fixed;
}

} // namespace cowgpu

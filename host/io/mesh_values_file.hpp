// Quantities on bodies in files, one format a suffix.
//
// .csv: the first line is the names alone: id,x,y,z and those of the columns, a vector g as g_x,g_y,g_z; then a row for each
//   face, vertex or point in the order of the mesh's file, id counted from 0, x,y,z where the value is. Units, meanings, notes
//   and facts stand in FILE.csv.json beside it (data/schemas/cowgpu.values.v1.json).
// .vtp: VTK XML PolyData (VTK file formats, XML, version 1.0) in raw appended blocks with 64-bit headers, as ParaView and PyVista
//   read it: values as cell data of faces or point data, vectors whole; where the values are as `place`; units by VTK's key
//   UNITS_LABEL; title, notes, meanings and facts as text arrays of the field data. A vector whose name a number has too is
//   called NAME_vector.
// .ply: binary little-endian; numbers are double properties of faces or vertices under the names of the CSV, and red, green,
//   blue; units, meanings, notes and facts as comments.
// .glb: glTF 2.0 with the colours at the vertices (COLOR_0) and the coloured quantity as the attribute _NAME; faces stand apart
//   and flat where the values are theirs. It is for viewers: positions and numbers are floats.
// .nc: netCDF-4 of the conventions CF-1.8 and UGRID-1.0: a variable a number, with units and long_name.
//
// Colours are viridis over colour_range() of the column that shown_column() chooses (host/colour_scale.hpp), in files that have
// them, which say so.
#pragma once

#include "host/io/atomic_file.hpp"
#include "host/mesh_values.hpp"
#include "host/monitor.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace cowgpu {

enum class MeshValuesFormat { vtp, ply, glb, csv, netcdf };

/// By the suffix. Throws Error(bad_argument) for another.
MeshValuesFormat mesh_values_format(const std::filesystem::path& path);

/// A file of values, opened before the work whose result it is to hold.
class MeshValuesFile {
public:
  /// Throws Error(bad_argument) for a suffix of no format, cannot_write.
  explicit MeshValuesFile(const std::filesystem::path& path);

  MeshValuesFormat format() const { return format_; }

  /// Writes and commits, once; of two files the table first. `colour`: the column to colour by, for shown_column(). Throws what
  /// check(values) and shown_column() throw, Error(bad_argument) for points without faces as GLB, too_large beyond a format's
  /// indices, mesh_range for what GLB's floats cannot hold, cannot_write, interrupted.
  void write(const MeshValues& values, const std::string& colour = "", const Monitor& monitor = silent_monitor());

private:
  std::filesystem::path path_;
  MeshValuesFormat format_;
  AtomicFile file_;
  std::optional<AtomicFile> beside_;
};

/// The same at once.
void write_mesh_values(const std::filesystem::path& path, const MeshValues& values, const std::string& colour = "",
                       const Monitor& monitor = silent_monitor());

/// Upper bound of the memory that writing takes beside the values; `numbers` a place, as the CSV has columns behind z.
std::uint64_t mesh_values_file_memory(MeshValuesFormat format, ValuePlace place, std::uint64_t vertices,
                                      std::uint64_t faces, std::uint64_t numbers);

} // namespace cowgpu

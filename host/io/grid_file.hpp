// Fields on grids, in files. The layouts below are fixed: later versions may add attributes and keep these.
//
// netCDF (netCDF-4; every netCDF format is read):
//   dimensions  lat, lon
//   double      lat(lat)   degrees_north, from north to south as SphereGrid::latitude_degrees
//   double      lon(lon)   degrees_east, as SphereGrid::longitude_degrees
//   double      value(lat, lon); several fields: value_1, value_2 ..., or the names they were read under,
//               each with the integer attribute field, 1, 2 ...
//   global      grid "gl" | "cc" | "dh" | "dh1" | "f1"; lmax (integer, at most the grid's); normalisation "orthonormal" | "4pi" |
//               "schmidt" | "unnormalised" and phase "cs" | "none" (the convention of the coefficients the field came
//               from; values do not depend on it); title; source (program and version)
// CSV: lines "# grid dh", "# lmax 8", "# normalisation orthonormal", "# phase cs", then the names lat,lon,value (or those of
//   several fields), then ring by ring one row a point.
//
// Also read: grids of pyshtools' SHGrid.to_netcdf (no global `grid`; the variable's says DH or GLQ), with or without its
// extra column at 360 E and row at 90 S, and files of any origin once their grid is named: coordinates lat, latitude or y, and
// lon, longitude or x, in either case, or variables that units or standard_name make such; rings in either order; longitudes that
// begin anywhere (-180, the middle of a cell; the points of a ring have equal distances) and go either way, with a last column
// that repeats the first; values (lat, lon) or (lon, lat), other dimensions of length 1 among them; packed values (scale_factor,
// add_offset). Missing values are refused, and dimensions that are longer. Rings that are the centres of equal cells are an f1
// grid even if the file or --grid says dh, dh1 or cc.
// pyshtools' SHGrid.from_netcdf opens files of one field: dh and dh1 grids as
// 'DH'; of gl grids only those of 2 lmax + 1 points a ring, because it takes 2 lmax + 2 for a column too many.
#pragma once

#include "host/convention.hpp"
#include "host/io/atomic_file.hpp"
#include "host/io/file_format.hpp"
#include "host/sphere_grid.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// What a grid file holds.
struct GridFile {
  SphereGrid grid;
  int lmax = 0; ///< degree the fields are meant for, at most grid.lmax
  Convention convention;
  std::vector<std::string> names; ///< one a field
  std::vector<double> values;     ///< [field][ring][longitude], all finite
  std::vector<std::string> notes; ///< sentences: what was dropped or turned over

  int fields() const { return int(names.size()); }
};

/// "gl", "cc", "dh", "dh1", "f1"; nothing for another word.
std::optional<GridKind> grid_kind_named(std::string_view word);

/// Reads a grid by the name's suffix. `kind` overrides what the file says. Coordinates must lie within 1e-6 degrees of the
/// grid's, floats within 4e-5. Memory: the file and 16 bytes a value. Throws Error(cannot_read, too_large, file_syntax, file_truncated, file_format) with file and line or variable,
/// and bad_argument for a suffix.
GridFile read_grid(const std::filesystem::path& path, std::optional<GridKind> kind = {});

/// Writes a grid; commit() is left to the caller. Throws Error(cannot_write, too_large).
void write_grid(const GridFile& grid, FileFormat format, AtomicFile& file);

} // namespace cowgpu

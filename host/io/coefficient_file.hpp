// Coefficients of fields, in files. The layouts below are fixed: later versions may add attributes and keep these.
//
// netCDF (netCDF-4), as pyshtools' SHCoeffs.to_netcdf writes real coefficients and SHCoeffs.from_netcdf reads them:
//   dimensions  degree, order, both lmax + 1
//   int64       degree(degree), order(order): 0 ... lmax
//   double      coeffs(degree, order): C_lm at [l][m] for m <= l, S_lm at [m - 1][l] for m >= 1; several fields: coeffs_1,
//               coeffs_2 ...; with the attributes title (the field's name, or empty), description (program and version),
//               normalization "ortho" | "4pi" | "schmidt" | "unnorm", csphase (integer): -1 with the Condon-Shortley
//               phase, 1 without; of several fields each has the integer attribute field, 1, 2 ...
// CSV: lines "# lmax 8", "# normalisation orthonormal", "# phase cs", then the names l,m,C,S (several fields:
//   l,m,C_1,S_1,C_2,S_2 ...), then a row for each l and m >= 0, sorted by l, then m.
//
// Also read: what `cowgpu expand` writes. Of the JSON the expansion `mass`, of the CSV (l,m,re,im, or l,m and NAME_re,NAME_im
// of several fields) everything, as fields with these coefficients. A variable `errors` of pyshtools is left out.
#pragma once

#include "host/convention.hpp"
#include "host/io/atomic_file.hpp"
#include "host/io/file_format.hpp"
#include "host/sphere_coefficients.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace cowgpu {

/// What a coefficient file holds.
struct CoefficientFile {
  SphereCoefficients coefficients;
  Convention convention;          ///< of the file; what is held here is complex and orthonormal always
  std::vector<std::string> names; ///< one a field, empty where the file gives none
  std::vector<std::string> notes; ///< sentences: what was left out, what the coefficients are
};

/// Largest degree that is read.
inline constexpr int largest_file_degree = 8192;

/// Reads coefficients by the name's suffix: .nc, .csv or .json. All must be finite. Throws Error(cannot_read, too_large,
/// file_syntax, file_truncated, file_format) with file and line or variable, and bad_argument for another suffix.
CoefficientFile read_coefficients(const std::filesystem::path& path);

/// Writes them in `convention`; commit() is left to the caller. Throws Error(cannot_write, too_large), and bad_argument as
/// to_real() does.
void write_coefficients(const CoefficientFile& coefficients, FileFormat format, AtomicFile& file);

} // namespace cowgpu

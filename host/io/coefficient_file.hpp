// Coefficients in files. The layouts below are fixed: later versions may add attributes and keep these. Beside its numbers
// every file carries the same words and texts (host/io/coefficient_metadata.hpp), and every double reads back as it was.
//
// netCDF (netCDF-4), as pyshtools' SHCoeffs.to_netcdf writes real coefficients and SHCoeffs.from_netcdf reads them:
//   dimensions  degree, order, both lmax + 1
//   int64       degree(degree), order(order): 0 ... lmax
//   double      coeffs(degree, order): C_lm at [l][m] for m <= l, S_lm at [m - 1][l] for m >= 1; several fields: coeffs_1,
//               coeffs_2 ...; with the attributes title (the field's name, or empty), description (program and version),
//               normalization "ortho" | "4pi" | "schmidt" | "unnorm", csphase (integer): -1 with the Condon-Shortley
//               phase, 1 without; of several fields each has the integer attribute field, 1, 2 ...; of potentials GM and
//               r0 (double), which SHGravCoeffs.from_netcdf asks for
//   global attributes: the words and texts
// CSV: lines "# lmax 8", "# normalisation orthonormal", "# phase cs" and more of the kind, then the names l,m,C,S (several
//   fields: l,m,C_1,S_1,C_2,S_2 ...), then a row for each l and m >= 0, sorted by l, then m. Complex coefficients:
//   l,m,re,im, of several fields l,m and NAME_re,NAME_im of each.
// JSON: data/schemas/cowgpu.coefficients.v1.json.
// .gfc: host/io/gfc.hpp. .sh: host/io/shtools_text.hpp. Both real.
//
// A file that is read is judged by what it holds (host/io/coefficient_content.hpp), not by its name.
//
// Also read: what `cowgpu expand` writes as JSON and CSV. A variable `errors` of pyshtools is left out.
#pragma once

#include "host/coefficient_set.hpp"
#include "host/io/atomic_file.hpp"
#include "host/sphere_coefficients.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// Largest degree that is read.
inline constexpr int largest_file_degree = 8192;

enum class CoefficientFormat { json, csv, netcdf, gfc, shtools };

/// Of a file that is written, by the suffix: .json, .csv, .nc, .gfc, .sh. Throws Error(bad_argument) for another.
CoefficientFormat coefficient_format(const std::filesystem::path& path);

/// Reads coefficients of any format, whatever the file's name. All must be finite. `of` names the expansion of a file that
/// `cowgpu expand` wrote; empty: the only one, or all columns of a CSV as fields. `metres` is the length of the file's unit of
/// length where the user states it; it counts where the file does not say its units (CoefficientSet::units_stated), see
/// settle_length_unit(). Throws Error(cannot_read, too_large, file_syntax, file_truncated, file_format) with file and line or
/// variable, and bad_argument where there is no expansion `of`.
CoefficientSet read_coefficient_set(const std::filesystem::path& path, const std::string& of = "",
                                    std::optional<double> metres = {});

/// The same where the user's unit counts in any case: also of a file whose lengths are in the unit of a mesh, by
/// state_length_unit(). Throws also Error(bad_argument) for a file that says its units.
CoefficientSet read_in_unit(const std::filesystem::path& path, const std::string& of, std::optional<double> metres);

/// What `format` cannot hold of a set, as a sentence that says which formats can; empty where it can hold it all.
std::string not_held(const CoefficientSet& set, CoefficientFormat format);

/// Writes the numbers as they are; commit() is left to the caller. Throws Error(cannot_write, too_large), and bad_argument
/// with not_held().
void write_coefficient_set(const CoefficientSet& set, CoefficientFormat format, AtomicFile& file);

/// The same for what takes any coefficients as those of fields (orthonormal()): multipoles without a name are called "mass", and
/// the notes say what the field of multipoles and potentials is.
CoefficientSet read_fields(const std::filesystem::path& path, std::optional<double> metres = {});

/// orthonormal() of a set that was read from the file `name`. Throws Error(file_format) for numbers that fit no double.
SphereCoefficients field_coefficients(const CoefficientSet& set, const std::string& name);

} // namespace cowgpu

// Coefficients in the text format of SHTOOLS, as pyshtools' shio.shread reads and shio.shwrite writes it.
#pragma once

#include "host/coefficient_set.hpp"
#include "host/io/atomic_file.hpp"

#include <filesystem>

namespace cowgpu {

/// Reads rows "l, m, C, S" by l, then m, from any degree on (what is below is 0), between commas or spaces; S may be missing
/// where m = 0, and two errors that follow are left out. Lines that are empty or begin with '#' are passed over. Before the
/// rows there may be the line "r0, gm, omega, lmax" of SHGravCoeffs.to_file: the set is a potential then.
///
/// The format has no place for the convention: lines "# word text" say it, as write_shtools_text() writes them. Without
/// them the convention is taken as pyshtools' default, 4pi without phase, and convention_stated is false; a potential is in
/// metres and kilograms then.
///
/// Throws Error(cannot_read, too_large, file_syntax, file_truncated, file_format) with file and line.
CoefficientSet read_shtools_text(const std::filesystem::path& path);

/// Writes one field: comments, of a potential the line "r0, gm, 0, lmax", rows. SHCoeffs.from_file(FILE, format="shtools",
/// normalization=..., csphase=...) opens fields, SHGravCoeffs.from_file(FILE, format="shtools", ...) potentials. The set
/// must be one that not_held() has no objection to. Throws Error(cannot_write).
void write_shtools_text(const CoefficientSet& set, AtomicFile& file);

} // namespace cowgpu

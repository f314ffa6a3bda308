// Gravity field models in ICGEM's format (Barthelmes and Foerste, The ICGEM-format, 2011).
#pragma once

#include "host/coefficient_set.hpp"
#include "host/io/atomic_file.hpp"

#include <filesystem>

namespace cowgpu {

/// Reads a static model: lines "keyword value" up to end_of_head (what stands before begin_of_head, where there is one, is
/// left to comments), then lines "gfc l m C S" with errors or without, in any order, exponents with E or D. Asked for are
/// earth_gravity_constant (or gravity_constant), radius, max_degree; product_type must be gravity_field, norm
/// fully_normalized (also where it is missing) or unnormalized. Errors and tide_system are left out.
///
/// One field of kind potential, 4pi or unnormalised, without phase. Lines "# word text" before begin_of_head are taken as
/// metadata; a file without `# kind` is in metres and kilograms, as the format has it. Rows of degrees 0 and 1 may be
/// missing, as they are where the origin is the centre of mass: C_00 is 1 then, and the others 0.
///
/// Throws Error(cannot_read, too_large, file_syntax, file_truncated, file_format), with file and line: also for the
/// time-variable terms gfct, trnd, dot, asin and acos, and for rows that are missing or there twice.
CoefficientSet read_gfc(const std::filesystem::path& path);

/// Writes one. In SI units earth_gravity_constant is GM in m^3/s^2, else in the units that the comments state. The set must
/// be one that not_held() has no objection to. Throws Error(cannot_write).
void write_gfc(const CoefficientSet& set, AtomicFile& file);

} // namespace cowgpu

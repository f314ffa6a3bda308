// Gravity field models in ICGEM's format (Barthelmes and Foerste, The ICGEM-format, 2011).
#pragma once

#include "host/coefficient_set.hpp"
#include "host/io/atomic_file.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace cowgpu {

/// Reads a static model: lines "keyword value" up to end_of_head (what stands before begin_of_head, where there is one, is
/// left to comments), then lines "gfc l m C S" with errors or without, in any order, exponents with E or D; empty lines and
/// comments (lines that begin with '#', '!' or '%', or whose first word is "cmmt" or "comment") may stand among them. Asked for
/// are earth_gravity_constant (or gravity_constant), radius, max_degree; product_type must be gravity_field, norm
/// fully_normalized or unnormalized, and where either is missing the first is taken, with a note; without norm
/// normalisation_stated is false. Errors and tide_system are
/// left out. Rows that are left out are told by take_rows(); a file of ours has them all.
///
/// One field of kind potential, 4pi or unnormalised, without phase. Lines "# word text" before begin_of_head are taken as
/// metadata; a file without `# kind` is in metres and kilograms, as the format has it, but settle_length_unit() applies with
/// `metres`: units_stated is false then.
///
/// Throws Error(file_syntax, file_truncated, file_format, too_large) that begins with `name` and line: also for the
/// time-variable terms gfct, trnd, dot, asin and acos. Memory: 40 bytes a row, 1000 keywords, and what take_rows() takes.
CoefficientSet parse_gfc(std::string_view bytes, const std::string& name, std::optional<double> metres = {});

/// Writes one. In SI units earth_gravity_constant is GM in m^3/s^2, else in the units that the comments state. The set must
/// be one that not_held() has no objection to. Throws Error(cannot_write).
void write_gfc(const CoefficientSet& set, AtomicFile& file);

} // namespace cowgpu

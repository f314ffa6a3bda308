// Files of an expansion's result, by their suffix.
#pragma once

#include "host/io/atomic_file.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/monitor.hpp"
#include "host/report/result.hpp"

#include <string>

namespace cowgpu {

/// Throws Error(bad_argument) where a file of this name cannot hold the expansions asked for: .json and .csv hold all,
/// .gfc and .sh the gravity of the mass, .nc that or the fields of one surface.
void check_expansion_file(const std::string& path, bool mass, std::size_t surfaces);

/// Writes them; commit() is left to the caller. .gfc, .sh and .nc hold the potential's coefficients, 4pi without phase, as
/// geodesy has them; .nc of a surface its fields, orthonormal with the phase. Throws Error(cannot_write, bad_argument,
/// interrupted).
void write_expansion(const ExpandResult& result, CoefficientFormat format, AtomicFile& file, const Monitor& monitor);

} // namespace cowgpu

// What `diff` computes: two files of coefficients, degree by degree.
#pragma once

#include "host/report/diff_report.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace cowgpu {

struct DiffRequest {
  std::filesystem::path first, second; ///< coefficients of any format and convention
  std::string of;                  ///< name of the expansion to take from results of `expand`; "": as files are read
  std::string field;               ///< name of the field to take where there are several; "": all
  Convention convention;           ///< convention of the norms
  std::optional<double> tolerance; ///< what the largest difference is held against, to be shown
  std::optional<double> metres;    ///< length of the unit of the one or both files that do not say it
};

/// The caller fills in `command`. Brings the second file's coefficients to kind and reference radius of the first's,
/// and takes them apart. Throws what read_coefficient_set() and difference() throw; Error(bad_argument) for a unit that
/// neither file needs.
DiffResult diff(const DiffRequest& request);

} // namespace cowgpu

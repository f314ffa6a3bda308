// What `spectrum` computes: power per degree of coefficients in a file.
#pragma once

#include "host/report/spectrum_report.hpp"

#include <filesystem>
#include <optional>

namespace cowgpu {

struct SpectrumRequest {
  std::filesystem::path input;  ///< coefficients of any format
  std::optional<double> metres; ///< length of the file's unit where it does not say it
  bool cross = false;           ///< of a file of two fields: their cross spectrum too
};

/// The caller fills in `command`. Throws what read_fields() and field_coefficients() throw; Error(bad_argument) for a cross spectrum of
/// other than two fields, and file_format for squares that overflow doubles.
SpectrumResult spectrum(const SpectrumRequest& request);

} // namespace cowgpu

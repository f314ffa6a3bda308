// Power per degree of the fields in a file, ready to be shown.
#pragma once

#include "host/report/result.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// Power by degree (host/spectrum/power.hpp), in the square of the field's unit.
struct PowerSpectrum {
  std::string name; ///< name of the field; "field", "field_1" ... where the file has none
  std::vector<double> power;
  double total() const; ///< sum over all degrees: the integral of f^2 over the unit sphere
};

/// Result of `spectrum`.
struct SpectrumResult {
  std::vector<std::string> command; ///< as typed
  std::string created;              ///< UTC, ISO 8601
  std::string input;                ///< name of the file
  int lmax = 0;
  std::vector<PowerSpectrum> fields;
  std::optional<PowerSpectrum> cross; ///< its total is the integral of f g
  std::vector<std::string> notes;     ///< sentences of the reader
};

/// For people: a table of each field, with bars on a logarithmic scale.
void write_screen(const SpectrumResult& result, const Sink& sink);

/// After data/schemas/cowgpu.spectrum.v1.json.
Object document(const SpectrumResult& result);

} // namespace cowgpu

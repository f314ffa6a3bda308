// What `spectrum` computes: power per degree of coefficients in a file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

struct SpectrumRequest {
  std::filesystem::path input;  ///< coefficients of any format
  std::optional<double> metres; ///< length of the file's unit where it does not say it
  bool cross = false;           ///< of a file of two fields: their cross spectrum too
};

/// Power by degree (host/spectrum/power.hpp), in the square of the field's unit.
struct PowerSpectrum {
  std::string name; ///< name of the field; "field", "field_1" ... where the file has none
  std::vector<double> power;
  double total() const; ///< sum over all degrees: the integral of f^2 over the unit sphere
};

struct SpectrumResult {
  int lmax = 0;
  std::vector<PowerSpectrum> fields;
  std::optional<PowerSpectrum> cross; ///< its total is the integral of f g
  std::vector<std::string> notes;     ///< sentences of the reader
};

/// Throws what read_coefficients() throws; Error(bad_argument) for a cross spectrum of other than two fields, and file_format
/// for squares that overflow doubles.
SpectrumResult spectrum(const SpectrumRequest& request);

} // namespace cowgpu

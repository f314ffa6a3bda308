// What `convert` computes: coefficients of a file in another convention, kind, radius or frame.
#pragma once

#include "host/io/coefficient_file.hpp"
#include "host/spectrum/convert.hpp"
#include "host/units.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace cowgpu {

struct ConvertRequest {
  std::filesystem::path input; ///< coefficients of any format
  std::string of;              ///< name of the expansion to take from a result of `expand`; "": as files are read
  std::string field;           ///< name of the field to take where there are several; "": all
  /// What the caller knows of a file that does not say it; what a file does say may be repeated only.
  std::optional<Normalisation> input_normalisation = {};
  std::optional<Phase> input_phase = {};
  std::optional<Measure> brillouin_radius = {}; ///< with its unit, or in the file's where `metres` does not state that
  std::optional<double> metres = {};            ///< length of the file's unit
  bool si = false;                              ///< lengths of the file are metres, and its density is in kg/m^3
  /// The body is turned about its origin, or the fields are, after degrees are left out and before the rest.
  std::optional<EulerAngles> rotation = {};
  std::string rotation_text; ///< the angles as a remark in the file names them: "20,30,40 degrees"
  /// What is asked for; where it says nothing, `format` decides what must change. Its reference radius is the next one's.
  ConversionTarget target;
  std::optional<Measure> reference_radius = {};       ///< as brillouin_radius
  CoefficientFormat format = CoefficientFormat::json; ///< format of the file to be written
};

struct ConvertResult {
  CoefficientSet input;  ///< as read, with what was said of its convention
  CoefficientSet output; ///< fit for the format; the caller adds its command to provenance.history
  std::vector<std::string> notes;
};

/// Throws what read_in_unit(), converted() and rotated() throw; Error(bad_argument) for what contradicts the file, and for a
/// radius without a unit beside a length of the file's unit: one would have to guess which of both it is in.
ConvertResult convert(const ConvertRequest& request, Monitor& monitor, unsigned threads = 0);

} // namespace cowgpu

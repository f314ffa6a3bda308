// What a coefficient file says beside its numbers, as words with texts, the same in every format.
#pragma once

#include "host/coefficient_set.hpp"

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cowgpu {

/// A text with the line it came from, 0 where there are no lines.
struct MetadataText {
  std::string text;
  std::size_t line = 0;
};

/// By its word.
using Metadata = std::map<std::string, MetadataText>;

/// The field that multipoles and potentials are coefficients of, in a line: that of CoefficientKind, whatever the convention.
/// Empty for other fields.
std::string coefficients_of(const CoefficientSet& set);

/// Words and one-line texts in the order in which files have them: lmax, normalisation and phase always, then of
///   kind, form, coefficients_of (which is not read), reference_radius, brillouin_radius, origin ("(kind) x y z"), length_unit, mass_unit, density, mass, second_moment,
///   gravitational_constant, gm, fields, units (between commas), program, created, command, mesh, mesh_sha256, history, remark.WORD
/// what there is. Numbers read back as the same doubles.
std::vector<std::pair<std::string, std::string>> metadata_of(const CoefficientSet& set);

/// The same as lines "# word text", without those in `elsewhere`.
std::string comment_lines(const CoefficientSet& set, const std::vector<std::string_view>& elsewhere = {});

/// A line "# word text" into `metadata`; the first of several counts. Other comments are passed over.
void take_comment(std::string_view line, std::size_t number, Metadata& metadata);

/// Puts what is there, texts as one_line() has them, into `set`, whose lmax and fields are set, and normalisation and phase where both are there; false
/// where one is missing. `file` opens messages. Throws Error(file_syntax) for texts that mean nothing, and for a body's
/// coefficients without reference_radius.
bool take_metadata(const Metadata& metadata, const std::string& file, CoefficientSet& set);

/// Whether the words are those that this program writes, though some may have been taken out: `cowgpu`, a `program` of that name,
/// or two or more that hardly another program writes, such as kind, coefficients_of, gravitational_constant, phase.
bool words_of_this_program(const Metadata& metadata);

/// The note on what was assumed of normalisation and phase where the file does not state them; empty where it states both.
std::string assumed_convention(const CoefficientSet& set);

/// "orthonormal, with Condon-Shortley phase".
std::string convention_text(Convention convention);

/// A remark of a file that is a number, or `otherwise` where the file has no such remark. Throws Error(file_syntax) that names
/// file and remark where its text is no finite number (read_number()).
double remark_number(const CoefficientSet& set, const std::string& file, std::string_view word, double otherwise);

/// "FILE:LINE", or "FILE" where there is no line.
std::string place(const std::string& file, std::size_t line);

} // namespace cowgpu

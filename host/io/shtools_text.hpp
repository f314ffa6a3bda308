// Coefficients as text tables: of SHTOOLS (pyshtools' shio.shread and shio.shwrite), and the gravity tables of the Planetary
// Data System (SHADR, SHA), which have the same rows.
#pragma once

#include "host/coefficient_set.hpp"
#include "host/io/atomic_file.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace cowgpu {

/// Reads a table. Numbers stand between blanks, commas or semicolons, exponents with E or D; lines end with LF, CRLF or CR:
///
///   table   = { comment | text } [ header ] { comment | text | row }
///   comment = empty line, or one that begins with '#'
///   header  = R GM W lmax [ mmax [ normalised [ longitude [ latitude ] ] ] ]    above the rows; W: omega or GM's error
///   row     = l m C S [ errors of C and S ]       S may be missing where m = 0
///           | l m value [ error ]                 if any order is negative ("dov"): S_lm in rows of order -m
///   text    = any other line above the rows; among them one whose first word is no number
///
/// Rows stand in any order; what they leave out is told by take_rows(), to which an mmax below lmax goes. With a header the set is
/// a potential. Its `normalised` is 1 (4pi) or 0 (unnormalised). C_00 of a potential is 1 where the file leaves it out or says 0. Errors, W, longitude and
/// latitude and lines of text are left out, with notes.
///
/// The format has no place for the convention: lines "# normalisation WORD" and "# phase WORD" say it, as write_shtools_text()
/// writes them. Where neither they nor the header do, it is taken as pyshtools' default, 4pi without phase, normalisation_stated
/// and phase_stated are false, and a note says so. Of a potential of another program units_stated is false too, and
/// settle_length_unit() applies with `metres`. A file of this program, by its other words (words_of_this_program()), must have both
/// lines.
///
/// Throws Error(file_syntax, file_truncated, file_format, too_large) that begins with `name` and line: a header of another
/// number of values, one that says another normalisation than a comment, more than 6 words in a row, text among the rows of a
/// file of this program, such a file without its convention, and what take_rows() throws. Memory: 48 bytes a row and what take_rows() takes.
CoefficientSet parse_shtools_text(std::string_view bytes, const std::string& name, std::optional<double> metres = {});

/// Whether a text looks like such a table: more than half of its first lines that hold numbers only are rows,
/// and at most one in ten comes again.
bool looks_like_shtools_text(std::string_view bytes);

/// Writes one field: comments, of a potential the line "r0, gm, 0, lmax", rows. SHCoeffs.from_file(FILE, format="shtools",
/// normalization=..., csphase=...) opens fields, SHGravCoeffs.from_file(FILE, format="shtools", ...) potentials. The set
/// must be one that not_held() has no objection to. Throws Error(cannot_write).
void write_shtools_text(const CoefficientSet& set, AtomicFile& file);

} // namespace cowgpu

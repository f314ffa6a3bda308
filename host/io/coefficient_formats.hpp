// The readers and writers behind host/io/coefficient_file.hpp, one pair a format.
#pragma once

#include "host/coefficient_set.hpp"
#include "host/io/atomic_file.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace cowgpu {

/// The readers, of a file's bytes; `name` opens every message.
CoefficientSet parse_csv_coefficients(std::string_view bytes, const std::string& name, const std::string& of);
void write_csv_coefficients(const CoefficientSet& set, AtomicFile& file);

CoefficientSet parse_netcdf_coefficients(std::string bytes, const std::string& name, std::optional<double> metres);
void write_netcdf_coefficients(const CoefficientSet& set, AtomicFile& file);

CoefficientSet parse_json_coefficients(const std::string& bytes, const std::string& name, const std::string& of);
void write_json_coefficients(const CoefficientSet& set, AtomicFile& file);

/// What multipoles are, in a sentence.
std::string expansion_note(std::string_view reference_radius);

/// Appends "first,second" with the separator between them, for the rows of text formats.
void append_pair(std::string& text, double first, double second, std::string_view separator);

/// Calls row(l, m) for every l and m >= 0 by l, then m; what it appends to its text goes to the file now and then.
template <class Row>
void write_rows(int lmax, AtomicFile& file, const Row& row) {
  std::string text;
  for (int l = 0; l <= lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      row(text, l, m);
      if (text.size() > 65536) {
        file.write(text);
        text.clear();
      }
    }
  file.write(text);
}

} // namespace cowgpu

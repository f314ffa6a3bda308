// The header of PLY files (G. Turk, The PLY polygon file format, Stanford 1994), shared by the readers.
#pragma once

#include "host/error.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

enum class PlyEncoding { ascii, little_endian, big_endian };

/// Scalar types: char uchar short ushort int uint float double, or int8 ... float64; int64 and uint64 as meshio writes them.
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };
std::size_t bytes_of(PlyType type);
bool is_real(PlyType type);

struct PlyProperty {
  std::string_view name;
  PlyType type = PlyType::int8;
  bool is_list = false;
  PlyType count_type = PlyType::int8; ///< type of a list's length; never a real number
  std::size_t line = 0;               ///< line of the header, from 1
  bool again = false;                 ///< an earlier property of the element has this name; find() returns that one
};

struct PlyElement {
  std::string_view name;
  std::uint64_t count = 0; ///< at most 2^32 - 1
  std::vector<PlyProperty> properties;
  std::size_t line = 0;

  const PlyProperty* find(std::string_view property) const;
  /// The least that an instance takes in a binary file: lists may be empty.
  std::size_t least_bytes() const;
};

/// Its words are parts of the bytes it was read from.
struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string> comments; ///< blanks between words are single
  std::size_t size = 0;              ///< bytes to the first of the data
  std::size_t lines = 0;
};

/// Whether the bytes open as a PLY file does: the word ply, alone on its line, after a byte order mark if there is one.
bool starts_as_ply(std::string_view bytes);

/// Reads the header. Its lines end with LF, CRLF, LFCR or CR; comments, obj_info and empty lines may stand anywhere after the
/// first one, and a byte order mark before it. A property's name is the rest of its line, blanks within it included. The data
/// begin after end_header and a line end like that of the first line.
///
/// Throws Error("NAME:LINE: ...") with file_format (no PLY, or a version other than 1.0), file_syntax (a header that breaks
/// the grammar, two elements of one name), file_truncated (no end_header).
PlyHeader read_ply_header(std::string_view bytes, const std::string& name);

} // namespace cowgpu

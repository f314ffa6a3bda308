// netCDF files in and out, through netCDF-C.
#pragma once

#include "host/io/atomic_file.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

/// An attribute as found: a text, or the first of its numbers.
struct NetcdfAttribute {
  std::string name;
  bool is_text = false;
  std::string text; ///< without trailing NULs
  double number = 0;
};

struct NetcdfDimension {
  std::string name;
  std::uint64_t length = 0;
};

/// A variable as found. The last dimension varies fastest.
struct NetcdfVariable {
  std::string name;
  std::vector<std::size_t> dimensions; ///< places in NetcdfFile::dimensions
  std::vector<NetcdfAttribute> attributes;
  bool read = false;   ///< a variable of numbers, at most two of its dimensions longer than 1; others have no values
  bool single = false; ///< its numbers are floats
  std::vector<double> values; ///< numbers of any type as double, packing (scale_factor) not undone
};

/// The root group of a file.
struct NetcdfFile {
  std::string name; ///< as the user called it; it opens every message
  std::vector<NetcdfDimension> dimensions;
  std::vector<NetcdfAttribute> attributes; ///< global
  std::vector<NetcdfVariable> variables;

  const NetcdfVariable* variable(std::string_view variable_name) const; ///< null where there is none
};

/// Value `at` of a variable, unpacked (times scale_factor, plus add_offset), NaN where it stands for none: what _FillValue or missing_value says, netCDF's own fill value of
/// floating-point variables without _FillValue, or outside valid_min, valid_max and the lower end of valid_range; these are about the packed number.
double present_value(const NetcdfVariable& variable, std::size_t at);

/// The attribute of that name, or null.
const NetcdfAttribute* attribute(const std::vector<NetcdfAttribute>& list, std::string_view name);

/// Variables in the order of their attribute `field` (1, 2 ...), those without one after them: files built in memory lose the
/// order in which variables were made.
void sort_fields(std::vector<const NetcdfVariable*>& variables);

/// Reads a file of any netCDF format (classic, 64-bit offset and data, netCDF-4). Damaged files make the netCDF and HDF5
/// libraries crash, hang or ask for absurd memory, so they work in a process of their own with limits on time and memory;
/// what comes out is checked before anything is allocated for it. Names of files are never taken for addresses on the net.
///
/// Memory: the file and its values. Throws Error(cannot_read), file_format (no netCDF, damaged beyond use), too_large.
NetcdfFile read_netcdf(const std::filesystem::path& path);

/// The same of a file's bytes; `name` opens every message.
NetcdfFile parse_netcdf(std::string bytes, const std::string& name);

/// Builds a netCDF-4 file in memory. Definitions first, then values, then write_to().
class NetcdfWriter {
public:
  enum class Type { real, integer }; ///< NC_DOUBLE with _FillValue NaN, NC_INT64
  static constexpr int global = -1;

  NetcdfWriter();
  ~NetcdfWriter();
  NetcdfWriter(const NetcdfWriter&) = delete;
  NetcdfWriter& operator=(const NetcdfWriter&) = delete;

  int dimension(const std::string& name, std::size_t length);
  int variable(const std::string& name, Type type, std::span<const int> dimensions);
  void attribute(int variable, const std::string& name, std::string_view text);
  void attribute(int variable, const std::string& name, std::int64_t number);
  void attribute(int variable, const std::string& name, double number);
  /// All values of a variable.
  void values(int variable, std::span<const double> values);
  /// Row i of a variable of two dimensions.
  void row(int variable, std::size_t i, std::span<const double> values);
  /// Appends the file to `file`; nothing more can be added afterwards.
  void write_to(AtomicFile& file);

private:
  int id_ = -1;
};

} // namespace cowgpu

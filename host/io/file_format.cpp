#include "host/io/file_format.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace cowgpu {
namespace {

bool letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_word(const std::string& name) {
  return !name.empty() && name.size() <= 40 && letter(name[0]) && name != "lat" && name != "lon" &&
         std::all_of(name.begin(), name.end(),
                     [](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.'; });
}

} // namespace

FileFormat file_format(const std::filesystem::path& path) {
  if (path.extension() == ".nc") return FileFormat::netcdf;
  if (path.extension() == ".csv") return FileFormat::csv;
  throw Error(Fault::bad_argument, fmt::format("{}: the name must end in .nc (netCDF) or .csv", path.string()));
}

std::vector<std::string> field_names(const std::vector<std::string>& given, int fields, std::string_view word) {
  if (given.size() == std::size_t(fields) && std::all_of(given.begin(), given.end(), is_word) &&
      std::set<std::string>(given.begin(), given.end()).size() == given.size())
    return given;
  std::vector<std::string> names;
  for (int f = 0; f < fields; ++f) names.push_back(fields == 1 ? std::string(word) : fmt::format("{}_{}", word, f + 1));
  return names;
}

} // namespace cowgpu

#include "host/io/coefficient_content.hpp"

#include "host/io/coefficient_lines.hpp"
#include "host/io/mesh_catalogue.hpp"
#include "host/io/mesh_format.hpp"
#include "host/io/shtools_text.hpp"
#include "host/io/words.hpp"

#include <algorithm>
#include <fstream>
#include <system_error>

namespace cowgpu {
namespace {

constexpr std::size_t beginning = std::size_t(1) << 18; // heads of gravity models have some thousand bytes

bool is_netcdf(std::string_view bytes) {
  return bytes.starts_with("\x89HDF\r\n\x1a\n") || bytes.starts_with("CDF\x01") || bytes.starts_with("CDF\x02") ||
         bytes.starts_with("CDF\x05");
}

bool is_json(std::string_view text) {
  return WordScanner(text, '\0').word().starts_with('{');
}

// A line of names under comments of which one is ours; the reader says which names it wants.
bool is_table_of_columns(std::string_view text) {
  WordLines lines("", text);
  bool named = false;
  while (lines.next()) {
    if (lines.words.empty()) continue;
    if (lines.words[0].starts_with('#')) {
      const std::string_view word =
          lines.words[0] == "#" && lines.words.size() > 1 ? lines.words[1] : lines.words[0].substr(1);
      named = named || word == "lmax" || word == "cowgpu" || word == "normalisation" || word == "phase";
      continue;
    }
    return named && lines.words.size() > 2 && !WordLines::number_in(lines.words[0]);
  }
  return false;
}

bool is_gravity_model(std::string_view text) {
  WordLines lines("", text);
  while (lines.next()) {
    if (lines.words.empty()) continue;
    if (lines.words[0] == "end_of_head" || lines.words[0] == "begin_of_head") return true;
    if (lines.words[0] == "gfc" && lines.words.size() > 4 && WordLines::number_in(lines.words[3])) return true;
  }
  return false;
}

// Of a regular file that can be opened, by its beginning.
std::optional<CoefficientFormat> format_of_file(const std::filesystem::path& path) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return {};
  std::string bytes(beginning, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), std::streamsize(bytes.size()));
  bytes.resize(std::size_t(std::max<std::streamsize>(file.gcount(), 0)));
  return coefficient_format_in(bytes);
}

} // namespace

// A line "l m C S" above a table is no OBJ file.
bool holds_mesh(std::string_view bytes) {
  try {
    return mesh_format_of(bytes, "").name != "OBJ";
  } catch (const Error&) {
    return false;
  }
}

std::optional<CoefficientFormat> coefficient_format_in(std::string_view bytes) {
  if (is_netcdf(bytes)) return CoefficientFormat::netcdf;
  const std::string_view text = without_byte_order_mark(bytes.substr(0, beginning));
  if (text.find('\0') != std::string_view::npos) return {};
  if (is_json(text)) {
    if (text.find("\"cowgpu.") == std::string_view::npos) return {};
    return CoefficientFormat::json;
  }
  if (is_table_of_columns(text)) return CoefficientFormat::csv;
  if (is_gravity_model(text)) return CoefficientFormat::gfc;
  if (looks_like_shtools_text(text) && !holds_mesh(bytes)) return CoefficientFormat::shtools;
  return {};
}

std::optional<CoefficientFormat> coefficient_format_named(const std::filesystem::path& path) {
  const std::string suffix = path.extension();
  if (suffix == ".json") return CoefficientFormat::json;
  if (suffix == ".csv") return CoefficientFormat::csv;
  if (suffix == ".nc") return CoefficientFormat::netcdf;
  if (suffix == ".gfc") return CoefficientFormat::gfc;
  if (suffix == ".sh") return CoefficientFormat::shtools;
  return {};
}

bool can_hold_expansions(const std::filesystem::path& path) {
  const auto held = format_of_file(path), format = held ? held : coefficient_format_named(path);
  return format == CoefficientFormat::json || format == CoefficientFormat::csv;
}

bool is_coefficient_file(const std::string& input) {
  if (input.starts_with("builtin:") || catalogue_entry(input)) return false;
  return format_of_file(input).has_value() || coefficient_format_named(input).has_value();
}

} // namespace cowgpu

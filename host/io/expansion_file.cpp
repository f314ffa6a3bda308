#include "host/io/expansion_file.hpp"

#include "host/error.hpp"
#include "host/io/file.hpp"
#include "host/io/number.hpp"
#include "host/io/shown.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace cowgpu {
namespace {

using nlohmann::json;

nlohmann::json parse(const std::string& name, const std::string& bytes) {
  try {
    return json::parse(bytes);
  } catch (const json::parse_error& error) {
    const auto line =
        1 + std::count(bytes.begin(), bytes.begin() + std::ptrdiff_t(std::min(error.byte, bytes.size())), '\n');
    throw Error(Fault::file_syntax,
                fmt::format("{}:{}: this breaks the grammar of JSON (byte {})", name, line, error.byte));
  } catch (const json::exception&) { // a number beyond a double
    throw Error(Fault::file_syntax, fmt::format("{}: this JSON holds a number that fits no double", name));
  }
}

const json& member(const std::string& name, const json& object, const char* key) {
  if (!object.is_object() || !object.contains(key))
    throw Error(Fault::file_format,
                fmt::format("{}: no member '{}' where a result of `cowgpu expand` has one", name, key));
  return object.at(key);
}

} // namespace

std::string expansion_note(std::string_view reference_radius) {
  return fmt::format("these are mass moments Q_lm / R^l with R = {}", shown(reference_radius));
}

CoefficientFile read_expansion(const std::filesystem::path& path) {
  const std::string name = path.string();
  const json all = parse(name, read_file(path));
  const json& schema = member(name, all, "schema");
  if (schema != "cowgpu.result.v1")
    throw Error(Fault::file_format, fmt::format("{}: this JSON is no cowgpu.result.v1", name));
  const json& mass = member(name, member(name, all, "expansions"), "mass");
  const json& lmax = member(name, mass, "lmax");
  const json& radius = member(name, mass, "reference_radius");
  const json& rows = member(name, mass, "coefficients");
  if (member(name, mass, "normalisation") != "orthonormal" || member(name, mass, "condon_shortley") != true)
    throw Error(Fault::file_format,
                fmt::format("{}: the coefficients are not orthonormal with the Condon-Shortley phase", name));
  if (!radius.is_number() || !lmax.is_number_integer() || lmax < 0 || lmax > largest_file_degree || !rows.is_array() ||
      rows.size() != SphereCoefficients::count(lmax.get<int>()))
    throw Error(
        Fault::file_format,
        fmt::format("{}: lmax, reference_radius and the {} coefficients do not fit each other", name, rows.size()));
  CoefficientFile file;
  file.coefficients = SphereCoefficients(lmax.get<int>(), 1);
  file.names = {"mass"};
  std::string r;
  append_number(r, radius.get<double>());
  file.notes.push_back(expansion_note(r));
  std::size_t at = 0;
  for (int l = 0; l <= file.coefficients.lmax; ++l)
    for (int m = 0; m <= l; ++m, ++at) {
      const json& row = rows[at];
      if (!row.is_array() || row.size() != 4 || row[0] != l || row[1] != m || !row[2].is_number() ||
          !row[3].is_number())
        throw Error(Fault::file_syntax,
                    fmt::format("{}: coefficient {} is not [{}, {}, number, number]", name, at, l, m));
      file.coefficients.at(0, l, m) = {row[2].get<double>(), row[3].get<double>()};
    }
  return file;
}

} // namespace cowgpu

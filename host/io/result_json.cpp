#include "host/io/result_json.hpp"

#include "host/coefficient_set.hpp"
#include "host/error.hpp"
#include "host/io/foreign_file.hpp"
#include "host/io/shown.hpp"

#include <Eigen/LU>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace cowgpu::result_json {

using nlohmann::json;

namespace {

// A document takes memory by its brackets: rows of numbers have one in ten bytes and more, and nothing is nested deeply.
void check_brackets(const std::string& name, const std::string& bytes) {
  constexpr int deepest = 64;
  std::size_t open = 0;
  int depth = 0;
  bool text = false;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const char c = bytes[i];
    if (text && c == '\\')
      ++i;
    else if (c == '"')
      text = !text;
    else if (!text && (c == '[' || c == '{')) {
      ++open;
      if (++depth > deepest)
        throw Error(Fault::file_format,
                    fmt::format("{}: the JSON is nested more than {} deep; no file of coefficients is", name, deepest));
    } else if (!text && (c == ']' || c == '}'))
      --depth;
  }
  if (open > 1000 + bytes.size() / 8)
    throw Error(Fault::file_format, fmt::format("{}: {} lists and objects in {} bytes of JSON; no file of coefficients "
                                                "has so many",
                                                name, open, bytes.size()));
}

[[noreturn]] void refuse(const std::string& name, const std::string& bytes, std::size_t byte) {
  const auto line = 1 + std::count(bytes.begin(), bytes.begin() + std::ptrdiff_t(std::min(byte, bytes.size())), '\n');
  throw Error(Fault::file_syntax, fmt::format("{}:{}: this is not JSON, or it is damaged (byte {}{}); write the file "
                                              "again with `cowgpu expand` or `cowgpu convert`",
                                              name, line, byte, byte > bytes.size() ? ", where the file ends" : ""));
}

template <class Json>
Json parse_as(const std::string& name, const std::string& bytes) {
  // The parser takes a zero byte between two words for the end, and reads no further.
  if (const std::size_t zero = bytes.find('\0'); zero != std::string::npos) refuse(name, bytes, zero + 1);
  check_brackets(name, bytes);
  try {
    return Json::parse(bytes);
  } catch (const typename Json::parse_error& error) {
    refuse(name, bytes, error.byte);
  } catch (const typename Json::exception&) { // a number beyond a double
    throw Error(Fault::file_syntax,
                fmt::format("{}: this JSON holds a number beyond the range of doubles; write the file again", name));
  }
}

} // namespace

json parse(const std::filesystem::path& path) {
  return parse(path.string(), read_input_file(path));
}

json parse(const std::string& name, const std::string& bytes) {
  return parse_as<json>(name, bytes);
}

nlohmann::ordered_json parse_in_order(const std::string& name, const std::string& bytes) {
  return parse_as<nlohmann::ordered_json>(name, bytes);
}

Value value(const json& parsed) {
  switch (parsed.type()) {
  case json::value_t::boolean: return parsed.get<bool>();
  case json::value_t::number_integer: return parsed.get<std::int64_t>();
  case json::value_t::number_unsigned: return parsed.get<std::uint64_t>();
  case json::value_t::number_float: return parsed.get<double>();
  case json::value_t::string: return parsed.get<std::string>();
  case json::value_t::array: {
    List list;
    for (const json& element : parsed) list.push_back(value(element));
    return list;
  }
  case json::value_t::object: {
    Object object;
    for (const auto& [key, member] : parsed.items()) object.add(key, value(member));
    return object;
  }
  default: return {};
  }
}

json read(const std::filesystem::path& path) {
  const std::string name = path.string();
  json all = parse(path);
  if (member(name, all, "schema") != "cowgpu.result.v1")
    throw Error(
        Fault::file_format,
        fmt::format("{}: this JSON is not cowgpu.result.v1; take a file that `cowgpu expand -o FILE.json` wrote",
                    name));
  return all;
}

const json& member(const std::string& name, const json& object, const char* key) {
  if (!object.is_object() || !object.contains(key))
    throw Error(Fault::file_format,
                fmt::format("{}: no member '{}' where a result of `cowgpu expand` has one", name, key));
  return object.at(key);
}

double number(const std::string& name, const json& object, const char* key) {
  const json& value = member(name, object, key);
  if (!value.is_number())
    throw Error(Fault::file_format, fmt::format("{}: the member '{}' must be a number", name, key));
  return value.get<double>();
}

Placement placement(const std::string& name, const json& document) {
  Placement placement;
  const json& mesh = member(name, document, "mesh");
  if (!mesh.is_object() || !mesh.contains("placement")) return placement;
  const json& object = mesh.at("placement");
  if (!member(name, object, "metres_per_unit").is_null()) {
    placement.units.stated = true;
    placement.units.metre = number(name, object, "metres_per_unit");
  }
  const json& rows = member(name, object, "rotation");
  bool matrix = placement.units.metre > 0 && rows.is_array() && rows.size() == 3;
  for (int row = 0; matrix && row < 3; ++row) {
    const json& line = rows[std::size_t(row)];
    matrix = line.is_array() && line.size() == 3;
    for (int c = 0; matrix && c < 3; ++c) {
      matrix = line[std::size_t(c)].is_number();
      if (matrix) placement.rotation(row, c) = line[std::size_t(c)].get<double>();
    }
  }
  if (!matrix || !placement.rotation.isUnitary(1e-9) || !(placement.rotation.determinant() > 0))
    throw Error(
        Fault::file_format,
        fmt::format("{}: mesh.placement must hold a length above 0 (metres_per_unit) and a rotation matrix", name));
  return placement;
}

const json& expansion(const std::string& name, const json& result, const std::string& of) {
  const json& expansions = member(name, result, "expansions");
  if (!of.empty()) {
    if (expansions.is_object() && expansions.contains(of)) return expansions.at(of);
    std::string there;
    if (expansions.is_object())
      for (const auto& [key, value] : expansions.items()) there += (there.empty() ? "" : ", ") + shown(key);
    throw Error(Fault::bad_argument, fmt::format("--of {}: {} has no such expansion; there is {}", of, name,
                                                 there.empty() ? "none" : there));
  }
  if (expansions.is_object() && !expansions.empty() && !expansions.contains(mass_expansion))
    throw Error(Fault::file_format,
                fmt::format("{}: this file holds surfaces and no mass moments; `cowgpu expand --of ... -o FILE.csv` "
                            "writes the coefficients of surfaces so that they can be read here",
                            name));
  return member(name, expansions, mass_expansion);
}

SphereCoefficients coefficients(const std::string& name, const json& expansion, int fields, int largest) {
  if (member(name, expansion, "normalisation") != "orthonormal" || member(name, expansion, "condon_shortley") != true)
    throw Error(Fault::file_format,
                fmt::format("{}: the coefficients are not orthonormal with the Condon-Shortley phase", name));
  return rows(name, expansion, fields, largest);
}

SphereCoefficients rows(const std::string& name, const json& object, int fields, int largest) {
  const json& lmax = member(name, object, "lmax");
  const json& rows = member(name, object, "coefficients");
  if (!lmax.is_number_integer() || lmax < 0 || lmax > largest)
    throw Error(Fault::file_format, fmt::format("{}: lmax must be a whole number from 0 to {}", name, largest));
  if (!rows.is_array() || rows.size() != SphereCoefficients::count(lmax.get<int>()))
    throw Error(Fault::file_format,
                fmt::format("{}: {} coefficients do not fit lmax {}, which has {}", name, rows.size(), lmax.get<int>(),
                            SphereCoefficients::count(lmax.get<int>())));
  SphereCoefficients result(lmax.get<int>(), fields);
  std::size_t at = 0;
  for (int l = 0; l <= result.lmax; ++l)
    for (int m = 0; m <= l; ++m, ++at) {
      const json& row = rows[at];
      const std::size_t width = 2 + 2 * std::size_t(fields);
      if (!row.is_array() || row.size() != width || row[0] != l || row[1] != m ||
          !std::all_of(row.begin(), row.end(), [](const json& value) { return value.is_number(); }))
        throw Error(Fault::file_syntax,
                    fmt::format("{}: coefficient {} is not [{}, {}, and {} numbers]", name, at, l, m, 2 * fields));
      for (int f = 0; f < fields; ++f) {
        const std::size_t column = 2 + 2 * std::size_t(f);
        result.at(f, l, m) = {row[column].get<double>(), row[column + 1].get<double>()};
        if (m == 0 && result.at(f, l, m).imag() != 0)
          throw Error(Fault::file_syntax,
                      fmt::format("{}: coefficient {} of order 0 has an imaginary part, and that of a real field has "
                                  "none",
                                  name, at));
      }
    }
  return result;
}

} // namespace cowgpu::result_json

#include "host/io/expansion_file.hpp"

#include "host/error.hpp"
#include "host/io/number.hpp"
#include "host/io/result_json.hpp"
#include "host/io/shown.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace cowgpu {

using nlohmann::json;

std::string expansion_note(std::string_view reference_radius) {
  return fmt::format("these are mass moments Q_lm / R^l with R = {}", shown(reference_radius));
}

CoefficientFile read_expansion(const std::filesystem::path& path) {
  const std::string name = path.string();
  const json all = result_json::read(path);
  const json& expansions = result_json::member(name, all, "expansions");
  if (expansions.is_object() && !expansions.empty() && !expansions.contains("mass"))
    throw Error(Fault::file_format,
                fmt::format("{}: this file holds surfaces and no mass moments; `cowgpu expand --of ... -o FILE.csv` "
                            "writes the coefficients of surfaces so that they can be read here",
                            name));
  const json& mass = result_json::member(name, expansions, "mass");
  CoefficientFile file;
  file.coefficients = result_json::coefficients(name, mass, 1, largest_file_degree);
  file.names = {"mass"};
  std::string r;
  append_number(r, result_json::number(name, mass, "reference_radius"));
  file.notes.push_back(expansion_note(r));
  return file;
}

} // namespace cowgpu

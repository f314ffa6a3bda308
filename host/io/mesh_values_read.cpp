#include "host/io/mesh_values_read.hpp"

#include "host/error.hpp"
#include "host/io/csv_table.hpp"
#include "host/io/foreign_file.hpp"
#include "host/io/result_json.hpp"
#include "host/io/shown.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace cowgpu {
namespace {

using nlohmann::ordered_json;

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw Error(Fault::file_format,
              fmt::format("{}.json: {}; take both files that `cowgpu surface -o FILE.csv` wrote", name, why));
}

std::string text(const std::string& name, const ordered_json& object, const char* key) {
  if (!object.is_object() || !object.contains(key) || !object[key].is_string())
    refuse(name, fmt::format("the member '{}' must be a text", key));
  return one_line(object[key].get<std::string>());
}

ValuePlace place_of(const std::string& name, const ordered_json& about) {
  const std::string word = text(name, about, "place");
  for (const ValuePlace place : {ValuePlace::faces, ValuePlace::vertices, ValuePlace::points})
    if (word == name_of(place)) return place;
  refuse(name, fmt::format("the place '{}' is none of faces, vertices and points", shown(word)));
}

bool is_vector(const std::vector<std::string>& names, std::size_t first) {
  if (first + 2 >= names.size() || !names[first].ends_with("_x")) return false;
  const std::string name = names[first].substr(0, names[first].size() - 2);
  return !name.empty() && names[first + 1] == name + "_y" && names[first + 2] == name + "_z";
}

} // namespace

MeshValues read_mesh_values(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::string table = read_input_file(path);
  return parse_mesh_values(table, read_input_file(name + ".json"), name);
}

MeshValues parse_mesh_values(std::string_view bytes, const std::string& about_bytes, const std::string& name) {
  const CsvTable table = parse_csv(bytes, name);
  const ordered_json about = result_json::parse_in_order(name + ".json", about_bytes);
  if (text(name, about, "schema") != "cowgpu.values.v1")
    refuse(name, "this JSON is not of the schema cowgpu.values.v1");
  constexpr const char* first[] = {"id", "x", "y", "z"};
  if (table.columns.size() < 4 || !std::equal(std::begin(first), std::end(first), table.columns.begin()))
    table.fail(Fault::file_format, table.header_line, "a table of values begins with the columns id, x, y, z");
  if (!about.contains("columns") || !about["columns"].is_array() || about["columns"].size() != table.columns.size())
    refuse(name, "its columns are not those of the table");
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if (text(name, about["columns"][c], "name") != table.columns[c])
      refuse(name, "its columns are not those of the table");
  if (!about.contains("rows") || about["rows"] != table.rows()) refuse(name, "its rows are not as many as the table's");

  MeshValues values;
  values.title = text(name, about, "body");
  values.place = place_of(name, about);
  values.length_unit = text(name, about["columns"][1], "unit");
  if (about.contains("notes") && about["notes"].is_array())
    for (const ordered_json& note : about["notes"])
      if (note.is_string()) values.notes.push_back(one_line(note.get<std::string>()));
  if (about.contains("facts") && about["facts"].is_object())
    for (const auto& [key, fact] : about["facts"].items())
      if (fact.is_string()) values.facts.emplace_back(one_line(key), one_line(fact.get<std::string>()));
  for (std::size_t i = 0; i < table.rows(); ++i)
    values.places.emplace_back(table.at(i, 1), table.at(i, 2), table.at(i, 3));
  for (std::size_t c = 4; c < table.columns.size();) {
    ValueColumn column;
    column.components = is_vector(table.columns, c) ? 3 : 1;
    column.name = table.columns[c];
    if (column.components == 3) column.name.resize(column.name.size() - 2);
    column.unit = text(name, about["columns"][c], "unit");
    column.meaning = text(name, about["columns"][c], "meaning");
    for (std::size_t i = 0; i < table.rows(); ++i)
      for (std::size_t k = 0; k < std::size_t(column.components); ++k) column.values.push_back(table.at(i, c + k));
    c += std::size_t(column.components);
    values.columns.push_back(std::move(column));
  }
  if (values.place == ValuePlace::points) values.vertices = values.places;
  return values;
}

void put_on(MeshValues& values, const std::vector<Vec3>& vertices, const std::vector<Face>& faces) {
  const bool of_faces = values.place == ValuePlace::faces;
  if (values.place == ValuePlace::points)
    throw Error(
        Fault::bad_argument,
        fmt::format("{}: these values are at points, not on a mesh; take those at faces or vertices", values.title));
  const std::size_t wanted = of_faces ? faces.size() : vertices.size();
  if (values.places.size() != wanted)
    throw Error(
        Fault::file_format,
        fmt::format("{}: there are values of {} {}, and the mesh has {}; name the mesh that they were computed on",
                    values.title, values.places.size(), name_of(values.place), wanted));
  values.vertices = vertices;
  values.faces = faces;
}

} // namespace cowgpu

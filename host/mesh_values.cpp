#include "host/mesh_values.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace cowgpu {
namespace {

constexpr std::size_t longest_name = 40;

// Names that one of the formats gives to something else.
constexpr const char* taken_names[] = {
    "id",    "x",    "y",      "z",      "nx",     "ny",         "nz",     "red",  "green", "blue",  "alpha",
    "place", "mesh", "mesh_x", "mesh_y", "mesh_z", "face_nodes", "vertex", "face", "point", "three", "vertex_indices"};

bool letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_word(const std::string& name) {
  return !name.empty() && name.size() <= longest_name && letter(name[0]) &&
         std::all_of(name.begin(), name.end(), [](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

void check_names(const MeshValues& values) {
  std::set<std::string> seen(std::begin(taken_names), std::end(taken_names));
  for (const ValueColumn& column : values.columns) {
    if (column.components != 1 && column.components != 3)
      throw Error(Fault::bad_argument, fmt::format("the quantity '{}' has {} components; a number has 1 and a vector 3",
                                                   column.name, column.components));
    if (!is_word(column.name))
      throw Error(
          Fault::bad_argument,
          fmt::format("'{}' cannot name a quantity in files: a name is a letter and up to {} letters, digits and '_'",
                      column.name, longest_name - 1));
    for (const std::string& name : number_names(column))
      if (!seen.insert(name).second)
        throw Error(
            Fault::bad_argument,
            fmt::format("the name '{}' is taken, by another quantity or by files themselves; choose another", name));
  }
}

} // namespace

std::string name_of(ValuePlace place) {
  return place == ValuePlace::faces ? "faces" : place == ValuePlace::vertices ? "vertices" : "points";
}

std::string name_of_one(ValuePlace place) {
  return place == ValuePlace::faces ? "face" : place == ValuePlace::vertices ? "vertex" : "point";
}

void check(const MeshValues& values) {
  const std::size_t wanted = values.place == ValuePlace::faces ? values.faces.size() : values.vertices.size();
  if (values.places.size() != wanted)
    throw Error(Fault::bad_argument, fmt::format("values at {} places of {} {}; there must be one each",
                                                 values.places.size(), wanted, name_of(values.place)));
  if (wanted == 0)
    throw Error(Fault::mesh_empty,
                fmt::format("{}: there are no {} to have values", values.title, name_of(values.place)));
  check_names(values);
  for (const ValueColumn& column : values.columns)
    if (column.values.size() != wanted * std::size_t(column.components))
      throw Error(Fault::bad_argument,
                  fmt::format("{} values of '{}' for {} {}; there must be {} each", column.values.size(), column.name,
                              wanted, name_of(values.place), column.components));
  for (std::size_t f = 0; f < values.faces.size(); ++f)
    for (const std::uint32_t v : values.faces[f])
      if (v >= values.vertices.size())
        throw Error(Fault::mesh_index_range,
                    fmt::format("face {} names vertex {}, but there are {} vertices", f, v, values.vertices.size()));
  for (const auto* list : {&values.vertices, &values.places})
    for (std::size_t i = 0; i < list->size(); ++i)
      if (!(*list)[i].allFinite())
        throw Error(Fault::mesh_not_finite,
                    fmt::format("{} {} has no finite coordinates", list == &values.places ? "place" : "vertex", i));
}

std::vector<std::string> number_names(const ValueColumn& column) {
  if (column.components == 1) return {column.name};
  return {column.name + "_x", column.name + "_y", column.name + "_z"};
}

const ValueColumn& shown_column(const MeshValues& values, const std::string& name) {
  const ValueColumn* found = nullptr;
  std::string names;
  for (const ValueColumn& column : values.columns) {
    const bool is_asked = column.name == (name.empty() ? "slope" : name);
    if (is_asked && (!found || found->components > column.components)) found = &column;
    names += (names.empty() ? "" : ", ") + column.name;
  }
  if (found) return *found;
  if (values.columns.empty())
    throw Error(Fault::bad_argument, fmt::format("{}: there is no quantity to show", values.title));
  if (!name.empty())
    throw Error(Fault::bad_argument, fmt::format("there is no quantity '{}' to colour by; there are {}", name, names));
  const auto number = std::find_if(values.columns.begin(), values.columns.end(),
                                   [](const ValueColumn& column) { return column.components == 1; });
  return number == values.columns.end() ? values.columns.front() : *number;
}

std::vector<double> numbers_of(const ValueColumn& column) {
  if (column.components == 1) return column.values;
  std::vector<double> lengths;
  lengths.reserve(column.values.size() / 3);
  for (std::size_t i = 0; i + 2 < column.values.size(); i += 3)
    lengths.push_back(Vec3(column.values[i], column.values[i + 1], column.values[i + 2]).stableNorm());
  return lengths;
}

} // namespace cowgpu

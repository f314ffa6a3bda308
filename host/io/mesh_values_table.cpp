#include "host/io/mesh_values_formats.hpp"
#include "host/io/number.hpp"
#include "host/io/shown.hpp"
#include "host/version.hpp"

#include <nlohmann/json.hpp>

namespace cowgpu::mesh_values_file {

using nlohmann::ordered_json;

void write_table(const Job& job) {
  const MeshValues& values = job.values;
  Pieces out(job);
  std::string& text = out.bytes();
  text = "id,x,y,z";
  for (const ValueColumn& column : values.columns)
    for (const std::string& name : number_names(column)) text += ',' + name;
  text += '\n';
  for (std::size_t i = 0; i < values.places.size(); ++i) {
    text += std::to_string(i);
    const auto add = [&](double value) {
      text += ',';
      append_number(text, value);
    };
    for (int c = 0; c < 3; ++c) add(values.places[i][c]);
    for (const ValueColumn& column : values.columns)
      for (std::size_t c = 0, n = std::size_t(column.components); c < n; ++c) add(column.values[n * i + c]);
    text += '\n';
    out.more();
  }
  out.end();
}

void write_about(const MeshValues& values, const std::string& name, AtomicFile& file) {
  const std::string one = name_of_one(values.place);
  ordered_json columns = ordered_json::array();
  columns.push_back(
      {{"name", "id"}, {"unit", "1"}, {"meaning", "number of the " + one + " in the order of its file, from 0"}});
  for (const char* axis : {"x", "y", "z"})
    columns.push_back(
        {{"name", axis}, {"unit", values.length_unit}, {"meaning", "where the value is, axes of the mesh"}});
  for (const ValueColumn& column : values.columns)
    for (const std::string& number : number_names(column))
      columns.push_back({{"name", number}, {"unit", column.unit}, {"meaning", column.meaning}});
  ordered_json facts = ordered_json::object();
  for (const auto& [key, text] : values.facts) facts[key] = text;
  const ordered_json all = {{"schema", "cowgpu.values.v1"},
                            {"program", {{"name", "cowgpu"}, {"version", version}}},
                            {"table", name},
                            {"body", values.title},
                            {"place", name_of(values.place)},
                            {"rows", values.places.size()},
                            {"columns", std::move(columns)},
                            {"facts", std::move(facts)},
                            {"notes", values.notes}};
  file.write(terminal_json(all.dump(2, ' ', false, ordered_json::error_handler_t::replace)) + "\n");
}

} // namespace cowgpu::mesh_values_file

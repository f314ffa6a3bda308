// Climate and Forecast conventions 1.8, and UGRID 1.0 for the mesh.
#include "host/io/mesh_values_formats.hpp"
#include "host/io/netcdf.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <array>

namespace cowgpu::mesh_values_file {
namespace {

using Type = NetcdfWriter::Type;
constexpr int global = NetcdfWriter::global;

void describe(NetcdfWriter& out, int variable, const std::string& unit, const std::string& meaning) {
  if (!unit.empty()) out.attribute(variable, "units", unit);
  out.attribute(variable, "long_name", meaning);
}

} // namespace

void write_netcdf(const Job& job) {
  const MeshValues& values = job.values;
  const std::string one = name_of_one(values.place);
  const bool meshed = !values.faces.empty();
  NetcdfWriter out;

  std::array<int, 3> corners{};
  int topology = 0, nodes = 0, place = 0;
  if (meshed) {
    const int vertex = out.dimension("vertex", values.vertices.size());
    const std::array face = {out.dimension("face", values.faces.size()), out.dimension("three", 3)};
    topology = out.variable("mesh", Type::integer, {});
    out.attribute(topology, "cf_role", "mesh_topology");
    out.attribute(topology, "topology_dimension", std::int64_t{2});
    out.attribute(topology, "node_coordinates", "mesh_x mesh_y mesh_z");
    out.attribute(topology, "face_node_connectivity", "face_nodes");
    out.attribute(topology, "long_name", "triangles, counter-clockwise seen from outside");
    for (int c = 0; c < 3; ++c) {
      corners[std::size_t(c)] = out.variable(fmt::format("mesh_{}", "xyz"[c]), Type::real, std::array{vertex});
      describe(out, corners[std::size_t(c)], values.length_unit, fmt::format("{} of the vertex", "xyz"[c]));
    }
    nodes = out.variable("face_nodes", Type::integer, face);
    out.attribute(nodes, "cf_role", "face_node_connectivity");
    out.attribute(nodes, "start_index", std::int64_t{0});
    out.attribute(nodes, "long_name", "the vertices of each face, from 0");
    place = values.place == ValuePlace::faces ? face[0] : vertex;
  } else
    place = out.dimension("point", values.places.size());

  std::array<int, 3> places{};
  for (int c = 0; c < 3; ++c) {
    places[std::size_t(c)] = out.variable(std::string(1, "xyz"[c]), Type::real, std::array{place});
    describe(out, places[std::size_t(c)], values.length_unit, fmt::format("{} of the place of the value", "xyz"[c]));
  }
  std::vector<int> ids;
  for (const ValueColumn& column : values.columns)
    for (const std::string& name : number_names(column)) {
      ids.push_back(out.variable(name, Type::real, std::array{place}));
      describe(out, ids.back(), column.unit,
               column.components == 1 ? column.meaning
                                      : fmt::format("{}: {}", name.substr(name.size() - 1), column.meaning));
      out.attribute(ids.back(), "coordinates", "x y z");
      if (!meshed) continue;
      out.attribute(ids.back(), "mesh", "mesh");
      out.attribute(ids.back(), "location", values.place == ValuePlace::faces ? "face" : "node");
    }

  out.attribute(global, "Conventions", meshed ? "CF-1.8 UGRID-1.0" : "CF-1.8");
  out.attribute(global, "title", values.title);
  out.attribute(global, "source", fmt::format("cowgpu {}", version));
  for (const auto& [key, text] : values.facts) out.attribute(global, key, text);
  std::string notes;
  for (const std::string& note : values.notes) notes += (notes.empty() ? "" : " ") + note;
  out.attribute(global, "comment", notes);

  std::vector<double> numbers;
  const auto give = [&](int id, std::size_t count, auto&& number) {
    check_stop(job.monitor);
    numbers.resize(count);
    for (std::size_t i = 0; i < count; ++i) numbers[i] = number(i);
    out.values(id, numbers);
  };
  if (meshed) {
    give(topology, 1, [](std::size_t) { return 0.0; });
    for (int c = 0; c < 3; ++c)
      give(corners[std::size_t(c)], values.vertices.size(), [&](std::size_t i) { return values.vertices[i][c]; });
    give(nodes, 3 * values.faces.size(), [&](std::size_t i) { return double(values.faces[i / 3][i % 3]); });
  }
  for (int c = 0; c < 3; ++c)
    give(places[std::size_t(c)], values.places.size(), [&](std::size_t i) { return values.places[i][c]; });
  auto id = ids.begin();
  for (const ValueColumn& column : values.columns)
    for (std::size_t c = 0, n = std::size_t(column.components); c < n; ++c)
      give(*id++, values.places.size(), [&](std::size_t i) { return column.values[n * i + c]; });
  out.write_to(job.file);
}

} // namespace cowgpu::mesh_values_file

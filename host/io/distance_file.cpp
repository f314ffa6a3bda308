#include "host/io/distance_file.hpp"

#include "host/io/netcdf.hpp"
#include "host/io/number.hpp"
#include "host/io/shown.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace cowgpu {
namespace {

void write_netcdf(const DistanceTable& table, AtomicFile& file) {
  using Type = NetcdfWriter::Type;
  NetcdfWriter out;
  std::vector<int> dimensions;
  int coordinates[3] = {};
  if (table.lattice) {
    for (int c = 2; c >= 0; --c)
      dimensions.push_back(out.dimension(std::string(1, "xyz"[c]), table.lattice->counts[std::size_t(c)]));
    for (std::size_t c = 0; c < 3; ++c)
      coordinates[c] = out.variable(std::string(1, "xyz"[c]), Type::real, std::span(dimensions).subspan(2 - c, 1));
  } else {
    dimensions.push_back(out.dimension("point", table.queries.size()));
    for (std::size_t c = 0; c < 3; ++c) coordinates[c] = out.variable(std::string(1, "xyz"[c]), Type::real, dimensions);
  }
  for (int c = 0; c < 3; ++c) {
    out.attribute(coordinates[c], "units", "1");
    out.attribute(coordinates[c], "axis", std::string(1, "XYZ"[c]));
    out.attribute(coordinates[c], "long_name", fmt::format("{} in the mesh's length unit", "xyz"[c]));
  }
  const ClosestPoints& p = table.points;
  struct Column {
    int id;
    std::function<double(std::size_t)> value;
  };
  std::vector<Column> columns;
  const auto add = [&](const std::string& name, Type type, const std::string& meaning, auto value) {
    const int id = out.variable(name, type, dimensions);
    out.attribute(id, "long_name", meaning);
    if (type == Type::real) out.attribute(id, "units", "1");
    columns.push_back({id, value});
    return id;
  };
  add("distance", Type::real,
      p.winding.empty() ? "distance from the surface" : "distance from the surface, negative inside",
      [&p](std::size_t i) { return p.distance[i]; });
  for (int c = 0; c < 3; ++c)
    add(fmt::format("closest_{}", "xyz"[c]), Type::real, fmt::format("{} of the closest point", "xyz"[c]),
        [&p, c](std::size_t i) { return p.point[i][c]; });
  add("face", Type::integer, "face of the closest point, counted from 0",
      [&p](std::size_t i) { return double(p.face[i]); });
  for (int c = 0; c < 3; ++c)
    add(fmt::format("b{}", c), Type::real, fmt::format("barycentric coordinate of corner {} of the face", c),
        [&p, c](std::size_t i) { return p.barycentric[i][c]; });
  const int feature = add("feature", Type::integer, "what the closest point lies on",
                          [&p](std::size_t i) { return double(p.feature[i].kind); });
  out.attribute(feature, "flag_meanings", "0_vertex 1_edge 2_face");
  add("feature_first", Type::integer, "the vertex, the edge's lower vertex, or the face",
      [&p](std::size_t i) { return double(p.feature[i].first); });
  add("feature_second", Type::integer, "the vertex, the edge's higher vertex, or the face",
      [&p](std::size_t i) { return double(p.feature[i].second); });
  if (!p.winding.empty())
    add("winding", Type::integer, "winding number of the surface",
        [&p](std::size_t i) { return double(p.winding[i]); });

  out.attribute(NetcdfWriter::global, "title", "Distances from a surface");
  out.attribute(NetcdfWriter::global, "source", fmt::format("cowgpu {}", version));
  out.attribute(NetcdfWriter::global, "mesh", table.mesh);
  out.attribute(NetcdfWriter::global, "sha256", table.sha256);
  std::vector<double> values;
  for (int c = 0; c < 3; ++c) {
    values.clear();
    if (table.lattice)
      for (std::size_t i = 0; i < table.lattice->counts[std::size_t(c)]; ++i)
        values.push_back(table.lattice->coordinate(c, i));
    else
      for (const Vec3& q : table.queries) values.push_back(q[c]);
    out.values(coordinates[c], values);
  }
  values.resize(table.queries.size());
  for (const Column& column : columns) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = column.value(i);
    out.values(column.id, values);
  }
  out.write_to(file);
}

} // namespace

std::vector<Vec3> PointLattice::points() const {
  std::vector<Vec3> all;
  all.reserve(size());
  for (std::size_t k = 0; k < counts[2]; ++k)
    for (std::size_t j = 0; j < counts[1]; ++j)
      for (std::size_t i = 0; i < counts[0]; ++i)
        all.emplace_back(coordinate(0, i), coordinate(1, j), coordinate(2, k));
  return all;
}

PointLattice lattice_about(const Vec3& low, const Vec3& high, double factor, std::size_t along_longest) {
  PointLattice lattice;
  const Vec3 sides = factor * (high - low), middle = low / 2 + high / 2;
  lattice.spacing = sides.maxCoeff() / double(along_longest - 1);
  for (int c = 0; c < 3; ++c) {
    // A side that is a multiple of the spacing but for rounding gets no layer more.
    const double steps = lattice.spacing > 0 ? std::ceil(sides[c] / lattice.spacing * (1 - 1e-12)) : 0;
    lattice.counts[std::size_t(c)] = std::size_t(steps) + 1;
    lattice.first[c] = middle[c] - steps / 2 * lattice.spacing;
  }
  return lattice;
}

void write_distances_csv(const DistanceTable& table, const std::function<void(std::string_view)>& sink) {
  const ClosestPoints& p = table.points;
  const bool with_sign = !p.winding.empty();
  std::string text =
      fmt::format("# cowgpu {}\n# mesh {}\n# sha256 {}\n# signed {}\n"
                  "x,y,z,distance,closest_x,closest_y,closest_z,face,b0,b1,b2,"
                  "feature,feature_first,feature_second{}\n",
                  version, one_line(table.mesh), table.sha256, with_sign ? "yes" : "no", with_sign ? ",winding" : "");
  const auto append_vector = [&text](const Vec3& v) {
    for (int c = 0; c < 3; ++c) {
      append_number(text, v[c]);
      text += ',';
    }
  };
  for (std::size_t i = 0; i < p.size(); ++i) {
    append_vector(table.queries[i]);
    append_number(text, p.distance[i]);
    text += ',';
    append_vector(p.point[i]);
    fmt::format_to(std::back_inserter(text), "{},", p.face[i]);
    append_vector(p.barycentric[i]);
    const SurfaceFeature& f = p.feature[i];
    fmt::format_to(std::back_inserter(text), "{},{},{}", name(f.kind), f.first, f.second);
    if (with_sign) fmt::format_to(std::back_inserter(text), ",{}", p.winding[i]);
    text += '\n';
    if (text.size() > 65536) {
      sink(text);
      text.clear();
    }
  }
  sink(text);
}

void write_distances(const DistanceTable& table, FileFormat format, AtomicFile& file) {
  if (format == FileFormat::netcdf)
    write_netcdf(table, file);
  else
    write_distances_csv(table, [&file](std::string_view text) { file.write(text); });
}

} // namespace cowgpu

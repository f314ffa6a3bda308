#include "host/io/potential_file.hpp"

#include "host/io/netcdf.hpp"
#include "host/io/number.hpp"
#include "host/io/shown.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

namespace cowgpu {
namespace {

struct Column {
  std::string name, unit;
  std::function<double(std::size_t)> value;
};

std::vector<Column> columns_of(const PotentialTable& table) {
  std::vector<Column> columns;
  const PotentialField& f = table.field;
  for (int c = 0; c < 3; ++c)
    columns.push_back(
        {std::string(1, "xyz"[c]), table.length_unit, [&, c](std::size_t i) { return table.points[i][c]; }});
  columns.push_back({"potential", table.potential_unit, [&f](std::size_t i) { return f.value[i]; }});
  const char letter = table.charge ? 'e' : 'a';
  if (!f.gradient.empty())
    for (int c = 0; c < 3; ++c)
      columns.push_back({fmt::format("{}{}", letter, "xyz"[c]), table.force_unit,
                         [&f, c](std::size_t i) { return f.gradient[i][c]; }});
  if (!f.hessian.empty())
    for (std::size_t c = 0; c < 6; ++c) {
      constexpr const char* names[] = {"xx", "xy", "xz", "yy", "yz", "zz"};
      columns.push_back({fmt::format("{}{}", letter, names[c]), table.tensor_unit,
                         [&f, c](std::size_t i) { return f.hessian[i][c]; }});
    }
  if (!table.induction.empty())
    for (int c = 0; c < 3; ++c)
      columns.push_back(
          {fmt::format("b_{}", "xyz"[c]), "T", [&table, c](std::size_t i) { return table.induction[i][c]; }});
  if (!table.exact.empty()) columns.push_back({"exact", "1", [&](std::size_t i) { return double(table.exact[i]); }});
  return columns;
}

void write_csv(const PotentialTable& table, AtomicFile& file, const Monitor& monitor) {
  const std::vector<Column> columns = columns_of(table);
  std::string text = fmt::format("# cowgpu {}\n# input {}\n# length {}\n# potential {}\n# {} {}\n# gradient {}\n",
                                 version, one_line(table.input), table.length_unit, table.potential_unit,
                                 table.charge ? "field" : "acceleration", table.force_unit, table.tensor_unit);
  for (std::size_t c = 0; c < columns.size(); ++c) text += (c ? "," : "") + columns[c].name;
  text += '\n';
  for (std::size_t i = 0; i < table.points.size(); ++i) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (c) text += ',';
      append_number(text, columns[c].value(i));
    }
    text += '\n';
    if (text.size() < 65536) continue;
    check_stop(monitor);
    file.write(text);
    text.clear();
  }
  file.write(text);
}

void write_netcdf(const PotentialTable& table, AtomicFile& file, const Monitor& monitor) {
  using Type = NetcdfWriter::Type;
  NetcdfWriter out;
  std::vector<int> dimensions;
  int latitude = 0, longitude = 0;
  std::array<int, 3> sides{};
  const bool lattice = table.lattice[0] > 0;
  if (table.grid) {
    dimensions = {out.dimension("lat", std::size_t(table.grid->rings)),
                  out.dimension("lon", std::size_t(table.grid->ring_length))};
    latitude = out.variable("lat", Type::real, std::span(dimensions).first(1));
    longitude = out.variable("lon", Type::real, std::span(dimensions).last(1));
    out.attribute(latitude, "units", "degrees_north");
    out.attribute(longitude, "units", "degrees_east");
    out.attribute(NetcdfWriter::global, "radius", table.radius);
  } else if (lattice) {
    for (int c = 2; c >= 0; --c) {
      const std::string name(1, "xyz"[c]);
      dimensions.push_back(out.dimension(name, std::size_t(table.lattice[std::size_t(c)])));
      sides[std::size_t(c)] = out.variable(name, Type::real, std::span(dimensions).last(1));
      out.attribute(sides[std::size_t(c)], "units", table.length_unit);
    }
  } else {
    dimensions = {out.dimension("point", table.points.size())};
  }
  std::vector<Column> columns = columns_of(table);
  if (lattice) columns.erase(columns.begin(), columns.begin() + 3); // x, y and z
  std::vector<int> ids;
  for (const Column& column : columns) {
    ids.push_back(out.variable(column.name, Type::real, dimensions));
    out.attribute(ids.back(), "units", column.unit);
  }
  out.attribute(NetcdfWriter::global, "title", table.charge ? "Electric potential" : "Gravitational potential");
  out.attribute(NetcdfWriter::global, "source", fmt::format("cowgpu {}", version));
  out.attribute(NetcdfWriter::global, "input", table.input);
  std::vector<double> values;
  if (table.grid) {
    for (int i = 0; i < table.grid->rings; ++i) values.push_back(table.grid->latitude_degrees(i));
    out.values(latitude, values);
    values.clear();
    for (int j = 0; j < table.grid->ring_length; ++j) values.push_back(table.grid->longitude_degrees(j));
    out.values(longitude, values);
  }
  if (lattice) {
    std::size_t stride = 1;
    for (int c = 0; c < 3; ++c) {
      const auto n = std::size_t(table.lattice[std::size_t(c)]);
      values.clear();
      for (std::size_t i = 0; i < n; ++i) values.push_back(table.points[i * stride][c]);
      out.values(sides[std::size_t(c)], values);
      stride *= n;
    }
  }
  values.resize(table.points.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    check_stop(monitor);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = columns[c].value(i);
    out.values(ids[c], values);
  }
  out.write_to(file);
}

} // namespace

void write_potentials(const PotentialTable& table, FileFormat format, AtomicFile& file, const Monitor& monitor) {
  if (format == FileFormat::netcdf)
    write_netcdf(table, file, monitor);
  else
    write_csv(table, file, monitor);
}

std::uint64_t potential_file_bytes(std::uint64_t points) {
  return 2 * 8 * 19 * points + (1 << 20); // netCDF keeps an image of the file
}

} // namespace cowgpu

#include "host/io/grid_file.hpp"

#include "host/error.hpp"
#include "host/io/csv_table.hpp"
#include "host/io/netcdf.hpp"
#include "host/io/number.hpp"
#include "host/io/shown.hpp"
#include "host/sphere_transform.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace cowgpu {
namespace {

constexpr double degrees_tolerance = 1e-6;
constexpr double repeat_tolerance = 1e-9; // of the largest value: a column at 360 E against that at 0
constexpr std::size_t most_rings = 2 * largest_grid_degree + 3, longest_ring = 8 * largest_grid_degree + 1;

// A grid as it stands in the file.
struct Raw {
  std::string name;               // of the file
  std::vector<double> lats, lons; // degrees
  std::vector<std::string> names; // of the fields
  std::optional<GridKind> kind;   // as the file says
  bool either_dh = false;         // it says DH, and the shape tells which
  std::function<double(std::size_t f, std::size_t i, std::size_t j)> value;
  std::function<std::string(std::size_t i)> lat_place, lon_place; // what opens a message
  std::function<std::string(std::size_t f, std::size_t i, std::size_t j)> value_place;
};

[[noreturn]] void damaged(const std::string& place, const std::string& sentence) {
  throw Error(Fault::file_syntax, fmt::format("{}: {}", place, sentence));
}

bool near(double a, double b) {
  return std::fabs(a - b) <= degrees_tolerance;
}

// Which rows and columns of the file make the grid.
struct Cut {
  bool turned = false;     // rings from south to north
  std::size_t skipped = 0; // first row of the file that counts
  bool extra_column = false;
};

void check_coordinates(const Raw& raw, const SphereGrid& grid, const Cut& cut) {
  for (int i = 0; i < grid.rings; ++i) {
    const std::size_t at = cut.turned ? cut.skipped + std::size_t(grid.rings - 1 - i) : std::size_t(i);
    const double found = raw.lats[at], expected = grid.latitude_degrees(i);
    if (!near(found, expected))
      damaged(raw.lat_place(at), fmt::format("latitude {} where ring {} of the {} grid of {} rings lies at {} degrees; "
                                             "--grid can name another kind",
                                             found, i, name(grid.kind), grid.rings, expected));
  }
  for (int j = 0; j < grid.ring_length; ++j) {
    const double found = raw.lons[std::size_t(j)], expected = grid.longitude_degrees(j);
    if (!near(found, expected))
      damaged(raw.lon_place(std::size_t(j)),
              fmt::format("longitude {} where point {} of a ring of {} lies at {} degrees; rings begin at 0 and go "
                          "eastwards",
                          found, j, grid.ring_length, expected));
  }
}

// Values in the grid's order, finite, and what was left out compared with what it repeats.
void take_values(const Raw& raw, const Cut& cut, GridFile& file) {
  const SphereGrid& grid = file.grid;
  const auto rings = std::size_t(grid.rings), length = std::size_t(grid.ring_length);
  file.values.resize(raw.names.size() * grid.points());
  auto to = file.values.begin();
  for (std::size_t f = 0; f < raw.names.size(); ++f) {
    double largest = 0;
    for (std::size_t i = 0; i < rings; ++i) {
      const std::size_t row = cut.turned ? cut.skipped + rings - 1 - i : i;
      for (std::size_t j = 0; j < length; ++j) {
        const double value = raw.value(f, row, j);
        if (!std::isfinite(value))
          damaged(raw.value_place(f, row, j), "a missing value, NaN or infinity: a transform needs every point");
        largest = std::max(largest, std::fabs(value));
        *to++ = value;
      }
    }
    for (std::size_t row = 0; cut.extra_column && row < rings; ++row) {
      const double last = raw.value(f, row + cut.skipped, length), first = raw.value(f, row + cut.skipped, 0);
      if (!(std::fabs(last - first) <= repeat_tolerance * largest))
        damaged(raw.value_place(f, row + cut.skipped, length), fmt::format("{} at 360 E and {} at 0", last, first));
    }
  }
}

// The grid that the coordinates make, and its values.
GridFile build(Raw raw, std::optional<GridKind> wanted) {
  std::size_t rings = raw.lats.size(), length = raw.lons.size();
  if (rings < 1 || length < 1 || rings > most_rings || length > longest_ring)
    damaged(raw.name, fmt::format("{} latitudes and {} longitudes: at most {} and {} are possible", rings, length,
                                  most_rings, longest_ring));
  if (raw.names.size() > std::size_t(most_fields))
    throw Error(Fault::too_large,
                fmt::format("{}: {} fields; at most {} are possible", raw.name, raw.names.size(), most_fields));
  Cut cut;
  GridFile file;
  cut.turned = raw.lats.front() < raw.lats.back();
  if (cut.turned) file.notes.push_back("the file's rings go from south to north and were turned over");
  cut.extra_column = length > 1 && near(raw.lons.front(), 0) && near(raw.lons.back(), 360);
  if (cut.extra_column) {
    --length;
    file.notes.push_back("the column at 360 E repeats the one at 0 and was left out");
  }
  std::optional<GridKind> kind = wanted ? wanted : raw.kind;
  const bool no_south_pole =
      raw.either_dh || kind == GridKind::driscoll_healy || kind == GridKind::driscoll_healy_square;
  if (no_south_pole && rings > 1 && near(cut.turned ? raw.lats.front() : raw.lats.back(), -90)) {
    --rings;
    cut.skipped = cut.turned;
    file.notes.push_back("the row at 90 S is no part of a dh grid and was left out");
  }
  if (!kind && raw.either_dh) kind = length == rings ? GridKind::driscoll_healy_square : GridKind::driscoll_healy;
  if (!kind)
    throw Error(Fault::file_format, fmt::format("{}: the attribute grid is missing, so it is not known what grid this "
                                                "is; name it with --grid gl, cc, dh or dh1",
                                                raw.name));
  try {
    file.grid = make_grid(*kind, int(rings), int(length));
  } catch (const Error& error) {
    throw Error(Fault::file_format, fmt::format("{}: {}", raw.name, error.what()));
  }
  check_coordinates(raw, file.grid, cut);
  file.lmax = file.grid.lmax;
  take_values(raw, cut, file);
  file.names = std::move(raw.names);
  return file;
}

Convention convention_of(const std::string& normalisation, const std::string& phase, const std::string& place) {
  const auto n = normalisation_named(normalisation);
  const auto p = phase_named(phase);
  if (!n)
    damaged(place, fmt::format("normalisation is '{}'; there are orthonormal, 4pi, schmidt and unnormalised",
                               shown(normalisation)));
  if (!p) damaged(place, fmt::format("phase is '{}'; there are cs and none", shown(phase)));
  return {*n, *p};
}

void set_kind(Raw& raw, const std::string& word, const std::string& place) {
  raw.kind = grid_kind_named(word);
  if (!raw.kind) damaged(place, fmt::format("grid is '{}'; there are gl, cc, dh and dh1", shown(word)));
}

GridFile read_csv_grid(const std::filesystem::path& path, std::optional<GridKind> kind) {
  const CsvTable table = read_csv(path);
  if (table.columns.size() < 3 || table.columns[0] != "lat" || table.columns[1] != "lon")
    table.fail(Fault::file_format, table.header_line,
               "a grid has the columns lat,lon,value (or more fields after them)");
  if (table.rows() == 0) table.fail(Fault::file_truncated, table.header_line, "the file ends after the column names");
  std::size_t length = 1;
  while (length < table.rows() && near(table.at(length, 0), table.at(0, 0))) ++length;
  if (table.rows() % length)
    table.fail(Fault::file_truncated, table.first_line + table.rows() - 1,
               fmt::format("{} rows are no whole number of rings of {} points, which the first latitude has",
                           table.rows(), length));
  Raw raw;
  raw.name = table.name;
  for (std::size_t i = 0; i < table.rows(); i += length) raw.lats.push_back(table.at(i, 0));
  for (std::size_t j = 0; j < length; ++j) raw.lons.push_back(table.at(j, 1));
  raw.names.assign(table.columns.begin() + 2, table.columns.end());
  const auto line = [&](std::size_t row) { return fmt::format("{}:{}", table.name, table.first_line + row); };
  raw.value = [&](std::size_t f, std::size_t i, std::size_t j) { return table.at(i * length + j, f + 2); };
  raw.lat_place = [&](std::size_t i) { return line(i * length); };
  raw.lon_place = [&](std::size_t j) { return line(j); };
  raw.value_place = [&](std::size_t, std::size_t i, std::size_t j) { return line(i * length + j); };
  const bool ours = table.attributes.contains("grid");
  if (ours) set_kind(raw, table.attribute("grid").text, fmt::format("{}:{}", table.name, table.attribute("grid").line));
  for (std::size_t row = 0; row < table.rows(); ++row)
    if (!near(table.at(row, 0), raw.lats[row / length]) || !near(table.at(row, 1), raw.lons[row % length]))
      table.fail_row(row, "every ring must have the same longitudes in the same order, and one latitude");
  GridFile file = build(std::move(raw), kind);
  if (!ours) return file;
  file.lmax = table.integer("lmax", 0, file.grid.lmax);
  const auto& normalisation = table.attribute("normalisation");
  const auto& phase = table.attribute("phase");
  file.convention = convention_of(normalisation.text, phase.text,
                                  fmt::format("{}:{}", table.name, std::max(normalisation.line, phase.line)));
  return file;
}

const std::string& text_of(const NetcdfFile& netcdf, const char* key) {
  const NetcdfAttribute* a = attribute(netcdf.attributes, key);
  if (!a || !a->is_text) damaged(netcdf.name, fmt::format("the global attribute {} is missing or no text", key));
  return a->text;
}

const NetcdfVariable& coordinate(const NetcdfFile& netcdf, const char* key) {
  const NetcdfVariable* v = netcdf.variable(key);
  if (!v || !v->read || v->dimensions.size() != 1 || netcdf.dimensions[v->dimensions[0]].name != key)
    throw Error(
        Fault::file_format,
        fmt::format("{}: there is no coordinate variable {} of its own dimension: a grid has lat(lat) and lon(lon)",
                    netcdf.name, key));
  const NetcdfAttribute* units = attribute(v->attributes, "units");
  if (units && (!units->is_text || !units->text.starts_with("degree")))
    damaged(fmt::format("{}: variable {}", netcdf.name, key),
            fmt::format("units '{}' are not degrees", shown(units->text)));
  return *v;
}

GridFile read_netcdf_grid(const std::filesystem::path& path, std::optional<GridKind> kind) {
  const NetcdfFile netcdf = read_netcdf(path);
  if (netcdf.variable("degree") && netcdf.variable("order"))
    throw Error(Fault::file_format, fmt::format("{}: these are coefficients, not a grid; `cowgpu transform synthesise` "
                                                "makes a grid of them",
                                                netcdf.name));
  const NetcdfVariable &lat = coordinate(netcdf, "lat"), &lon = coordinate(netcdf, "lon");
  std::vector<const NetcdfVariable*> fields;
  Raw raw;
  raw.name = netcdf.name;
  for (const NetcdfVariable& v : netcdf.variables) {
    if (!v.read || v.dimensions.size() != 2 || v.dimensions[0] != lat.dimensions[0] ||
        v.dimensions[1] != lon.dimensions[0])
      continue;
    if (attribute(v.attributes, "scale_factor") || attribute(v.attributes, "add_offset"))
      throw Error(Fault::file_format, fmt::format("{}: variable {} is packed (scale_factor, add_offset); unpack it "
                                                  "first, for example with ncpdq -U",
                                                  netcdf.name, shown(v.name)));
    fields.push_back(&v);
  }
  sort_fields(fields);
  for (const NetcdfVariable* v : fields) raw.names.push_back(v->name);
  if (fields.empty())
    throw Error(Fault::file_format,
                fmt::format("{}: there is no variable with the dimensions (lat, lon)", netcdf.name));
  raw.lats = lat.values;
  raw.lons = lon.values;
  const std::size_t length = lon.values.size();
  raw.value = [&, length](std::size_t f, std::size_t i, std::size_t j) {
    return present_value(*fields[f], i * length + j);
  };
  raw.lat_place = [&](std::size_t i) { return fmt::format("{}: variable lat, value {}", netcdf.name, i); };
  raw.lon_place = [&](std::size_t j) { return fmt::format("{}: variable lon, value {}", netcdf.name, j); };
  raw.value_place = [&](std::size_t f, std::size_t i, std::size_t j) {
    return fmt::format("{}: variable {}, row {}, column {}", netcdf.name, shown(fields[f]->name), i, j);
  };
  const bool ours = attribute(netcdf.attributes, "grid") != nullptr;
  if (ours) {
    set_kind(raw, text_of(netcdf, "grid"), netcdf.name + ": global attributes");
  } else if (const NetcdfAttribute* theirs = attribute(fields[0]->attributes, "grid")) {
    raw.either_dh = theirs->text == "DH";
    if (theirs->text == "GLQ") raw.kind = GridKind::gauss_legendre;
  }
  GridFile file = build(std::move(raw), kind);
  if (!ours) return file;
  const std::string place = netcdf.name + ": global attributes";
  const NetcdfAttribute* lmax = attribute(netcdf.attributes, "lmax");
  if (!lmax || lmax->is_text) damaged(place, "lmax is missing or no number");
  if (!(lmax->number >= 0 && lmax->number <= file.grid.lmax) || lmax->number != std::floor(lmax->number))
    damaged(place, fmt::format("lmax is {}; from 0 to {} are possible on this grid", lmax->number, file.grid.lmax));
  file.lmax = int(lmax->number);
  file.convention = convention_of(text_of(netcdf, "normalisation"), text_of(netcdf, "phase"), place);
  return file;
}

void write_csv_grid(const GridFile& grid, AtomicFile& file) {
  std::string text =
      fmt::format("# cowgpu {}\n# grid {}\n# lmax {}\n# normalisation {}\n# phase {}\nlat,lon", version,
                  name(grid.grid.kind), grid.lmax, name(grid.convention.normalisation), name(grid.convention.phase));
  for (const std::string& field : field_names(grid.names, grid.fields(), "value")) text += "," + field;
  text += "\n";
  const std::size_t points = grid.grid.points(), length = std::size_t(grid.grid.ring_length);
  for (std::size_t p = 0; p < points; ++p) {
    append_number(text, grid.grid.latitude_degrees(int(p / length)));
    text += ",";
    append_number(text, grid.grid.longitude_degrees(int(p % length)));
    for (std::size_t f = 0; f < std::size_t(grid.fields()); ++f) {
      text += ",";
      append_number(text, grid.values[f * points + p]);
    }
    text += "\n";
    if (text.size() > 65536) {
      file.write(text);
      text.clear();
    }
  }
  file.write(text);
}

void write_netcdf_grid(const GridFile& grid, AtomicFile& file) {
  NetcdfWriter out;
  const SphereGrid& g = grid.grid;
  const int dimensions[] = {out.dimension("lat", std::size_t(g.rings)),
                            out.dimension("lon", std::size_t(g.ring_length))};
  const int lat = out.variable("lat", NetcdfWriter::Type::real, std::span(dimensions, 1));
  const int lon = out.variable("lon", NetcdfWriter::Type::real, std::span(dimensions + 1, 1));
  out.attribute(lat, "long_name", "latitude");
  out.attribute(lat, "units", "degrees_north");
  out.attribute(lon, "long_name", "longitude");
  out.attribute(lon, "units", "degrees_east");
  std::vector<int> fields;
  for (const std::string& field : field_names(grid.names, grid.fields(), "value")) {
    fields.push_back(out.variable(field, NetcdfWriter::Type::real, dimensions));
    if (grid.fields() > 1) out.attribute(fields.back(), "field", std::int64_t(fields.size()));
  }
  out.attribute(NetcdfWriter::global, "title", "Field on the sphere");
  out.attribute(NetcdfWriter::global, "source", fmt::format("cowgpu {}", version));
  out.attribute(NetcdfWriter::global, "grid", name(g.kind));
  out.attribute(NetcdfWriter::global, "lmax", std::int64_t(grid.lmax));
  out.attribute(NetcdfWriter::global, "normalisation", name(grid.convention.normalisation));
  out.attribute(NetcdfWriter::global, "phase", name(grid.convention.phase));
  std::vector<double> degrees;
  for (int i = 0; i < g.rings; ++i) degrees.push_back(g.latitude_degrees(i));
  out.values(lat, degrees);
  degrees.clear();
  for (int j = 0; j < g.ring_length; ++j) degrees.push_back(g.longitude_degrees(j));
  out.values(lon, degrees);
  for (std::size_t f = 0; f < fields.size(); ++f)
    out.values(fields[f], std::span(grid.values).subspan(f * g.points(), g.points()));
  out.write_to(file);
}

} // namespace

std::optional<GridKind> grid_kind_named(std::string_view word) {
  for (const GridKind kind :
       {GridKind::gauss_legendre, GridKind::clenshaw_curtis, GridKind::driscoll_healy, GridKind::driscoll_healy_square})
    if (word == name(kind)) return kind;
  return {};
}

GridFile read_grid(const std::filesystem::path& path, std::optional<GridKind> kind) {
  return file_format(path) == FileFormat::netcdf ? read_netcdf_grid(path, kind) : read_csv_grid(path, kind);
}

void write_grid(const GridFile& grid, FileFormat format, AtomicFile& file) {
  if (format == FileFormat::netcdf)
    write_netcdf_grid(grid, file);
  else
    write_csv_grid(grid, file);
}

} // namespace cowgpu

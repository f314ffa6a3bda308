#include "host/io/grid_file.hpp"

#include "host/error.hpp"
#include "host/io/csv_table.hpp"
#include "host/io/netcdf.hpp"
#include "host/io/number.hpp"
#include "host/io/shown.hpp"
#include "host/io/words.hpp"
#include "host/sphere_transform.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

namespace cowgpu {
namespace {

constexpr double degrees_tolerance = 1e-6, single_tolerance = 4e-5; // tolerance of doubles, and of floats up to 360
constexpr double repeat_tolerance = 1e-9; // part of the largest value: a column at 360 E against that at 0
constexpr std::size_t most_rings = 2 * largest_grid_degree + 3, longest_ring = 8 * largest_grid_degree + 1;

// A grid as it stands in the file.
struct Raw {
  std::string name;               // name of the file
  std::vector<double> lats, lons; // degrees
  std::vector<std::string> names; // names of the fields
  std::optional<GridKind> kind;   // as the file says
  bool either_dh = false;         // it says DH, and the shape tells which
  double tolerance = degrees_tolerance;
  std::vector<std::string> notes;
  std::function<double(std::size_t f, std::size_t i, std::size_t j)> value;
  std::function<std::string(std::size_t i)> lat_place, lon_place; // what opens a message
  std::function<std::string(std::size_t f, std::size_t i, std::size_t j)> value_place;
};

[[noreturn]] void damaged(const std::string& place, const std::string& sentence) {
  throw Error(Fault::file_syntax, fmt::format("{}: {}", place, sentence));
}

bool near(double a, double b, double tolerance = degrees_tolerance) {
  return std::fabs(a - b) <= tolerance;
}

// Which rows and columns of the file make the grid.
struct Cut {
  bool turned = false;              // rings from south to north
  std::size_t skipped = 0;          // first row of the file that counts
  std::vector<std::size_t> columns; // columns of the file, from longitude 0 eastwards
  double first_longitude = 0;       // longitude of the first column, in degrees
  std::optional<std::size_t> extra; // the file's last column, which repeats its first
};

double longitude_from_0(double lon, double tolerance) {
  double rest = std::fmod(lon, 360);
  if (rest < -tolerance) rest += 360;
  return rest > 360 - tolerance ? rest - 360 : rest;
}

// Columns in the order of their longitudes, counted from 0, wherever the file begins and whichever way it goes.
void order_columns(const Raw& raw, Cut& cut, std::vector<std::string>& notes) {
  const std::size_t length = raw.lons.size();
  for (std::size_t j = 0; j < length; ++j)
    if (!(std::fabs(raw.lons[j]) <= 720)) damaged(raw.lon_place(j), fmt::format("longitude {}", raw.lons[j]));
  std::size_t count = length;
  if (length > 1 && near(std::fabs(raw.lons.back() - raw.lons.front()), 360, raw.tolerance)) {
    --count;
    cut.extra = count;
    notes.push_back(fmt::format("the column at {0:g} degrees repeats the one at {1:g} and was left out",
                                raw.lons.back(), raw.lons.front()));
  }
  const auto place = [&](std::size_t j) { return longitude_from_0(raw.lons[j], raw.tolerance); };
  cut.columns.resize(count);
  for (std::size_t j = 0; j < count; ++j) cut.columns[j] = j;
  // Files of ascending longitudes are turned round a circle and not sorted, so that a wrong one is found where it stands.
  std::size_t first = 0;
  for (std::size_t j = 1; j < count; ++j)
    if (place(j) < place(first)) first = j;
  const bool westwards = count > 2 && place((first + 1) % count) > place((first + count - 1) % count);
  for (std::size_t j = 0; j < count; ++j)
    cut.columns[j] = westwards ? (first + count - j) % count : (first + j) % count;
  if (westwards) notes.push_back("the file's longitudes go westwards and were turned over");
  if (cut.columns.front() != 0 && !westwards)
    notes.push_back(
        fmt::format("the file's longitudes begin at {:g} degrees; they were taken from 0 to 360", raw.lons[0]));
  cut.first_longitude = place(cut.columns.front());
}

void check_coordinates(const Raw& raw, const SphereGrid& grid, const Cut& cut) {
  for (int i = 0; i < grid.rings; ++i) {
    const std::size_t at = cut.turned ? cut.skipped + std::size_t(grid.rings - 1 - i) : std::size_t(i);
    const double found = raw.lats[at], expected = grid.latitude_degrees(i);
    if (!near(found, expected, raw.tolerance))
      damaged(raw.lat_place(at), fmt::format("latitude {} where ring {} of the {} grid of {} rings lies at {} degrees; "
                                             "--grid can name another kind",
                                             found, i, name(grid.kind), grid.rings, expected));
  }
  for (int j = 0; j < grid.ring_length; ++j) {
    const std::size_t at = cut.columns[std::size_t(j)];
    const double found = longitude_from_0(raw.lons[at], raw.tolerance), expected = grid.longitude_degrees(j);
    if (!near(found, expected, raw.tolerance))
      damaged(
          raw.lon_place(at),
          fmt::format("longitude {} where point {} of a ring of {} lies at {} degrees; the points of a ring have equal "
                      "distances and go once round the sphere",
                      raw.lons[at], j, grid.ring_length, expected));
  }
}

// Whether the rings are the centres of equal cells from pole to pole.
bool cell_centred(const Raw& raw, std::size_t rings) {
  const bool north = raw.lats.front() >= raw.lats.back();
  for (std::size_t i = 0; i < rings; ++i) {
    const double expected = 90 - 180 * (double(i) + 0.5) / double(rings);
    if (!near(raw.lats[i], north ? expected : -expected, raw.tolerance)) return false;
  }
  return true;
}

// Values in the grid's order, finite, and what was left out compared with what it repeats.
void take_values(const Raw& raw, const Cut& cut, GridFile& file) {
  const SphereGrid& grid = file.grid;
  const auto rings = std::size_t(grid.rings);
  file.values.resize(raw.names.size() * grid.points());
  auto to = file.values.begin();
  for (std::size_t f = 0; f < raw.names.size(); ++f) {
    double largest = 0;
    for (std::size_t i = 0; i < rings; ++i) {
      const std::size_t row = cut.turned ? cut.skipped + rings - 1 - i : i;
      for (const std::size_t j : cut.columns) {
        const double value = raw.value(f, row, j);
        if (!std::isfinite(value))
          damaged(raw.value_place(f, row, j),
                  "a missing value, NaN or infinity: a transform needs every point; fill the gaps first");
        largest = std::max(largest, std::fabs(value));
        *to++ = value;
      }
    }
    for (std::size_t row = 0; cut.extra && row < rings; ++row) {
      const double last = raw.value(f, row + cut.skipped, *cut.extra), first = raw.value(f, row + cut.skipped, 0);
      if (!(std::fabs(last - first) <= repeat_tolerance * largest))
        damaged(raw.value_place(f, row + cut.skipped, *cut.extra),
                fmt::format("{} at {:g} degrees and {} at {:g}, which is the same place", last, raw.lons.back(), first,
                            raw.lons.front()));
    }
  }
}

// The kind of grid: what the user and the file say, put right where the coordinates leave no doubt.
GridKind kind_of(const Raw& raw, std::optional<GridKind> wanted, std::size_t rings, std::size_t length,
                 std::vector<std::string>& notes) {
  std::optional<GridKind> kind = wanted ? wanted : raw.kind;
  if (!kind && raw.either_dh) kind = length == rings ? GridKind::driscoll_healy_square : GridKind::driscoll_healy;
  const bool cells = cell_centred(raw, rings);
  if (!kind)
    throw Error(Fault::file_format, fmt::format("{}: the attribute grid is missing, so it is not known what grid this "
                                                "is; name it with --grid gl, cc, dh, dh1 or f1{}",
                                                raw.name, cells ? "; its rings are those of f1 (cell-centred)" : ""));
  if (!cells || rings < 2 || kind == GridKind::gauss_legendre || kind == GridKind::fejer) return *kind;
  notes.push_back(fmt::format("the rings are the centres of cells, which is not a {} grid: taken as f1", name(*kind)));
  return GridKind::fejer;
}

// The grid that the coordinates make, and its values.
GridFile build(Raw raw, std::optional<GridKind> wanted) {
  std::size_t rings = raw.lats.size();
  const std::size_t longest = raw.lons.size();
  if (rings < 1 || longest < 1 || rings > most_rings || longest > longest_ring)
    damaged(raw.name, fmt::format("{} latitudes and {} longitudes: at most {} and {} are possible", rings, longest,
                                  most_rings, longest_ring));
  if (raw.names.size() > std::size_t(most_fields))
    throw Error(Fault::too_large, fmt::format("{}: the file has {} fields; at most {} are possible", raw.name,
                                              raw.names.size(), most_fields));
  Cut cut;
  GridFile file;
  file.notes = std::move(raw.notes);
  cut.turned = raw.lats.front() < raw.lats.back();
  if (cut.turned) file.notes.push_back("the file's rings go from south to north and were turned over");
  order_columns(raw, cut, file.notes);
  const std::size_t length = cut.columns.size();
  const std::optional<GridKind> said = wanted ? wanted : raw.kind;
  const bool no_south_pole =
      raw.either_dh || said == GridKind::driscoll_healy || said == GridKind::driscoll_healy_square;
  if (no_south_pole && rings > 1 && near(cut.turned ? raw.lats.front() : raw.lats.back(), -90, raw.tolerance)) {
    --rings;
    cut.skipped = cut.turned;
    file.notes.push_back("the row at 90 S is not part of a dh grid and was left out");
  }
  const GridKind kind = kind_of(raw, wanted, rings, length, file.notes);
  try {
    file.grid = make_grid(kind, int(rings), int(length));
  } catch (const Error& error) {
    throw Error(Fault::file_format, fmt::format("{}: {}", raw.name, error.what()));
  }
  const double step = 360 / double(length);
  for (const double usual : {0.0, 0.5})
    if (near(cut.first_longitude, usual * step, raw.tolerance)) cut.first_longitude = usual * step;
  file.grid.shift = std::clamp(cut.first_longitude / step, 0.0, 0x1.fffffffffffffp-1);
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
  if (!raw.kind) damaged(place, fmt::format("grid is '{}'; there are gl, cc, dh, dh1 and f1", shown(word)));
}

bool is_latitude(std::string_view word) {
  return same_word(word, "lat") || same_word(word, "latitude") || same_word(word, "y");
}
bool is_longitude(std::string_view word) {
  return same_word(word, "lon") || same_word(word, "longitude") || same_word(word, "long") || same_word(word, "x");
}

GridFile read_csv_grid(const std::filesystem::path& path, std::optional<GridKind> kind) {
  const CsvTable table = read_csv(path);
  if (table.columns.size() < 3 || !is_latitude(table.columns[0]) || !is_longitude(table.columns[1]))
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
  if (!a || !a->is_text) damaged(netcdf.name, fmt::format("the global attribute {} is missing or not a text", key));
  return a->text;
}

// A coordinate, lat or lon: by its name, or by what CF says of it.
const NetcdfVariable& coordinate(const NetcdfFile& netcdf, bool (*named)(std::string_view), std::string_view standard,
                                 std::string_view units_begin) {
  const auto text_of_attribute = [](const NetcdfVariable& v, const char* key) {
    const NetcdfAttribute* a = attribute(v.attributes, key);
    return a && a->is_text ? std::string_view(a->text) : std::string_view();
  };
  const NetcdfVariable* found = nullptr;
  for (const NetcdfVariable& v : netcdf.variables)
    if (!found && v.read && v.dimensions.size() == 1 && named(v.name)) found = &v;
  for (const NetcdfVariable& v : netcdf.variables)
    if (!found && v.read && v.dimensions.size() == 1 &&
        (text_of_attribute(v, "standard_name") == standard || text_of_attribute(v, "units").starts_with(units_begin)))
      found = &v;
  if (!found)
    throw Error(
        Fault::file_format,
        fmt::format("{}: there is no coordinate of the {}, a variable of one dimension: a grid has lat(lat) and "
                    "lon(lon), or latitude and longitude, or y and x",
                    netcdf.name, standard));
  const NetcdfAttribute* units = attribute(found->attributes, "units");
  if (units && (!units->is_text || !units->text.starts_with("degree")))
    damaged(fmt::format("{}: variable {}", netcdf.name, shown(found->name)),
            fmt::format("units '{}' are not degrees", shown(units->text)));
  return *found;
}

// A field: a variable over both coordinates, its other dimensions of length 1.
struct NetcdfField {
  const NetcdfVariable* variable = nullptr;
  bool transposed = false; // (lon, lat)
};

std::vector<NetcdfField> fields_over(const NetcdfFile& netcdf, std::size_t lat, std::size_t lon,
                                     std::vector<std::string>& notes) {
  std::vector<const NetcdfVariable*> list;
  std::string longer;
  bool transposed = false;
  const auto place = [](const NetcdfVariable& v, std::size_t dimension) {
    return std::find(v.dimensions.begin(), v.dimensions.end(), dimension) - v.dimensions.begin();
  };
  std::map<std::string, bool> left_out;
  for (const NetcdfVariable& v : netcdf.variables) {
    const auto at_lat = place(v, lat), at_lon = place(v, lon), rank = std::ptrdiff_t(v.dimensions.size());
    if (lat == lon || at_lat == rank || at_lon == rank) continue;
    bool flat = true;
    for (const std::size_t d : v.dimensions)
      if (d != lat && d != lon) {
        const NetcdfDimension& other = netcdf.dimensions[d];
        if (other.length != 1) longer = fmt::format("{} has {} of {}", shown(v.name), other.length, shown(other.name));
        flat = flat && other.length == 1;
        if (other.length == 1) left_out[other.name] = true;
      }
    if (!flat || !v.read) continue;
    const NetcdfAttribute* is_unsigned = attribute(v.attributes, "_Unsigned");
    if (is_unsigned && is_unsigned->is_text && is_unsigned->text == "true" &&
        std::any_of(v.values.begin(), v.values.end(), [](double value) { return value < 0; }))
      throw Error(
          Fault::file_format,
          fmt::format(
              "{}: variable {} has unsigned numbers in a signed type (_Unsigned); write it again as short or float",
              netcdf.name, shown(v.name)));
    list.push_back(&v);
    if (attribute(v.attributes, "scale_factor") || attribute(v.attributes, "add_offset"))
      notes.push_back(fmt::format("variable {} is packed: scale_factor and add_offset were applied", shown(v.name)));
  }
  if (list.empty())
    throw Error(Fault::file_format,
                fmt::format("{}: there is no variable of numbers over latitude and longitude alone{}", netcdf.name,
                            longer.empty() ? "" : fmt::format("; {}: choose one of them first", longer)));
  sort_fields(list);
  std::vector<NetcdfField> fields;
  for (const NetcdfVariable* v : list) {
    fields.push_back({v, place(*v, lon) < place(*v, lat)});
    transposed = transposed || fields.back().transposed;
  }
  for (const auto& [dimension, there] : left_out)
    notes.push_back(fmt::format("the dimension {} of length 1 was left out", shown(dimension)));
  if (transposed) notes.push_back("the values are in the order (longitude, latitude) and were turned round");
  return fields;
}

GridFile read_netcdf_grid(const std::filesystem::path& path, std::optional<GridKind> kind) {
  const NetcdfFile netcdf = read_netcdf(path);
  if (netcdf.variable("degree") && netcdf.variable("order"))
    throw Error(Fault::file_format, fmt::format("{}: these are coefficients, not a grid; `cowgpu transform synthesise` "
                                                "makes a grid of them",
                                                netcdf.name));
  const NetcdfVariable& lat = coordinate(netcdf, is_latitude, "latitude", "degrees_north");
  const NetcdfVariable& lon = coordinate(netcdf, is_longitude, "longitude", "degrees_east");
  Raw raw;
  raw.name = netcdf.name;
  const std::vector<NetcdfField> fields = fields_over(netcdf, lat.dimensions[0], lon.dimensions[0], raw.notes);
  for (const NetcdfField& field : fields) raw.names.push_back(field.variable->name);
  raw.lats = lat.values;
  raw.lons = lon.values;
  if (lat.single || lon.single) raw.tolerance = single_tolerance;
  const std::size_t rings = lat.values.size(), length = lon.values.size();
  raw.value = [&, rings, length](std::size_t f, std::size_t i, std::size_t j) {
    return present_value(*fields[f].variable, fields[f].transposed ? j * rings + i : i * length + j);
  };
  raw.lat_place = [&](std::size_t i) {
    return fmt::format("{}: variable {}, value {}", netcdf.name, shown(lat.name), i);
  };
  raw.lon_place = [&](std::size_t j) {
    return fmt::format("{}: variable {}, value {}", netcdf.name, shown(lon.name), j);
  };
  raw.value_place = [&](std::size_t f, std::size_t i, std::size_t j) {
    return fmt::format("{}: variable {}, row {}, column {}", netcdf.name, shown(fields[f].variable->name),
                       fields[f].transposed ? j : i, fields[f].transposed ? i : j);
  };
  const NetcdfAttribute* word = attribute(netcdf.attributes, "grid");
  const bool ours = word && (!kind || (word->is_text && grid_kind_named(word->text))); // else --grid says what it is
  if (ours) {
    set_kind(raw, text_of(netcdf, "grid"), netcdf.name + ": global attributes");
  } else if (const NetcdfAttribute* theirs = attribute(fields[0].variable->attributes, "grid")) {
    raw.either_dh = theirs->text == "DH";
    if (theirs->text == "GLQ") raw.kind = GridKind::gauss_legendre;
  }
  GridFile file = build(std::move(raw), kind);
  if (!ours) return file;
  const std::string place = netcdf.name + ": global attributes";
  const NetcdfAttribute* lmax = attribute(netcdf.attributes, "lmax");
  if (!lmax || lmax->is_text) damaged(place, "lmax is missing or not a number");
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
  for (const GridKind kind : {GridKind::gauss_legendre, GridKind::clenshaw_curtis, GridKind::driscoll_healy,
                              GridKind::driscoll_healy_square, GridKind::fejer})
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

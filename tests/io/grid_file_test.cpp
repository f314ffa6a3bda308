#include "host/io/grid_file.hpp"
#include "host/io/netcdf.hpp"

#include "tests/support/fields.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <netcdf.h>

#include <cmath>
#include <limits>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

GridFile some_grid(GridKind kind, int lmax, int fields) {
  GridFile file;
  file.grid = make_grid(kind, lmax);
  file.lmax = lmax;
  file.convention = {Normalisation::four_pi, Phase::none};
  for (int f = 0; f < fields; ++f) file.names.push_back(f == 0 ? "height" : "field." + std::to_string(f));
  for (std::size_t i = 0; i < std::size_t(fields) * file.grid.points(); ++i)
    file.values.push_back(std::sin(double(i)) * std::pow(10.0, double(i % 40) - 20));
  return file;
}

void write(const GridFile& grid, const std::string& path) {
  AtomicFile file(path);
  write_grid(grid, file_format(path), file);
  file.commit();
}

void ok(int status) {
  INFO(nc_strerror(status));
  REQUIRE(status == NC_NOERR);
}

// A file as another program would write it, with netCDF-C itself.
struct Foreign {
  int mode = NC_NETCDF4;
  std::vector<double> lats, lons, values;
  nc_type type = NC_DOUBLE;
  const char *lat_name = "lat", *lon_name = "lon";
  std::string variable_grid, global_grid; // attributes, left out where empty
  std::string lat_units = "degrees_north";
  double fill = std::numeric_limits<double>::quiet_NaN();

  void write(const std::string& path) const {
    int nc = 0, dim[2] = {0, 0}, lat = 0, lon = 0, data = 0;
    ok(nc_create(path.c_str(), mode | NC_CLOBBER, &nc));
    ok(nc_def_dim(nc, lat_name, lats.size(), &dim[0]));
    ok(nc_def_dim(nc, lon_name, lons.size(), &dim[1]));
    ok(nc_def_var(nc, lat_name, NC_DOUBLE, 1, &dim[0], &lat));
    ok(nc_def_var(nc, lon_name, NC_DOUBLE, 1, &dim[1], &lon));
    ok(nc_put_att_text(nc, lat, "units", lat_units.size(), lat_units.c_str()));
    ok(nc_def_var(nc, "data", type, 2, dim, &data));
    if (!std::isnan(fill)) ok(nc_put_att_double(nc, data, "missing_value", NC_DOUBLE, 1, &fill));
    if (!variable_grid.empty()) ok(nc_put_att_text(nc, data, "grid", variable_grid.size(), variable_grid.c_str()));
    if (!global_grid.empty()) ok(nc_put_att_text(nc, NC_GLOBAL, "grid", global_grid.size(), global_grid.c_str()));
    ok(nc_enddef(nc));
    ok(nc_put_var_double(nc, lat, lats.data()));
    ok(nc_put_var_double(nc, lon, lons.data()));
    ok(nc_put_var_double(nc, data, values.data()));
    ok(nc_close(nc));
  }
};

// pyshtools' SHGrid.to_netcdf with extend=True: a column at 360 E and for DH a row at 90 S.
Foreign pyshtools(const GridFile& grid, bool extend) {
  Foreign f;
  const SphereGrid& g = grid.grid;
  const bool dh = g.kind == GridKind::driscoll_healy || g.kind == GridKind::driscoll_healy_square;
  f.variable_grid = dh ? "DH" : "GLQ";
  for (int i = 0; i < g.rings; ++i) f.lats.push_back(g.latitude_degrees(i));
  for (int j = 0; j < g.ring_length; ++j) f.lons.push_back(g.longitude_degrees(j));
  if (extend) f.lons.push_back(360);
  if (extend && dh) f.lats.push_back(-90);
  for (std::size_t i = 0; i < f.lats.size(); ++i)
    for (std::size_t j = 0; j < f.lons.size(); ++j) {
      const std::size_t ring = std::min(i, std::size_t(g.rings) - 1);
      f.values.push_back(grid.values[ring * std::size_t(g.ring_length) + j % std::size_t(g.ring_length)]);
    }
  return f;
}

} // namespace

TEST_CASE("grids of every kind read back the same from netCDF and CSV", "[grid-file]") {
  const TemporaryFolder folder;
  for (const GridKind kind : {GridKind::gauss_legendre, GridKind::clenshaw_curtis, GridKind::driscoll_healy,
                              GridKind::driscoll_healy_square, GridKind::fejer})
    for (const int lmax : {0, 1, 2, 7, 12})
      for (const int fields : {1, 3})
        for (const char* suffix : {"g.nc", "g.csv"}) {
          INFO(name(kind) << " " << lmax << " " << fields << " " << suffix);
          const GridFile grid = some_grid(kind, lmax, fields);
          write(grid, folder / suffix);
          const GridFile back = read_grid(folder / suffix);
          CHECK(back.grid.kind == kind);
          CHECK(back.grid.rings == grid.grid.rings);
          CHECK(back.grid.ring_length == grid.grid.ring_length);
          CHECK(back.grid.shift == grid.grid.shift);
          CHECK(back.lmax == lmax);
          CHECK(back.convention == grid.convention);
          CHECK(back.names == grid.names);
          CHECK(back.values == grid.values);
          CHECK(back.notes.empty());
        }
}

TEST_CASE("the same grid gives the same bytes", "[grid-file]") {
  const TemporaryFolder folder;
  write(some_grid(GridKind::driscoll_healy, 5, 2), folder / "a.nc");
  write(some_grid(GridKind::driscoll_healy, 5, 2), folder / "b.nc");
  CHECK(read_text(folder / "a.nc") == read_text(folder / "b.nc"));
}

TEST_CASE("the netCDF layout of grids is the one laid down", "[grid-file]") {
  const TemporaryFolder folder;
  GridFile grid = some_grid(GridKind::driscoll_healy, 1, 1);
  grid.names = {""};
  write(grid, folder / "g.nc");
  int nc = 0, count = 0, id = 0, rank = 0, dims[2] = {0, 0};
  ok(nc_open((folder / "g.nc").c_str(), NC_NOWRITE, &nc));
  ok(nc_inq_ndims(nc, &count));
  CHECK(count == 2);
  ok(nc_inq_nvars(nc, &count));
  CHECK(count == 3);
  const auto text = [&](int variable, const char* key) {
    std::size_t length = 0;
    ok(nc_inq_attlen(nc, variable, key, &length));
    std::string value(length, '\0');
    ok(nc_get_att_text(nc, variable, key, value.data()));
    return value;
  };
  std::size_t length = 0;
  ok(nc_inq_dimid(nc, "lat", &dims[0]));
  ok(nc_inq_dimlen(nc, dims[0], &length));
  CHECK(length == 4);
  ok(nc_inq_dimid(nc, "lon", &dims[1]));
  ok(nc_inq_dimlen(nc, dims[1], &length));
  CHECK(length == 8);
  std::vector<double> lat(4), lon(8), value(32);
  ok(nc_inq_varid(nc, "lat", &id));
  CHECK(text(id, "units") == "degrees_north");
  ok(nc_get_var_double(nc, id, lat.data()));
  CHECK(lat == std::vector<double>{90, 45, 0, -45});
  ok(nc_inq_varid(nc, "lon", &id));
  CHECK(text(id, "units") == "degrees_east");
  ok(nc_get_var_double(nc, id, lon.data()));
  CHECK(lon == std::vector<double>{0, 45, 90, 135, 180, 225, 270, 315});
  ok(nc_inq_varid(nc, "value", &id));
  nc_type type = NC_NAT;
  int found[2] = {-1, -1};
  ok(nc_inq_vartype(nc, id, &type));
  CHECK(type == NC_DOUBLE);
  ok(nc_inq_varndims(nc, id, &rank));
  REQUIRE(rank == 2);
  ok(nc_inq_vardimid(nc, id, found));
  CHECK((found[0] == dims[0] && found[1] == dims[1]));
  ok(nc_get_var_double(nc, id, value.data()));
  CHECK(value == grid.values);
  CHECK(text(NC_GLOBAL, "grid") == "dh");
  CHECK(text(NC_GLOBAL, "normalisation") == "4pi");
  CHECK(text(NC_GLOBAL, "phase") == "none");
  CHECK_THAT(text(NC_GLOBAL, "source"), StartsWith("cowgpu "));
  int lmax = -1;
  ok(nc_get_att_int(nc, NC_GLOBAL, "lmax", &lmax));
  CHECK(lmax == 1);
  ok(nc_close(nc));
  grid = some_grid(GridKind::gauss_legendre, 1, 2);
  grid.names = {"", ""};
  write(grid, folder / "two.nc");
  CHECK(read_grid(folder / "two.nc").names == std::vector<std::string>{"value_1", "value_2"});
}

TEST_CASE("the CSV layout of grids is the one laid down", "[grid-file]") {
  const TemporaryFolder folder;
  GridFile grid;
  grid.grid = make_grid(GridKind::driscoll_healy_square, 0);
  grid.names = {"value"};
  grid.values = {0.1, -2, 1e-300, 4};
  write(grid, folder / "g.csv");
  const std::string text = read_text(folder / "g.csv");
  CHECK_THAT(text, StartsWith("# cowgpu "));
  CHECK(text.substr(text.find('\n') + 1) ==
        "# grid dh1\n# lmax 0\n# normalisation orthonormal\n# phase cs\nlat,lon,value\n"
        "90,0,0.1\n90,180,-2\n0,0,1e-300\n0,180,4\n");
}

TEST_CASE("grids as pyshtools writes them are read, extended or not", "[grid-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "p.nc";
  for (const GridKind kind : {GridKind::gauss_legendre, GridKind::driscoll_healy, GridKind::driscoll_healy_square})
    for (const bool extend : {false, true})
      for (const int mode : {NC_NETCDF4, NC_64BIT_OFFSET, 0, NC_64BIT_DATA}) {
        INFO(name(kind) << " " << extend << " " << mode);
        GridFile grid = some_grid(kind, 4, 1);
        if (kind == GridKind::gauss_legendre) grid.grid = make_grid(kind, 5, 9); // 2 lmax + 1, as pyshtools has it
        Foreign foreign = pyshtools(grid, extend);
        foreign.mode = mode;
        foreign.write(path);
        const GridFile back = read_grid(path);
        CHECK(back.grid.kind == kind);
        CHECK(back.lmax == 4);
        grid.values.resize(grid.grid.points());
        CHECK(back.values == grid.values);
        CHECK(back.notes.size() == (!extend ? 0U : kind == GridKind::gauss_legendre ? 1U : 2U));
      }
}

TEST_CASE("a grid from south to north is turned over, and one without a name takes --grid's", "[grid-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "f.nc";
  for (const bool extend : {false, true}) {
    const GridFile grid = some_grid(GridKind::driscoll_healy, 3, 1);
    Foreign foreign = pyshtools(grid, extend);
    foreign.variable_grid.clear();
    const std::size_t length = foreign.lons.size(), rings = foreign.lats.size();
    std::vector<double> values;
    for (std::size_t i = rings; i-- > 0;)
      values.insert(values.end(), foreign.values.begin() + std::ptrdiff_t(i * length),
                    foreign.values.begin() + std::ptrdiff_t((i + 1) * length));
    foreign.values = values;
    std::reverse(foreign.lats.begin(), foreign.lats.end());
    foreign.write(path);
    CHECK_THAT(fault_of([&] { read_grid(path); }), StartsWith("file-format: ") && Contains("--grid"));
    const GridFile back = read_grid(path, GridKind::driscoll_healy);
    CHECK(back.values == grid.values);
    CHECK_THAT(back.notes.at(0), Contains("south to north"));
  }
}

TEST_CASE("netCDF files that hold no grid we can use are named errors", "[grid-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "f.nc";
  const GridFile grid = some_grid(GridKind::driscoll_healy, 3, 1);
  const Foreign good = pyshtools(grid, true);
  const auto refused = [&](const char* fault, const char* words, const auto& change) {
    Foreign bad = good;
    change(bad);
    bad.write(path);
    const std::string found = fault_of([&] { read_grid(path); });
    INFO(words);
    CHECK_THAT(found, StartsWith(fault) && Contains(words) && Contains(path));
  };
  const std::size_t length = good.lons.size();
  refused("file-syntax", "missing value", [](Foreign& f) { f.values[20] = std::nan(""); });
  refused("file-syntax", "row 0, column 3", [](Foreign& f) { f.values[3] = HUGE_VAL; });
  refused("file-syntax", "missing value", [](Foreign& f) { f.fill = f.values[7]; });
  refused("file-syntax", "at 360 degrees and", [&](Foreign& f) { f.values[2 * length - 1] += 1e19; });
  refused("file-syntax", "variable lat, value 2", [](Foreign& f) { f.lats[2] += 1e-5; });
  refused("file-syntax", "variable lon, value 3", [](Foreign& f) { f.lons[3] -= 1e-5; });
  refused("file-syntax", "variable lat", [](Foreign& f) { f.lats[1] = std::nan(""); });
  refused("file-syntax", "radians", [](Foreign& f) { f.lat_units = "radians"; });
  refused("file-format", "lat(lat)", [](Foreign& f) {
    f.lat_name = "ring";
    f.lat_units = "degrees";
  });
  refused("file-format", "grid", [](Foreign& f) { f.variable_grid = "HEALPIX"; });
  refused("file-syntax", "lmax", [](Foreign& f) { f.global_grid = "dh"; });
  refused("file-syntax", "there are gl, cc, dh, dh1 and f1", [](Foreign& f) { f.global_grid = "milk"; });
  refused("file-format", "rings", [&](Foreign& f) { // a dh grid has an even number
    f.lats.pop_back();
    f.lats.pop_back();
    f.values.resize(f.lats.size() * length);
  });
  Foreign in_floats = good;
  in_floats.type = NC_FLOAT;
  in_floats.write(path);
  CHECK(read_grid(path).values[5] == double(float(grid.values[5])));
}

TEST_CASE("CSV grids that are wrong are named errors with file and line", "[grid-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "g.csv";
  write(some_grid(GridKind::gauss_legendre, 2, 1), path);
  const std::string good = read_text(path);
  // Three rings of five points: lines 7 to 21.
  const std::string ring = good.substr(good.find("\n0,0,") + 1);
  struct Bad {
    const char* fault;
    int line;
    std::string text;
  };
  const std::vector<Bad> all = {
      {"file-truncated", 0, ""},
      {"file-truncated", 5, good.substr(0, good.find("lat,lon"))},
      {"file-truncated", 6, good.substr(0, good.find("height\n") + 7)},
      {"file-truncated", 20, good.substr(0, good.rfind('\n', good.size() - 2) + 1)},
      {"file-format", 6, replaced(good, "lat,lon,height", "lon,lat,height")},
      {"file-syntax", 7, replaced(good, "lat,lon,height", "lat,lon")},
      {"file-format", 6, replaced(good, "lat,lon,height", "lat,,height")},
      {"file-format", 1, "\x89HDF\r\n\x1a\n rubbish"},
      {"file-syntax", 2, replaced(good, "# grid gl", "# grid healpix")},
      {"file-syntax", 3, replaced(good, "# lmax 2", "# lmax 3")},
      {"file-syntax", 3, replaced(good, "# lmax 2", "# lmax -1")},
      {"file-syntax", 3, replaced(good, "# lmax 2", "# lmax two")},
      {"file-syntax", 5, replaced(good, "# lmax 2\n", "")},
      {"file-syntax", 5, replaced(good, "# phase none\n", "")},
      {"file-syntax", 5, replaced(good, "# normalisation 4pi\n", "")},
      {"file-syntax", 5, replaced(good, "# normalisation 4pi", "# normalisation 5pi")},
      {"file-syntax", 5, replaced(good, "# phase none", "# phase moon")},
      {"file-syntax", 12, replaced(good, "\n0,0,", "\n0,nan,")},
      {"file-syntax", 12, replaced(good, "\n0,0,", "\n0,0,inf,")},
      {"file-syntax", 12, replaced(good, "\n0,0,", "\n0,0,1e999,")},
      {"file-syntax", 12, replaced(good, "\n0,0,", "\n0,zero,")},
      {"file-syntax", 12, replaced(good, "\n0,0,", "\n0,")},
      {"file-syntax", 12, replaced(good, "\n0,0,", "\n0,0,0,")},
      {"file-syntax", 12, replaced(good, "\n0,0,", "\n\n0,0,")},
      {"file-syntax", 12, replaced(good, "\n0,0,", "\n# note\n0,0,")},
      {"file-syntax", 12, replaced(good, "\n0,0,", "\n0,,")},
      {"file-syntax", 13, replaced(good, "\n0,72,", "\n0,73,")},
      {"file-syntax", 13, replaced(good, "\n0,72,", "\n0.1,72,")},
      {"file-syntax", 0, replaced(good, "# grid gl", "# grid cc")},
      {"file-format", 0, replaced(good, "# grid gl", "# grid dh")},
      {"file-format", 0, replaced(good, "# grid gl\n", "")},
  };
  for (const Bad& bad : all) {
    write_text(path, bad.text);
    const std::string found = fault_of([&] { read_grid(path); });
    INFO(bad.text.substr(0, 200) << "\n" << found);
    CHECK_THAT(found, StartsWith(std::string(bad.fault) + ": " + path + ":"));
    if (bad.line) CHECK_THAT(found, Contains(":" + std::to_string(bad.line) + ": "));
  }
  std::string windows = "\xef\xbb\xbf";
  for (const char c : good) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  write_text(path, windows + "\r\n\r\n");
  CHECK(read_grid(path).values == some_grid(GridKind::gauss_legendre, 2, 1).values);
}

TEST_CASE("damaged netCDF grids are read or named errors, never a crash", "[grid-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "g.nc";
  write(some_grid(GridKind::driscoll_healy, 3, 1), path);
  std::vector<std::string> files = {read_text(path)};
  Foreign classic = pyshtools(some_grid(GridKind::driscoll_healy, 3, 1), true);
  classic.mode = NC_64BIT_OFFSET;
  classic.write(path);
  files.push_back(read_text(path));
  int errors = 0;
  for (const std::string& good : files)
    for (std::uint32_t seed = 0; seed < 150; ++seed) {
      write_text(path, damaged(good, seed));
      const std::string found = fault_of([&] { read_grid(path); });
      INFO(seed << ": " << found);
      const bool named = found.rfind("file-", 0) == 0 || found.rfind("too-large", 0) == 0;
      CHECK((found == "none" || named));
      errors += named;
    }
  CHECK(errors > 50);
  for (const char* text : {"", "CDF", "CDF\x01", "CDF\x02\xff\xff\xff\xff\xff", "\x89HDF\r\n\x1a\n", "milk"}) {
    write_text(path, text);
    CHECK_THAT(fault_of([&] { read_grid(path); }), StartsWith("file-format: " + path));
  }
}

TEST_CASE("names of fields that files cannot carry are replaced", "[grid-file]") {
  CHECK(field_names({"a", "b-1.x"}, 2, "value") == std::vector<std::string>{"a", "b-1.x"});
  for (const std::vector<std::string>& names : std::vector<std::vector<std::string>>{
           {"a", "a"}, {"a", ""}, {"a", "lat"}, {"a", "1b"}, {"a", "b,c"}, {"a", "b/c"}, {"a"}, {}})
    CHECK(field_names(names, 2, "value") == std::vector<std::string>{"value_1", "value_2"});
  CHECK(field_names({}, 1, "value") == std::vector<std::string>{"value"});
  CHECK_THAT(fault_of([] { file_format("map.tif"); }), StartsWith("bad-argument: "));
}

TEST_CASE("values that stand for none are known without and with their attributes", "[grid-file]") {
  NetcdfVariable v;
  v.values = {1, 9.9692099683868690e+36, -9999, 50};
  CHECK(present_value(v, 0) == 1);
  CHECK(std::isnan(present_value(v, 1))); // netCDF's own fill value
  CHECK(present_value(v, 2) == -9999);
  v.attributes.push_back({"valid_range", false, "", -100});
  CHECK(std::isnan(present_value(v, 2)));
  v.attributes.push_back({"valid_max", false, "", 49});
  CHECK(std::isnan(present_value(v, 3)));
  v.attributes = {{"_FillValue", false, "", 50}};
  CHECK(std::isnan(present_value(v, 3)));
  CHECK(present_value(v, 1) == 9.9692099683868690e+36);
}

// netCDF grids as other programs write them: names, origins and orders of their coordinates, packing, cell centres.
#include "host/backend.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/grid_file.hpp"
#include "host/spectrum/convert.hpp"
#include "tests/support/fields.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <netcdf.h>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

void ok(int status) {
  INFO(nc_strerror(status));
  REQUIRE(status == NC_NOERR);
}

// 1 + 2 cos(theta) + 3 sin(theta) cos(phi) + 0.7 sin(theta) sin(phi) + 0.5 P_2(cos(theta)).
double field(double lat, double lon) {
  const double z = std::sin(lat * std::numbers::pi / 180), s = std::cos(lat * std::numbers::pi / 180);
  const double phi = lon * std::numbers::pi / 180;
  return 1 + 2 * z + s * (3 * std::cos(phi) + 0.7 * std::sin(phi)) + 0.25 * (3 * z * z - 1);
}

struct Foreign {
  std::string lat_name = "lat", lon_name = "lon", standard_lat, standard_lon;
  std::vector<double> lats, lons;
  nc_type coordinate_type = NC_DOUBLE, type = NC_DOUBLE;
  int times = 0; // length of a dimension time before the others
  bool transposed = false;
  double scale = 1, offset = 0;
  double fill = std::nan("");
  int missing_at = -1;

  void write(const std::string& path) const {
    int nc = 0, time = 0, dims[2] = {0, 0}, lat = 0, lon = 0, data = 0;
    ok(nc_create(path.c_str(), NC_NETCDF4 | NC_CLOBBER, &nc));
    if (times) ok(nc_def_dim(nc, "time", std::size_t(times), &time));
    ok(nc_def_dim(nc, lat_name.c_str(), lats.size(), &dims[0]));
    ok(nc_def_dim(nc, lon_name.c_str(), lons.size(), &dims[1]));
    ok(nc_def_var(nc, lat_name.c_str(), coordinate_type, 1, &dims[0], &lat));
    ok(nc_def_var(nc, lon_name.c_str(), coordinate_type, 1, &dims[1], &lon));
    if (!standard_lat.empty()) ok(nc_put_att_text(nc, lat, "standard_name", standard_lat.size(), standard_lat.c_str()));
    if (!standard_lon.empty()) ok(nc_put_att_text(nc, lon, "standard_name", standard_lon.size(), standard_lon.c_str()));
    std::vector<int> order;
    if (times) order.push_back(time);
    order.push_back(dims[transposed]);
    order.push_back(dims[!transposed]);
    ok(nc_def_var(nc, "z", type, int(order.size()), order.data(), &data));
    if (scale != 1) ok(nc_put_att_double(nc, data, "scale_factor", NC_DOUBLE, 1, &scale));
    if (offset != 0) ok(nc_put_att_double(nc, data, "add_offset", NC_DOUBLE, 1, &offset));
    if (!std::isnan(fill)) ok(nc_put_att_double(nc, data, "_FillValue", type, 1, &fill));
    ok(nc_enddef(nc));
    ok(nc_put_var_double(nc, lat, lats.data()));
    ok(nc_put_var_double(nc, lon, lons.data()));
    std::vector<double> values;
    for (int t = 0; t < std::max(1, times); ++t)
      for (std::size_t i = 0; i < (transposed ? lons : lats).size(); ++i)
        for (std::size_t j = 0; j < (transposed ? lats : lons).size(); ++j) {
          const double value = transposed ? field(lats[j], lons[i]) : field(lats[i], lons[j]);
          values.push_back((value - offset) / scale);
          if (type != NC_DOUBLE && type != NC_FLOAT) values.back() = std::round(values.back());
        }
    if (missing_at >= 0) values[std::size_t(missing_at)] = fill;
    ok(nc_put_var_double(nc, data, values.data()));
    ok(nc_close(nc));
  }
};

// A dh grid of 8 rings, unless `cells`: then the centres of 8 x 16 cells.
Foreign equiangular(double first_lon, bool cells = false) {
  Foreign f;
  for (int i = 0; i < 8; ++i) f.lats.push_back(90 - 22.5 * (i + (cells ? 0.5 : 0)));
  for (int j = 0; j < 16; ++j) f.lons.push_back(first_lon + 22.5 * j);
  return f;
}

std::string all(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += note + "\n";
  return text;
}

double worst(const GridFile& grid, std::size_t field_at = 0) {
  double error = 0;
  for (int i = 0; i < grid.grid.rings; ++i)
    for (int j = 0; j < grid.grid.ring_length; ++j) {
      const double truth = field(grid.grid.latitude_degrees(i), grid.grid.longitude_degrees(j));
      const std::size_t at = std::size_t(i) * std::size_t(grid.grid.ring_length) + std::size_t(j);
      error = std::max(error, std::fabs(grid.values[field_at * grid.grid.points() + at] - truth));
    }
  return error;
}

// Largest error of the coefficients to degree 3, 4pi without phase.
double coefficient_error(const CoefficientSet& set) {
  REQUIRE(set.lmax == 3);
  std::vector<double> c(set.first.size()), s(set.first.size());
  c[set.index(0, 0, 0)] = 1;
  c[set.index(0, 1, 0)] = 2 / std::sqrt(3.0);
  c[set.index(0, 1, 1)] = std::sqrt(3.0);
  s[set.index(0, 1, 1)] = 0.7 / std::sqrt(3.0);
  c[set.index(0, 2, 0)] = 0.5 / std::sqrt(5.0);
  double error = 0;
  for (std::size_t i = 0; i < c.size(); ++i)
    error = std::max({error, std::fabs(set.first[i] - c[i]), std::fabs(set.second[i] - s[i])});
  return error;
}

} // namespace

TEST_CASE("the grids of the cases give their coefficients on both paths", "[grid-file][cli]") {
  const TemporaryFolder folder;
  for (const char* name : {"grid--cell-centred.nc", "grid--latitude-longitude-names.nc",
                           "grid--longitudes-from-minus-180.nc", "grid--time-dimension-of-one.nc"})
    for (const char* device : {"cpu", "auto"}) {
      const ProgramRun run =
          run_program({"transform", "analyse", std::string(COWGPU_CORPUS) + "/grids/" + name, folder / "c.csv",
                       "--grid", "dh", "--lmax", "3", "--normalisation", "4pi", "--phase", "none", "--device", device});
      INFO(name << "\n" << run.err << run.out);
      REQUIRE(run.exit_code == 0);
      CHECK(coefficient_error(read_coefficient_set(folder / "c.csv")) < 2e-14);
      if (std::string(name) == "grid--cell-centred.nc") CHECK_THAT(run.out, Contains("taken as f1"));
    }
}

TEST_CASE("coordinates are found by name in either case, or by what CF calls them", "[grid-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "f.nc";
  for (const auto& [lat, lon] : {std::pair("latitude", "longitude"), std::pair("Latitude", "LONGITUDE"),
                                 std::pair("y", "x"), std::pair("LAT", "Lon"), std::pair("rlat", "rlon")}) {
    Foreign f = equiangular(0);
    f.lat_name = lat;
    f.lon_name = lon;
    INFO(lat);
    if (std::string(lat) == "rlat") {
      f.write(path);
      CHECK_THAT(fault_of([&] { read_grid(path, GridKind::driscoll_healy); }),
                 StartsWith("file-format: ") && Contains("latitude and longitude"));
      f.standard_lat = "latitude";
      f.standard_lon = "longitude";
    }
    f.write(path);
    CHECK(worst(read_grid(path, GridKind::driscoll_healy)) < 1e-14);
  }
}

TEST_CASE("longitudes may begin anywhere and go either way, with the first repeated at the end", "[grid-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "f.nc";
  for (const double first : {-180.0, -90.0, 0.0, 22.5, 180.0, -360.0, -11.25, 5.0})
    for (const bool repeated : {false, true})
      for (const bool westwards : {false, true}) {
        Foreign f = equiangular(first);
        if (repeated) f.lons.push_back(first + 360);
        if (westwards) std::reverse(f.lons.begin(), f.lons.end());
        f.write(path);
        const GridFile grid = read_grid(path, GridKind::driscoll_healy);
        INFO(first << " " << repeated << " " << westwards << "\n" << all(grid.notes));
        CHECK(grid.grid.ring_length == 16);
        CHECK(worst(grid) < 1e-14);
        CHECK(grid.grid.shift == Approx(first == -11.25 ? 0.5 : first == 5 ? 5 / 22.5 : 0).margin(1e-15));
        CHECK((all(grid.notes).find("longitudes begin at") != std::string::npos) ==
              (!westwards && first != 0 && first != -360 && first != 5));
        CHECK((all(grid.notes).find("repeats") != std::string::npos) == repeated);
        CHECK((all(grid.notes).find("westwards") != std::string::npos) == westwards);
      }
  Foreign f = equiangular(-180);
  f.lons[3] += 1e-3;
  f.write(path);
  CHECK_THAT(fault_of([&] { read_grid(path, GridKind::driscoll_healy); }),
             StartsWith("file-syntax: ") && Contains("variable lon, value 3"));
}

TEST_CASE("a grid whose rings begin beside longitude 0 gives its coefficients and is written as it is",
          "[grid-file][transform]") {
  const TemporaryFolder folder;
  const std::string path = folder / "f.nc";
  for (const double first : {-11.25, 5.0}) {
    equiangular(first).write(path);
    const GridFile grid = read_grid(path, GridKind::driscoll_healy);
    const auto backend = make_cpu_backend();
    const auto transform = backend->sphere_transform(grid.grid, 3);
    SphereCoefficients found(3, 1);
    Monitor silent;
    transform->analyse(1, grid.values, found.values, silent);
    CHECK(coefficient_error(set_of(found, {Normalisation::four_pi, Phase::none})) < 2e-14);
    std::vector<double> back(grid.grid.points());
    transform->synthesise(1, found.values, back, silent);
    for (std::size_t i = 0; i < back.size(); ++i) REQUIRE(back[i] == Approx(grid.values[i]).margin(2e-14));
    for (const char* name : {"g.nc", "g.csv"}) {
      AtomicFile file(folder / name);
      write_grid(grid, file_format(folder / name), file);
      file.commit();
      const GridFile again = read_grid(folder / name);
      CHECK(again.values == grid.values);
      CHECK(again.grid.shift == Approx(grid.grid.shift).epsilon(1e-14));
      CHECK(again.notes.empty());
    }
  }
}

TEST_CASE("other dimensions of length 1 and the order (lon, lat) are seen to, longer ones are named", "[grid-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "f.nc";
  for (const int times : {0, 1})
    for (const bool transposed : {false, true}) {
      Foreign f = equiangular(0);
      f.times = times;
      f.transposed = transposed;
      f.write(path);
      const GridFile grid = read_grid(path, GridKind::driscoll_healy);
      CHECK(worst(grid) < 1e-14);
      CHECK((all(grid.notes).find("dimension time of length 1") != std::string::npos) == (times == 1));
      CHECK((all(grid.notes).find("(longitude, latitude)") != std::string::npos) == transposed);
    }
  Foreign f = equiangular(0);
  f.times = 3;
  f.write(path);
  CHECK_THAT(fault_of([&] { read_grid(path, GridKind::driscoll_healy); }),
             StartsWith("file-format: ") && Contains("z has 3 of time"));
}

TEST_CASE("packed values are unpacked, and missing ones refused by place", "[grid-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "f.nc";
  Foreign f = equiangular(0);
  f.type = NC_SHORT;
  f.scale = 1e-3;
  f.offset = 1.5;
  f.fill = -32768;
  f.write(path);
  const GridFile grid = read_grid(path, GridKind::driscoll_healy);
  CHECK(worst(grid) <= 0.5e-3 * (1 + 1e-9));
  CHECK(worst(grid) > 1e-4);
  CHECK_THAT(all(grid.notes), Contains("variable z is packed"));
  f.missing_at = 16 + 5;
  f.write(path);
  CHECK_THAT(fault_of([&] { read_grid(path, GridKind::driscoll_healy); }),
             StartsWith("file-syntax: ") && Contains("row 1, column 5: a missing value"));
}

TEST_CASE("cell-centred grids are f1, whatever they are called, from floats and in either order", "[grid-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "f.nc";
  for (const nc_type type : {NC_DOUBLE, NC_FLOAT})
    for (const double first : {11.25, -168.75, 0.0})
      for (const bool south : {false, true}) {
        Foreign f = equiangular(first, true);
        f.coordinate_type = type;
        if (south) std::reverse(f.lats.begin(), f.lats.end());
        f.write(path);
        CHECK_THAT(fault_of([&] { read_grid(path); }), StartsWith("file-format: ") && Contains("those of f1"));
        for (const GridKind kind : {GridKind::fejer, GridKind::driscoll_healy, GridKind::clenshaw_curtis}) {
          const GridFile grid = read_grid(path, kind);
          CHECK(grid.grid.kind == GridKind::fejer);
          CHECK(grid.lmax == 3);
          CHECK(grid.grid.shift == (first == 0 ? 0 : 0.5));
          CHECK(worst(grid) < 1e-14);
          CHECK((all(grid.notes).find("taken as f1") != std::string::npos) == (kind != GridKind::fejer));
        }
      }
  // A third of a degree is no float, and a thousand rings tell.
  Foreign f;
  for (int i = 0; i < 27; ++i) f.lats.push_back(90 - 180 * (i + 0.5) / 27);
  for (int j = 0; j < 54; ++j) f.lons.push_back(-180 + 360 * (j + 0.5) / 54);
  f.coordinate_type = NC_FLOAT;
  f.write(path);
  CHECK(worst(read_grid(path, GridKind::fejer)) < 1e-6);
  CHECK(read_grid(path, GridKind::fejer).lmax == 13);
}

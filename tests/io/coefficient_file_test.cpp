#include "host/io/coefficient_file.hpp"

#include "host/spectrum/convert.hpp"
#include "host/spectrum/roundtrip.hpp"
#include "tests/support/fields.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <fmt/format.h>
#include <netcdf.h>

#include <cmath>
#include <limits>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

CoefficientSet some_coefficients(int lmax, int fields, Convention convention = {}) {
  return set_of(random_coefficients(lmax, fields, 11), convention);
}

void write(const CoefficientSet& coefficients, const std::string& path) {
  AtomicFile file(path);
  write_coefficient_set(coefficients, coefficient_format(path), file);
  file.commit();
}

SphereCoefficients read_numbers(const std::string& path) {
  return field_coefficients(read_fields(path), path);
}

double largest_relative_difference(const SphereCoefficients& a, const SphereCoefficients& b) {
  REQUIRE(a.values.size() == b.values.size());
  double worst = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i)
    worst = std::max(worst, std::abs(b.values[i] - a.values[i]) / std::max(std::abs(a.values[i]), 1e-300));
  return worst;
}

void ok(int status) {
  INFO(nc_strerror(status));
  REQUIRE(status == NC_NOERR);
}

// A file as pyshtools' SHCoeffs.to_netcdf writes one, with netCDF-C itself.
struct Foreign {
  int mode = NC_NETCDF4;
  std::size_t degrees = 3, orders = 3;
  // c + vstack([s.T[1:], s.T[0]]) for C_00 ... C_22 = 1 ... 6, S_11 = 7, S_21 = 8, S_22 = 9.
  std::vector<double> values = {1, 7, 8, 2, 3, 9, 4, 5, 6};
  const char *degree = "degree", *order = "order", *name = "coeffs";
  std::string normalization = "4pi";
  int csphase = 1;
  bool errors = false, text_phase = false, second = false;
  std::vector<double> degree_values = {0, 1, 2};

  void write(const std::string& path) const {
    int nc = 0, dim[2] = {0, 0}, d = 0, o = 0, c = 0, e = 0, s = 0;
    ok(nc_create(path.c_str(), mode | NC_CLOBBER, &nc));
    ok(nc_def_dim(nc, degree, degrees, &dim[0]));
    ok(nc_def_dim(nc, order, orders, &dim[1]));
    ok(nc_def_var(nc, degree, mode == NC_NETCDF4 ? NC_INT64 : NC_INT, 1, &dim[0], &d));
    ok(nc_def_var(nc, order, mode == NC_NETCDF4 ? NC_INT64 : NC_INT, 1, &dim[1], &o));
    ok(nc_def_var(nc, name, NC_DOUBLE, 2, dim, &c));
    if (!normalization.empty())
      ok(nc_put_att_text(nc, c, "normalization", normalization.size(), normalization.c_str()));
    if (text_phase)
      ok(nc_put_att_text(nc, c, "csphase", 1, "1"));
    else if (csphase)
      ok(nc_put_att_int(nc, c, "csphase", NC_INT, 1, &csphase));
    if (errors) ok(nc_def_var(nc, "errors", NC_DOUBLE, 2, dim, &e));
    if (second) {
      const int other = -csphase;
      ok(nc_def_var(nc, "coeffs_2", NC_DOUBLE, 2, dim, &s));
      ok(nc_put_att_text(nc, s, "normalization", normalization.size(), normalization.c_str()));
      ok(nc_put_att_int(nc, s, "csphase", NC_INT, 1, &other));
    }
    ok(nc_enddef(nc));
    ok(nc_put_var_double(nc, d, degree_values.data()));
    std::vector<double> count(orders);
    for (std::size_t i = 0; i < orders; ++i) count[i] = double(i);
    ok(nc_put_var_double(nc, o, count.data()));
    ok(nc_put_var_double(nc, c, values.data()));
    ok(nc_close(nc));
  }
};

// The text of an attribute, a NUL for an empty one taken off.
std::string text_attribute(int nc, int variable, const char* key) {
  std::size_t length = 0;
  ok(nc_inq_attlen(nc, variable, key, &length));
  std::string value(length, '\0');
  ok(nc_get_att_text(nc, variable, key, value.data()));
  return value.substr(0, value.find('\0'));
}

} // namespace

TEST_CASE("the netCDF layout of coefficients is pyshtools', number by number", "[coefficient-file]") {
  const TemporaryFolder folder;
  CoefficientSet real(2, 1);
  real.convention = {Normalisation::four_pi, Phase::none};
  real.first[real.index(0, 0, 0)] = 1;
  real.first[real.index(0, 1, 0)] = 2;
  real.first[real.index(0, 1, 1)] = 3;
  real.first[real.index(0, 2, 0)] = 4;
  real.first[real.index(0, 2, 1)] = 5;
  real.first[real.index(0, 2, 2)] = 6;
  real.second[real.index(0, 1, 1)] = 7;
  real.second[real.index(0, 2, 1)] = 8;
  real.second[real.index(0, 2, 2)] = 9;
  write(real, folder / "c.nc");

  int nc = 0, count = 0, id = 0, dims[2] = {-1, -1}, found[2] = {-2, -2};
  ok(nc_open((folder / "c.nc").c_str(), NC_NOWRITE, &nc));
  int format = 0;
  ok(nc_inq_format(nc, &format));
  CHECK(format == NC_FORMAT_NETCDF4);
  ok(nc_inq_ndims(nc, &count));
  CHECK(count == 2);
  ok(nc_inq_nvars(nc, &count));
  CHECK(count == 3);
  ok(nc_inq_dimid(nc, "degree", &dims[0]));
  ok(nc_inq_dimid(nc, "order", &dims[1]));
  for (const int d : dims) {
    std::size_t length = 0;
    ok(nc_inq_dimlen(nc, d, &length));
    CHECK(length == 3);
  }
  for (const char* key : {"degree", "order"}) {
    nc_type type = NC_NAT;
    std::vector<long long> numbers(3);
    ok(nc_inq_varid(nc, key, &id));
    ok(nc_inq_vartype(nc, id, &type));
    CHECK(type == NC_INT64);
    ok(nc_get_var_longlong(nc, id, numbers.data()));
    CHECK(numbers == std::vector<long long>{0, 1, 2});
  }
  nc_type type = NC_NAT;
  ok(nc_inq_varid(nc, "coeffs", &id));
  ok(nc_inq_vartype(nc, id, &type));
  CHECK(type == NC_DOUBLE);
  ok(nc_inq_varndims(nc, id, &count));
  REQUIRE(count == 2);
  ok(nc_inq_vardimid(nc, id, found));
  CHECK((found[0] == dims[0] && found[1] == dims[1]));
  CHECK(text_attribute(nc, id, "title").empty());
  CHECK_THAT(text_attribute(nc, id, "description"), StartsWith("cowgpu "));
  CHECK(text_attribute(nc, id, "normalization") == "4pi");
  long long phase = 0;
  ok(nc_inq_atttype(nc, id, "csphase", &type));
  CHECK(type == NC_INT64);
  ok(nc_get_att_longlong(nc, id, "csphase", &phase));
  CHECK(phase == 1);
  double fill = 0;
  ok(nc_get_att_double(nc, id, "_FillValue", &fill));
  CHECK(std::isnan(fill));
  std::vector<double> matrix(9);
  ok(nc_get_var_double(nc, id, matrix.data()));
  const std::vector<double> expected = {1, 7, 8,  // C_00 S_11 S_21
                                        2, 3, 9,  // C_10 C_11 S_22
                                        4, 5, 6}; // C_20 C_21 C_22
  for (std::size_t i = 0; i < 9; ++i) CHECK(std::fabs(matrix[i] - expected[i]) <= 4e-16 * expected[i]);
  ok(nc_close(nc));

  write(some_coefficients(1, 2), folder / "two.nc");
  ok(nc_open((folder / "two.nc").c_str(), NC_NOWRITE, &nc));
  for (const char* key : {"coeffs_1", "coeffs_2"}) {
    ok(nc_inq_varid(nc, key, &id));
    CHECK(text_attribute(nc, id, "normalization") == "ortho");
    ok(nc_get_att_longlong(nc, id, "csphase", &phase));
    CHECK(phase == -1);
  }
  ok(nc_close(nc));
}

TEST_CASE("coefficients as pyshtools writes them are read in every netCDF format", "[coefficient-file]") {
  const TemporaryFolder folder;
  for (const int mode : {NC_NETCDF4, NC_64BIT_OFFSET, 0, NC_64BIT_DATA})
    for (const bool errors : {false, true}) {
      Foreign foreign;
      foreign.mode = mode;
      foreign.errors = errors;
      foreign.write(folder / "p.nc");
      const CoefficientSet back = read_fields(folder / "p.nc");
      CHECK(back.convention == Convention{Normalisation::four_pi, Phase::none});
      const CoefficientSet real = set_of(field_coefficients(back, "p.nc"), back.convention);
      CHECK(real.first[real.index(0, 2, 1)] == Approx(5).epsilon(1e-15));
      CHECK(real.second[real.index(0, 1, 1)] == Approx(7).epsilon(1e-15));
      CHECK(real.second[real.index(0, 2, 1)] == Approx(8).epsilon(1e-15));
      CHECK(real.second[real.index(0, 2, 2)] == Approx(9).epsilon(1e-15));
      CHECK(back.notes.size() == (errors ? 1U : 0U));
    }
}

TEST_CASE("coefficients read back from netCDF and CSV in every convention", "[coefficient-file]") {
  const TemporaryFolder folder;
  for (const auto n :
       {Normalisation::orthonormal, Normalisation::four_pi, Normalisation::schmidt, Normalisation::unnormalised})
    for (const auto p : {Phase::condon_shortley, Phase::none})
      for (const int lmax : {0, 1, 2, 7, 31})
        for (const int fields : {1, 12})
          for (const char* suffix : {"c.nc", "c.csv"}) {
            INFO(name(n) << " " << name(p) << " " << lmax << " " << fields << " " << suffix);
            write(some_coefficients(lmax, fields, {n, p}), folder / suffix);
            const CoefficientSet back = read_fields(folder / suffix);
            CHECK(back.convention == Convention{n, p});
            CHECK(back.fields == fields);
            CHECK(back.names.size() == std::size_t(fields));
            CHECK(largest_relative_difference(random_coefficients(lmax, fields, 11),
                                              field_coefficients(back, suffix)) <= 1e-15);
          }
}

TEST_CASE("names of fields survive in netCDF", "[coefficient-file]") {
  const TemporaryFolder folder;
  CoefficientSet file = some_coefficients(3, 2);
  file.names = {"height of the surface over its mean", ""};
  write(file, folder / "c.nc");
  CHECK(read_fields(folder / "c.nc").names == file.names);
}

TEST_CASE("the CSV layout of coefficients is the one laid down", "[coefficient-file]") {
  const TemporaryFolder folder;
  CoefficientSet file(1, 1);
  file.first[file.index(0, 0, 0)] = 0.1;
  file.first[file.index(0, 1, 0)] = -2;
  write(file, folder / "c.csv");
  const std::string text = read_text(folder / "c.csv");
  CHECK_THAT(text, StartsWith("# cowgpu "));
  CHECK(text.substr(text.find('\n') + 1) ==
        "# lmax 1\n# normalisation orthonormal\n# phase cs\nl,m,C,S\n0,0,0.1,0\n1,0,-2,0\n1,1,0,0\n");
}

TEST_CASE("netCDF files that hold no coefficients we can use are named errors", "[coefficient-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "c.nc";
  const auto refused = [&](const char* fault, const char* words, const auto& change) {
    Foreign bad;
    change(bad);
    bad.write(path);
    INFO(words);
    CHECK_THAT(fault_of([&] { read_numbers(path); }), StartsWith(fault) && Contains(words) && Contains(path));
  };
  refused("file-syntax", "normalization is missing", [](Foreign& f) { f.normalization.clear(); });
  refused("file-syntax", "must be ortho", [](Foreign& f) { f.normalization = "5pi"; });
  refused("file-syntax", "csphase is missing", [](Foreign& f) { f.csphase = 0; });
  refused("file-syntax", "csphase is 2", [](Foreign& f) { f.csphase = 2; });
  refused("file-syntax", "csphase is missing", [](Foreign& f) { f.text_phase = true; });
  refused("file-syntax", "row 1, column 2", [](Foreign& f) { f.values[5] = std::nan(""); });
  refused("file-syntax", "variable degree", [](Foreign& f) { f.degree_values[1] = 3; });
  refused("file-format", "(degree, order)", [](Foreign& f) { f.degree = "l"; });
  refused("file-format", "another convention", [](Foreign& f) { f.second = true; });
  refused("file-format", "lmax + 1", [](Foreign& f) {
    f.orders = 2;
    f.values.resize(6);
  });
  refused("file-format", "(degree, order)", [](Foreign& f) { f.name = "errors"; });
  refused("file-format", "fits no double", [](Foreign& f) { f.values[3] = std::numeric_limits<double>::max(); });
}

TEST_CASE("CSV coefficients that are wrong are named errors with file and line", "[coefficient-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "c.csv";
  const std::string good = "# lmax 2\n# normalisation schmidt\n# phase "
                           "none\nl,m,C,S\n0,0,1,0\n1,0,2,0\n1,1,3,4\n2,0,5,0\n2,1,6,7\n2,2,8,9\n";
  write_text(path, good);
  REQUIRE(read_fields(path).lmax == 2);
  struct Bad {
    const char* fault;
    int line;
    std::string text;
  };
  const std::vector<Bad> all = {
      {"file-truncated", 10, replaced(good, "2,2,8,9\n", "")},
      {"file-truncated", 11, replaced(good, "# lmax 2", "# lmax 8192")},
      {"file-truncated", 5, good.substr(0, good.find("0,0,1"))},
      {"file-truncated", 3, good.substr(0, good.find("l,m,C"))},
      {"file-syntax", 11, good + "3,0,1,0\n"},
      {"file-syntax", 6, replaced(good, "1,0,2,0\n", "1,1,2,0\n")},
      {"file-syntax", 6, replaced(good, "1,0,2,0\n", "1,0,2,1\n")},
      {"file-syntax", 6, replaced(good, "1,0,2,0\n", "1,0,nan,0\n")},
      {"file-syntax", 6, replaced(good, "1,0,2,0\n", "1,0,2\n")},
      {"file-syntax", 6, replaced(good, "1,0,2,0\n", "1,0,2,0,0\n")},
      {"file-syntax", 4, replaced(good, "# lmax 2\n", "#\n")},
      {"file-syntax", 1, replaced(good, "# lmax 2\n", "# lmax 2.5\n")},
      {"file-syntax", 1, replaced(good, "# lmax 2\n", "# lmax 8193\n")},
      {"file-syntax", 4, replaced(good, "# normalisation schmidt\n", "#\n")},
      {"file-syntax", 2, replaced(good, "schmidt", "schmitt")},
      {"file-syntax", 3, replaced(good, "# phase none", "# phase off")},
      {"file-syntax", 5, replaced(good, "l,m,C,S", "l,m,C")},
      {"file-format", 4, replaced(good, "l,m,C,S", "l,m,S,C")},
      {"file-format", 4, replaced(good, "l,m,C,S", "lat,lon,a,b")},
  };
  for (const Bad& bad : all) {
    write_text(path, bad.text);
    const std::string found = fault_of([&] { read_numbers(path); });
    INFO(bad.text << "\n" << found);
    CHECK_THAT(found, StartsWith(fmt::format("{}: {}:{}: ", bad.fault, path, bad.line)));
  }
}

TEST_CASE("an expansion in JSON that is wrong is a named error", "[coefficient-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "e.json";
  const std::string good =
      R"({"schema": "cowgpu.result.v1", "expansions": {"mass": {"lmax": 1, "reference_radius": 2.5,)"
      R"( "normalisation": "orthonormal", "condon_shortley": true, "coefficients": [[0, 0, 1, 0], [1, 0, 2, 0],)"
      "\n[1, 1, 3, 4.5]]}}}";
  write_text(path, good);
  const CoefficientSet file = read_fields(path);
  CHECK(field_coefficients(file, path).at(0, 1, 1) == std::complex<double>(3, 4.5));
  CHECK_THAT(file.notes.at(0), Contains("R = 2.5"));
  const std::vector<std::string> all = {
      "",
      "[]",
      "3",
      "{",
      "null",
      "{\"schema\": 1}",
      replaced(good, "cowgpu.result.v1", "cowgpu.result.v9"),
      replaced(good, "\"mass\"", "\"milk\""),
      replaced(good, "\"lmax\": 1", "\"lmax\": 2"),
      replaced(good, "\"lmax\": 1", "\"lmax\": -1"),
      replaced(good, "\"lmax\": 1", "\"lmax\": 1e99"),
      replaced(good, "\"lmax\": 1", "\"lmax\": 99999999999"),
      replaced(good, "\"lmax\": 1", "\"lmax\": \"1\""),
      replaced(good, "orthonormal", "4pi"),
      replaced(good, "true", "false"),
      replaced(good, "[0, 0, 1, 0]", "[0, 0, 1]"),
      replaced(good, "[0, 0, 1, 0]", "[1, 0, 1, 0]"),
      replaced(good, "[0, 0, 1, 0]", "[0, 0, null, 0]"),
      replaced(good, "[0, 0, 1, 0]", "[0, 0, 1e999, 0]"),
      replaced(good, "[0, 0, 1, 0]", "7"),
      replaced(good, "2.5,", "\"far\","),
      std::string(100000, '['),
  };
  for (const std::string& text : all) {
    write_text(path, text);
    const std::string found = fault_of([&] { read_numbers(path); });
    INFO(text.substr(0, 200) << "\n" << found);
    CHECK_THAT(found, StartsWith("file-") && Contains(path));
  }
  for (std::size_t length = 0; length < good.size(); ++length) {
    write_text(path, good.substr(0, length));
    CHECK_THAT(fault_of([&] { read_numbers(path); }), StartsWith("file-syntax: "));
  }
}

TEST_CASE("damaged netCDF coefficients are read or named errors, never a crash", "[coefficient-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "c.nc";
  write(some_coefficients(4, 2), path);
  std::vector<std::string> files = {read_text(path)};
  Foreign classic;
  classic.mode = 0;
  classic.write(path);
  files.push_back(read_text(path));
  int errors = 0;
  for (const std::string& good : files)
    for (std::uint32_t seed = 0; seed < 150; ++seed) {
      write_text(path, damaged(good, seed));
      const std::string found = fault_of([&] { read_numbers(path); });
      INFO(seed << ": " << found);
      const bool named = found.rfind("file-", 0) == 0 || found.rfind("too-large", 0) == 0;
      CHECK((found == "none" || named));
      errors += named;
    }
  CHECK(errors > 50);
}

TEST_CASE("every prefix and many damaged copies of our JSON and complex CSV are read or named errors",
          "[coefficient-file]") {
  const TemporaryFolder folder;
  CoefficientSet set = set_of(random_coefficients(3, 1, 11), {});
  set.kind = CoefficientKind::multipoles;
  set.form = Form::complex;
  set.reference_radius = 2;
  set.origin = Vec3(1, 2, 3);
  set.provenance = {"cowgpu", "now", "cowgpu expand", "cow", "0f", "cowgpu convert"};
  set.remarks = {{"rotation", "none"}};
  for (const char* suffix : {"c.json", "c.csv"}) {
    const std::string path = folder / suffix;
    AtomicFile file(path);
    write_coefficient_set(set, coefficient_format(path), file);
    file.commit();
    const std::string good = read_text(path);
    REQUIRE(read_coefficient_set(path).first == set.first);
    int read = 0;
    for (std::size_t length = 0; length < good.size(); ++length) {
      write_text(path, good.substr(0, length));
      const std::string found = fault_of([&] { read_coefficient_set(path); });
      INFO(suffix << " " << length << ": " << found);
      CHECK((found == "none" || found.rfind("file-", 0) == 0));
      read += found == "none";
    }
    CHECK(read <= 25); // a CSV's last number, digit by digit
    for (std::uint32_t seed = 0; seed < 1000; ++seed) {
      write_text(path, damaged(good, seed));
      const std::string found = fault_of([&] { read_coefficient_set(path); });
      INFO(suffix << " " << seed << ": " << found);
      CHECK((found == "none" || found.rfind("file-", 0) == 0));
    }
  }
}

TEST_CASE("coefficients of our JSON that contradict themselves are named errors", "[coefficient-file]") {
  const TemporaryFolder folder;
  const std::string path = folder / "c.json";
  const std::string good =
      R"({"schema": "cowgpu.coefficients.v1", "kind": "potential", "form": "real", "lmax": 1, "fields": ["v"],)"
      R"( "units": ["m"], "normalisation": "4pi", "phase": "none", "reference_radius": 2, "gm": 3, "mass": 4,)"
      R"( "origin": [1, 2, 3], "provenance": {"mesh": "cow"}, "remarks": {"a": "b"},)"
      R"( "coefficients": [[0, 0, 1, 0], [1, 0, 2, 0], [1, 1, 3, 4.5]]})";
  write_text(path, good);
  const CoefficientSet set = read_coefficient_set(path);
  CHECK(set.second[set.index(0, 1, 1)] == 4.5);
  CHECK(set.gm == 3);
  const std::vector<std::string> all = {
      replaced(good, "cowgpu.coefficients.v1", "cowgpu.coefficients.v2"),
      replaced(good, "\"potential\"", "\"milk\""),
      replaced(good, "\"potential\"", "7"),
      replaced(good, "\"kind\"", "\"sort\""),
      replaced(good, "\"form\"", "\"shape\""),
      replaced(good, "\"real\"", "\"unreal\""),
      replaced(good, "\"4pi\"", "\"5pi\""),
      replaced(good, "\"phase\"", "\"face\""),
      replaced(good, "\"none\"", "\"some\""),
      replaced(good, "\"reference_radius\": 2", "\"reference_radius\": 0"),
      replaced(good, "\"reference_radius\": 2", "\"reference_radius\": \"2\""),
      replaced(good, "\"reference_radius\": 2, ", ""),
      replaced(good, "[1, 2, 3]", "[1, 2]"),
      replaced(good, "[1, 2, 3]", "[1, 2, \"3\"]"),
      replaced(good, "[\"v\"]", "[]"),
      replaced(good, "[\"v\"]", "[\"v\", \"w\"]"),
      replaced(good, "[\"v\"]", "\"v\""),
      replaced(good, "[\"m\"]", "[\"m\", \"m\"]"),
      replaced(good, "{\"mesh\": \"cow\"}", "[]"),
      replaced(good, "{\"mesh\": \"cow\"}", "{\"mesh\": 1}"),
      replaced(good, "{\"a\": \"b\"}", "{\"a\": 1}"),
      replaced(good, "{\"a\": \"b\"}", "7"),
      replaced(good, "[1, 1, 3, 4.5]", "[1, 1, 3]"),
      replaced(good, "[1, 0, 2, 0]", "[1, 0, 2, 1]"),
  };
  for (const std::string& text : all) {
    write_text(path, text);
    const std::string found = fault_of([&] { read_coefficient_set(path); });
    INFO(text << "\n" << found);
    CHECK_THAT(found, StartsWith("file-") && Contains(path));
  }
}

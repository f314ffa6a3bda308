// Gravity tables of the Planetary Data System and of SHTOOLS as people have them, in every command that reads coefficients.
#include "host/io/coefficient_content.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/length_unit.hpp"
#include "host/io/shtools_text.hpp"
#include "tests/support/fields.hpp"
#include "tests/support/gravity_model.hpp"
#include "tests/support/reader_checks.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

const std::string folder_of_cases = std::string(COWGPU_CORPUS) + "/coefficients/";

std::string notes_of(const CoefficientSet& set) {
  std::string notes;
  for (const std::string& note : set.notes) notes += note + "\n";
  return notes;
}

// What all the tables of the cases hold.
void check_field(const CoefficientSet& set) {
  INFO(notes_of(set));
  REQUIRE(set.lmax == 2);
  CHECK(set.first == [&] {
    std::vector<double> c(6);
    c[set.index(0, 0, 0)] = 1;
    c[set.index(0, 2, 0)] = -4.84e-4;
    c[set.index(0, 2, 1)] = -2e-10;
    c[set.index(0, 2, 2)] = 2.4e-6;
    return c;
  }());
  CHECK(set.second == [&] {
    std::vector<double> s(6);
    s[set.index(0, 2, 1)] = 1.4e-9;
    s[set.index(0, 2, 2)] = -1.4e-6;
    return s;
  }());
}

CoefficientSet parse(const std::string& text, std::optional<double> metres = {}) {
  return parse_shtools_text(text, "t.tab", metres);
}

std::string fault(const std::string& text) {
  return fault_of([&] { parse(text); });
}

const std::string rows = "2, 0, -4.84e-4, 0\n2, 1, -2e-10, 1.4e-9\n2, 2, 2.4e-6, -1.4e-6\n";

double first_potential(const std::vector<std::string>& arguments) {
  const ProgramRun run = run_program(arguments);
  INFO(run.err << run.out);
  REQUIRE(run.exit_code == 0);
  return nlohmann::json::parse(run.out).at("potential").get<double>();
}

} // namespace

TEST_CASE("the tables of the cases hold their field, whatever stands around it", "[gravity-table]") {
  const CoefficientSet pds = read_coefficient_set(folder_of_cases + "shadr--pds-eight-value-header.sh", "", 1000.0);
  check_field(pds);
  CHECK(pds.kind == CoefficientKind::potential);
  CHECK(pds.reference_radius == 1738e3);
  CHECK(pds.gm == Approx(4902.800222e9).epsilon(1e-15));
  CHECK(pds.convention == Convention{Normalisation::four_pi, Phase::none});
  CHECK_THAT(notes_of(pds), Contains("errors") && Contains("C_00 = 1") && Contains("normalised"));
  const CoefficientSet text = read_coefficient_set(folder_of_cases + "shadr--text-lines-above.sh");
  check_field(text);
  CHECK(text.kind == CoefficientKind::field);
  CHECK_THAT(notes_of(text), Contains("2 lines of text were passed over, the first is line 1: 'Coefficients of"));
  const CoefficientSet dov = read_coefficient_set(folder_of_cases + "shadr--degree-order-value.sh");
  check_field(dov);
  CHECK_THAT(notes_of(dov), Contains("order -m"));
  const std::string two = fault_of([&] { read_coefficient_set(folder_of_cases + "shadr--two-value-header.sh"); });
  CHECK_THAT(two, StartsWith("file-format: ") && Contains(":1: a header of 2 values") && Contains("of 4 ") &&
                      Contains("to 8 "));
}

TEST_CASE("headers of four to eight values, rows from degree 2 on, in any order", "[gravity-table]") {
  std::string header = "0.1738D+04, 0.4902800222E+04, 0.1E-03, 2";
  for (const char* more : {"", ", 2", ", 1", ", 0.0", ", 0.0"}) {
    header += more;
    check_field(parse(header + "\n" + rows));
  }
  check_field(parse(header + "\n2 2 2.4e-6 -1.4e-6 1 1\n2 0 -4.84e-4 0 1 1\n2 1 -2e-10 1.4e-9 1 1\n"));
  check_field(parse("# comment\n\n  model of nothing\nR GM\n" + header + "\r\n\n l m C S\n" + rows + "END\n"));
  // Whole numbers: the row comes again, and its lmax is right.
  const CoefficientSet whole = parse("1 1 0 2\n" + rows + "1 1 0 0\n");
  check_field(whole);
  CHECK(whole.gm == 1);
  CHECK(parse("1 1 0 2\n" + rows).kind == CoefficientKind::field);
  CHECK(parse("1738 4902 0 2\n" + rows).kind == CoefficientKind::potential);
  // Unnormalised, as the sixth value says; a reference meridian; C_00 said to be 0.
  const CoefficientSet other = parse("1738.0 4902.8 0 2 2 0 10 0\n0 0 0 0\n" + rows);
  CHECK(other.convention.normalisation == Normalisation::unnormalised);
  CHECK(other.first[0] == 1);
  CHECK_THAT(notes_of(other), Contains("longitude and latitude, 10 and 0") && Contains("C_00 is 0"));
  // Errors of rows of negative orders; one without its C.
  const CoefficientSet dov =
      parse("2 -2 -1.4e-6 1\n2 0 -4.84e-4 1\n2 1 -2e-10 1\n2 -1 1.4e-9 1\n0 0 1 1\n2 2 2.4e-6 1\n");
  check_field(dov);
  CHECK_THAT(notes_of(parse("0 0 1\n1 -1 3\n1 0 0\n")), Contains("1 value C or S without the other"));
}

TEST_CASE("tables that are wrong are refused by line, and say what is known", "[gravity-table]") {
  const std::string header = "1738.0, 4902.8, 1e-4, 2\n";
  CHECK_THAT(fault("6371200.0\n" + rows), StartsWith("file-format: t.tab:1: a header of 1 value,"));
  CHECK_THAT(fault("6371200.0, 2\n" + rows),
             StartsWith("file-format: t.tab:1: a header of 2 values,") && Contains("magnetic"));
  CHECK_THAT(fault("1738.0 4902.8 2\n" + rows), StartsWith("file-format: t.tab:1: a header of 3 values,"));
  CHECK_THAT(fault("1738.0 1 1 2 2 1 0 0 0\n" + rows), StartsWith("file-format: t.tab:1: a header of 9 values,"));
  CHECK_THAT(fault(header + header + rows), StartsWith("file-syntax: t.tab:2: a second header; line 1"));
  CHECK_THAT(fault("1738.0, nan, 1e-4, 2\n" + rows), StartsWith("file-syntax: t.tab:1: ") || Contains("second"));
  CHECK_THAT(fault("1738.0, 1, x, 2\n" + rows),
             StartsWith("file-syntax: t.tab:1: a number expected; 'x' is not a number"));
  CHECK_THAT(fault("-1.5, 1, 1, 2\n" + rows), StartsWith("file-syntax: t.tab:1: r0 must be above 0"));
  CHECK_THAT(fault("1738.0, 1, 1, 2.5\n" + rows), StartsWith("file-syntax: t.tab:1: lmax is 2.5"));
  CHECK_THAT(fault("1738.0, 1, 1, 2, 2, 3\n" + rows), StartsWith("file-format: t.tab:1: the sixth value"));
  CHECK_THAT(fault("1738.0, 1, 1, 3\n" + rows), StartsWith("file-truncated: t.tab:4: the rows end at degree 2"));
  CHECK_THAT(fault("1738.0, 1, 1, 1\n" + rows), StartsWith("file-syntax: t.tab:4: the rows end at degree 2"));
  CHECK_THAT(fault(header + rows.substr(0, rows.find("2, 2"))),
             StartsWith("file-truncated: ") && Contains("degree 2, order 2"));
  CHECK_THAT(fault(rows + "2, 0, 1, 0\n"), StartsWith("file-syntax: t.tab:4: degree 2, order 0 a second time; line 1"));
  CHECK_THAT(fault(rows + "1, 2, 1, 0\n"), StartsWith("file-syntax: t.tab:4: the order is '2'"));
  CHECK_THAT(fault("1 0 1\n1 1 2\n"), StartsWith("file-truncated: t.tab:2: S is missing") && Contains("order -m"));
  CHECK_THAT(fault("1 0 1 2 3 4\n1 -1 2\n"), StartsWith("file-syntax: t.tab:1: 6 words"));
  CHECK_THAT(fault("0 0 1\n8192 0 1 0\n"), StartsWith("too-large: ") && Contains("1000 a row"));
  CHECK_THAT(fault("8193 0 1 0\n"), StartsWith("file-"));
  CHECK_THAT(fault(rows + "2.5 0 1 0\n"), StartsWith("file-syntax: t.tab:4: the degree is '2.5'"));
  CHECK_THAT(fault("words only\n"), StartsWith("file-truncated: "));
  CHECK_THAT(fault("0 0 1,0 0,0\n1 0 0,0 0,0\n"), StartsWith("file-syntax: t.tab:1: blanks and commas both part"));
  CHECK_THAT(fault("l,m,re,im\n0,0,1,0\n"), StartsWith("file-format: t.tab:1: complex coefficients"));
  CHECK_THAT(fault("0 0 1 0\n1 -1 .1 -.2\n1 0 .3 0\n1 1 -.1 .2\n"),
             StartsWith("file-syntax: t.tab:2: a fourth value below 0"));
  for (const char* whole : {"250, 5, 0, 2\n", "250, 250, 0, 2\n", "5 3 0 2\n", "250 5 0 2 2 1\n"}) {
    const CoefficientSet set = parse(whole + rows);
    CHECK(set.lmax == 2);
    CHECK(set.reference_radius.value_or(0) >= 5);
  }
}

TEST_CASE("kilometres are told by R and GM of known bodies, or by the user; metres are assumed with a note",
          "[gravity-table][length-unit]") {
  const std::string mars = "3396.0, 42828.37, 7e-5, 2\n" + rows, toy = "3396.0, 52828.37, 7e-5, 2\n" + rows;
  const CoefficientSet guessed = parse(mars), metres = parse(mars, 1.0), kilometres = parse(toy, 1000.0),
                       assumed = parse(toy);
  CHECK(guessed.reference_radius == 3396e3);
  CHECK(guessed.gm == Approx(42828.37e9).epsilon(1e-15));
  CHECK_FALSE(guessed.units_stated);
  CHECK_THAT(notes_of(guessed), Contains("kilometres were taken") && Contains("Mars") && Contains("--length-unit"));
  CHECK(metres.reference_radius == 3396.0);
  CHECK_THAT(notes_of(metres), Contains("taken in metres, as --length-unit says"));
  CHECK(kilometres.reference_radius == 3396e3);
  CHECK(assumed.reference_radius == 3396.0);
  CHECK_THAT(notes_of(assumed), Contains("metres assumed") && Contains("--length-unit km"));
  CHECK_THAT(notes_of(parse("3396000.0, 42828.37e9, 0, 2\n" + rows)),
             Contains("metres assumed, in which R and GM are those of Mars"));
  for (const CoefficientSet* set : {&guessed, &metres, &kilometres, &assumed}) {
    CHECK(set->length_unit == "m");
    CHECK(set->gravitational_constant == gravitational_constant_si);
  }
}

TEST_CASE("lengths in a mesh's unit become metres in every member", "[length-unit]") {
  CoefficientSet set(1, 1);
  set.kind = CoefficientKind::multipoles;
  set.first = {1, 2, 3};
  set.second = {0, 0, 4};
  set.reference_radius = 5;
  set.origin = Vec3(1, 2, 3);
  set.density = 7;
  set.mass = 2;
  set.second_moment = 3;
  set.length_unit = mesh_length_unit;
  set.mass_unit = mesh_mass_unit;
  CoefficientSet si = set;
  state_length_unit(si, 10, "f");
  CHECK(si.first == std::vector<double>{1000, 2000, 3000});
  CHECK(si.second[2] == 4000);
  CHECK(si.reference_radius == 50.0);
  CHECK(*si.origin == Vec3(10, 20, 30));
  CHECK(si.density == 7.0);
  CHECK(si.mass == 2000.0);
  CHECK(si.second_moment == 3e5);
  CHECK((si.length_unit == "m" && si.mass_unit == "kg"));
  CHECK_THAT(fault_of([&] { state_length_unit(si, 10, "f"); }),
             StartsWith("bad-argument: --length-unit: f is in metres"));
  set.kind = CoefficientKind::potential;
  set.gm = 2;
  set.gravitational_constant = 1;
  state_length_unit(set, 10, "f");
  CHECK(set.gm == Approx(2000 * gravitational_constant_si).epsilon(1e-15));
  CHECK(set.first[0] == 1);
  CoefficientSet numbers(0, 1);
  CHECK_THAT(fault_of([&] { state_length_unit(numbers, 10, "f"); }), Contains("holds no length"));
}

TEST_CASE("a file of coefficients is told by what it holds", "[gravity-table][coefficient-file]") {
  const TemporaryFolder folder;
  const std::string table = "3396.0, 42828.37, 7e-5, 2\n" + rows;
  for (const char* name : {"t.tab", "t.sha", "t.txt", "t.cof", "t", "t.gfc", "t.csv", "t.off"}) {
    write_text(folder / name, table);
    INFO(name);
    CHECK(is_coefficient_file(folder / name));
    check_field(read_coefficient_set(folder / name));
  }
  const CoefficientSet set = read_coefficient_set(folder / "t");
  const std::vector<std::pair<CoefficientFormat, std::string>> written = {{CoefficientFormat::json, "f.json"},
                                                                          {CoefficientFormat::csv, "f.csv"},
                                                                          {CoefficientFormat::netcdf, "f.nc"},
                                                                          {CoefficientFormat::gfc, "f.gfc"},
                                                                          {CoefficientFormat::shtools, "f.sh"}};
  for (const auto& [format, name] : written) {
    AtomicFile file(folder / name);
    write_coefficient_set(set, format, file);
    file.commit();
    CHECK(coefficient_format_in(read_text(folder / name)) == format);
    std::filesystem::rename(folder / name, folder / "f");
    CHECK(read_coefficient_set(folder / "f").first == set.first);
  }
  // Meshes are none, whatever their numbers look like.
  for (const char* mesh : {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "v 0 0 0\nv 1 0 0\n", "solid\n",
                           "856 1708\n5.7E+00 -3.9E+00 -4.8E+00\n8.3 -4.8 -4.7\n8.0 -4.9 -4.8\n1 102 105\n",
                           " 8 12\n 1 0.00000 0.00000 0.00000\n 2 2.00000 0.00000 0.00000\n 1 1 3 2\n",
                           "{\"asset\": {\"version\": \"2.0\"}}", ""})
    CHECK_FALSE(coefficient_format_in(mesh));
  CHECK_FALSE(is_coefficient_file("builtin:cow@1"));
  CHECK_FALSE(is_coefficient_file("benchmark"));
  CHECK(is_coefficient_file("missing.gfc"));
  write_text(folder / "words.tab", "nothing of the kind\n");
  CHECK_THAT(fault_of([&] { read_coefficient_set(folder / "words.tab"); }),
             StartsWith("file-format: ") && Contains("not a file of coefficients"));
}

TEST_CASE("every command that reads coefficients takes a table in kilometres", "[gravity-table][length-unit][cli]") {
  const TemporaryFolder folder;
  const std::string km = folder_of_cases + "shadr--header-in-km.sh";
  for (const std::vector<std::string>& unit : {std::vector<std::string>{}, {"--length-unit", "km"}}) {
    std::vector<std::string> arguments = {"potential", km, "--at", "4e6,0,0", "--device", "cpu", "--json"};
    arguments.insert(arguments.end(), unit.begin(), unit.end());
    const double v = first_potential(arguments);
    CHECK(v == Approx(-1.0711e7).epsilon(1e-4));
    CHECK(v == Approx(-double(read_gravity_table(km, 1000).potential(4e6, 0, 0))).epsilon(1e-14));
  }
  // As metres it is a pebble: the place is given in metres too.
  CHECK(first_potential({"potential", km, "--length-unit", "m", "--at", "4000,0,0", "--device", "cpu", "--json"}) ==
        Approx(-double(read_gravity_table(km, 1).potential(4000, 0, 0))).epsilon(1e-14));
  const auto out = [&](std::vector<std::string> arguments) {
    const ProgramRun run = run_program(arguments);
    INFO(arguments[0] << "\n" << run.err);
    CHECK(run.exit_code == 0);
    return run.out;
  };
  CHECK_THAT(out({"convert", km, folder / "a.gfc", "--length-unit", "km", "-q"}), Contains("R = 3396000"));
  CHECK_THAT(out({"diff", km, folder / "a.gfc", "--length-unit", "km", "--tolerance", "0"}), Contains("R = 3396000"));
  CHECK_THAT(out({"spectrum", km, "--length-unit", "km"}), Contains("as --length-unit says"));
  CHECK_THAT(out({"tensors", km, "--length-unit", "km"}), Contains("6.4169"));
  CHECK_THAT(out({"transform", "synthesise", km, folder / "m.nc", "--length-unit", "km", "--device", "cpu"}),
             Contains("as --length-unit says"));
  const ProgramRun tides = run_program({"tides", km, "--length-unit", "km", "--orbit", "400000km"});
  CHECK(tides.exit_code == 3); // no gravity field says the second moment
  CHECK_THAT(tides.err, Contains("second moment") && !Contains("unit"));
  const ProgramRun metric = run_program({"convert", folder / "a.gfc", folder / "b.sh", "--length-unit", "km"});
  CHECK(metric.exit_code == 2);
  CHECK_THAT(metric.err, Contains("is in metres already"));
}

TEST_CASE("prefixes and damaged copies of gravity tables are read or refused by name, in bounded memory",
          "[gravity-table][readers][alone]") {
  for (const auto& file : corpus("coefficients")) {
    if (file.extension() != ".sh" && file.extension() != ".gfc") continue;
    const std::string bytes = test::read_text(file);
    const auto read = [&](std::string_view part) {
      coefficient_format_in(part);
      parse_shtools_text(part, "t");
    };
    check_prefixes(bytes, read);
    check_mutations(bytes, 200, read);
  }
  if (!memory_is_measurable()) return;
  CHECK(peak_growth([] { fault("0 0 1 0\n8000 0 1 0\n"); }) < std::size_t{8} << 20);
}

TEST_CASE("the public gravity table of Mars gives an independent reader's potential", "[gravity-table][field]") {
  const char* field = std::getenv("COWGPU_FIELD");
  const std::string path = field ? std::string(field) + "/gmm3_120_sha.tab" : "";
  if (!field || !std::filesystem::exists(path)) {
    WARN("SKIPPED: COWGPU_FIELD names no folder with gmm3_120_sha.tab");
    return;
  }
  const GravityModel model = read_gravity_table(path, 1000);
  const CoefficientSet set = read_coefficient_set(path);
  CHECK(set.lmax == 120);
  CHECK(set.reference_radius == 3396e3);
  CHECK(set.gm == Approx(42828.37285418775e9).epsilon(1e-15));
  for (int l = 0; l <= 120; ++l)
    for (int m = 0; m <= l; ++m) {
      REQUIRE(set.first[set.index(0, l, m)] == model.c[std::size_t(l)][std::size_t(m)]);
      REQUIRE(set.second[set.index(0, l, m)] == model.s[std::size_t(l)][std::size_t(m)]);
    }
  for (const char* at : {"4e6,0,0", "1e6,-2e6,3.5e6"}) {
    double x = 0, y = 0, z = 0;
    REQUIRE(std::sscanf(at, "%lf,%lf,%lf", &x, &y, &z) == 3);
    CHECK(first_potential({"potential", path, "--at", at, "--device", "cpu", "--json"}) ==
          Approx(-double(model.potential(x, y, z))).epsilon(1e-13));
  }
}

TEST_CASE("tables whose orders end below their degrees are read, with zeros and a note", "[gravity-table]") {
  const CoefficientSet set = parse("1738.0 4902.8 0 3 1 1\n2 0 -4.84e-4 0\n2 1 -2e-10 1.4e-9\n3 0 5 0\n3 1 6 7\n");
  CHECK(set.lmax == 3);
  CHECK(set.first[set.index(0, 3, 1)] == 6);
  for (const auto& [l, m] : {std::pair(2, 2), {3, 2}, {3, 3}})
    CHECK((set.first[set.index(0, l, m)] == 0 && set.second[set.index(0, l, m)] == 0));
  CHECK_THAT(notes_of(set), Contains("orders end at 1") && !Contains("rows that"));
  CHECK(parse("1738.0 4902.8 0 2 0\n2 0 -4.84e-4 0\n").lmax == 2);
  // What is missing below mmax is still missing.
  CHECK_THAT(fault("1738.0 4902.8 0 3 1\n2 0 1 0\n2 1 1 1\n3 0 5 0\n"),
             StartsWith("file-truncated: ") && Contains("degree 3, order 1"));
  CHECK_THAT(notes_of(parse("1738.0 4902.8 0 3 1\n2 0 1 0\n3 0 5 0\n3 1 1 0\n")), Contains("1 row that the file"));
  CHECK_THAT(notes_of(parse("1738.0 4902.8 0 2 1\n" + rows)), Contains("orders end at 1, and rows have orders to 2"));
}

TEST_CASE("lines that end in carriage returns alone, and semicolons between numbers, are read", "[gravity-table]") {
  std::string text = "# a model\n1738.0, 4902.8, 1e-4, 2\n" + rows;
  std::replace(text.begin(), text.end(), '\n', '\r');
  check_field(parse(text));
  CHECK(coefficient_format_in(text) == CoefficientFormat::shtools);
  CHECK_THAT(fault(text + "2, 0, 1, 0\r"), StartsWith("file-syntax: t.tab:6: degree 2, order 0 a second time; line 3"));
  text = "# a model\n1738.0, 4902.8, 1e-4, 2\n" + rows;
  std::replace(text.begin(), text.end(), ',', ';');
  check_field(parse(text));
  CHECK(coefficient_format_in(text) == CoefficientFormat::shtools);
  CHECK_THAT(fault("0;0;1,5;0\n1;0;0,5;0\n"), StartsWith("file-syntax: t.tab:1: semicolons and commas both part"));
}

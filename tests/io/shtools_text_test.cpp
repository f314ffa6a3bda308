#include "host/io/shtools_text.hpp"

#include "host/io/coefficient_file.hpp"
#include "host/spectrum/convert.hpp"
#include "host/spectrum/roundtrip.hpp"
#include "tests/support/fields.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

CoefficientSet read_as_text(const std::string& path, const std::string& text) {
  return parse_shtools_text(text, path);
}

CoefficientSet written_and_read(const CoefficientSet& set, const std::string& path) {
  AtomicFile file(path);
  write_coefficient_set(set, coefficient_format(path), file);
  file.commit();
  return read_coefficient_set(path);
}

const std::string good = "# cowgpu 1\n# lmax 2\n# normalisation ortho\n# phase cs\n0, 0, 1.5, 0.0\n1, 0, 2, 0\n"
                         "1, 1, 3, 4\n2, 0, 5\n\n2, 1, 6, 7\n2, 2, 8, 9\n";

} // namespace

TEST_CASE("SHTOOLS text as pyshtools writes it is read, with and without its header line", "[shtools]") {
  const TemporaryFolder folder;
  const std::string path = folder / "p.sh";
  // shwrite: '{:d}, {:d}, {:.16e}, {:.16e}'
  const std::string rows = "0, 0, 1.0000000000000000e+00, 0.0000000000000000e+00\n"
                           "1, 0, 2.5000000000000000e-01, 0.0000000000000000e+00\n"
                           "1, 1, -1.0000000000000001e-01, 3.0000000000000000e+00\n";
  const CoefficientSet field = read_as_text(path, rows);
  CHECK(field.kind == CoefficientKind::field);
  CHECK(field.lmax == 1);
  CHECK_FALSE(field.normalisation_stated);
  CHECK_FALSE(field.phase_stated);
  CHECK(field.convention == Convention{Normalisation::four_pi, Phase::none});
  CHECK_THAT(field.notes.at(0), Contains("pyshtools"));
  CHECK(field.units_stated);
  CHECK(field.first[field.index(0, 1, 1)] == -0.1);
  CHECK(field.second[field.index(0, 1, 1)] == 3);
  // SHGravCoeffs.to_file: '{:.16e}, {:.16e}, {:.16e}, {:d}' of r0, gm, omega, lmax
  const CoefficientSet gravity =
      read_as_text(path, "1.7380000000000000e+06, 4.9028000661637961e+12, 0.0000000000000000e+00, 1\n" + rows);
  CHECK(gravity.kind == CoefficientKind::potential);
  CHECK(gravity.reference_radius == 1738000.0);
  CHECK(gravity.gm == 4.9028000661637961e12);
  CHECK(gravity.gravitational_constant == gravitational_constant_si);
  CHECK(gravity.first == field.first);
  // Blanks, errors, CRLF, comments; from degree 1 on.
  const CoefficientSet later = read_as_text(path, "# 1 2 3 4\r\n1 0 2.5D-01 0 1 1\r\n 1\t1 -0.1 3 1 1\r\n");
  CHECK(later.second == field.second);
  CHECK(later.first[0] == 0);
  CHECK(later.notes.size() == 3);
}

TEST_CASE("every format reads back the doubles that were written, with what they are of",
          "[shtools][coefficient-file]") {
  const TemporaryFolder folder;
  for (const auto kind : {CoefficientKind::field, CoefficientKind::multipoles, CoefficientKind::potential})
    for (const Form form : {Form::real, Form::complex})
      for (const auto n :
           {Normalisation::orthonormal, Normalisation::four_pi, Normalisation::schmidt, Normalisation::unnormalised})
        for (const Phase phase : {Phase::condon_shortley, Phase::none})
          for (const int fields : {1, 3})
            for (const char* name : {"c.json", "c.csv", "c.nc", "c.gfc", "c.sh"}) {
              const SphereCoefficients random = random_coefficients(12, fields, 5);
              CoefficientSet set(12, fields);
              set.kind = kind;
              set.form = form;
              set.convention = {n, phase};
              for (std::size_t i = 0; i < set.first.size(); ++i) {
                set.first[i] = random.values[i].real() * 1e-7;
                set.second[i] = random.values[i].imag() / 3;
              }
              if (kind != CoefficientKind::field) {
                set.reference_radius = 2.0 / 3;
                set.mass = 1e-9 / 7;
                set.gravitational_constant = 1;
              }
              if (kind == CoefficientKind::potential) set.gm = 1e-9 / 7;
              set.origin = Vec3(0.1, 1.0 / 3, -5e-324);
              set.origin_kind = "given";
              set.length_unit = "of the mesh";
              for (int f = 0; f < fields; ++f) {
                set.names[std::size_t(f)] = fmt::format("field.{}", f);
                set.units[std::size_t(f)] = "length";
              }
              set.provenance = {"cowgpu 9", "now", "cowgpu expand", "cow", "0f", "cowgpu convert"};
              set.remarks = {{"removed_mean", "0.25"}};
              INFO(name << " " << cowgpu::name(kind) << " " << cowgpu::name(form) << " " << cowgpu::name(n) << " "
                        << fields);
              if (!not_held(set, coefficient_format(name)).empty()) {
                CHECK_THAT(fault_of([&] { written_and_read(set, folder / name); }), StartsWith("bad-argument: "));
                continue;
              }
              const CoefficientSet back = written_and_read(set, folder / name);
              CHECK(back.first == set.first);
              CHECK(back.second == set.second);
              CHECK(back.kind == kind);
              CHECK(back.form == form);
              CHECK(back.convention == set.convention);
              CHECK((back.normalisation_stated && back.phase_stated));
              CHECK(back.names == set.names);
              CHECK(back.units == set.units);
              CHECK(back.reference_radius == set.reference_radius);
              CHECK(back.mass == set.mass);
              CHECK(back.gm == set.gm);
              CHECK(back.gravitational_constant == set.gravitational_constant);
              CHECK(back.origin == set.origin);
              CHECK(back.origin_kind == set.origin_kind);
              CHECK(back.length_unit == set.length_unit);
              CHECK(back.provenance.command == set.provenance.command);
              CHECK(back.provenance.mesh_sha256 == set.provenance.mesh_sha256);
              CHECK(back.provenance.history == set.provenance.history);
              CHECK(back.remarks == set.remarks);
              CHECK(back.notes.empty());
            }
}

TEST_CASE("a .sh file that is wrong is a named error with file and line", "[shtools]") {
  const TemporaryFolder folder;
  const std::string path = folder / "c.sh";
  REQUIRE(read_as_text(path, good).lmax == 2);
  struct Bad {
    const char* fault;
    int line;
    std::string text;
    const char* words;
  };
  const std::vector<Bad> all = {
      {"file-truncated", 0, "", "before the first row"},
      {"file-truncated", 4, good.substr(0, good.find("0, 0")), "before the first row"},
      {"file-truncated", 10, replaced(good, "2, 2, 8, 9\n", ""), "degree 2, order 2"},
      {"file-truncated", 2, replaced(good, "# lmax 2", "# lmax 8192"), "lmax is 8192"},
      {"file-syntax", 2, replaced(good, "# lmax 2", "# lmax 1"), "lmax is 1"},
      {"file-syntax", 7, replaced(good, "1, 1, 3, 4", "1, 0, 3, 0"), "degree 1, order 0 a second time; line 6"},
      {"file-syntax", 8, replaced(good, "1, 1, 3, 4", "2, 0, 3, 0"), "degree 2, order 0 a second time; line 7"},
      {"file-syntax", 7, replaced(good, "1, 1, 3", "1, 2, 3"), "the order is '2'"},
      {"file-syntax", 7, replaced(good, "1, 1, 3", "x1, 1, 3"), "expected, found 'x1, 1, 3"},
      {"file-truncated", 7, replaced(good, "1, 1, 3, 4", "1, 1, 3"), "S is missing"},
      {"file-truncated", 7, replaced(good, "1, 1, 3, 4", "1, 1"), "found 2 words"},
      {"file-syntax", 7, replaced(good, "1, 1, 3, 4", "1, 1, inf, 4"), "finite"},
      {"file-syntax", 7, replaced(good, "1, 1, 3, 4", "1, 1, 3, 4, 5, 6, 7"), "at most 6"},
      {"file-format", 7, replaced(good, "1, 1, 3, 4", "1, 1, (3+4j), 4"), "complex"},
      {"file-syntax", 6, replaced(good, "1, 0, 2, 0", "1, 0, 2, 1"), "order 0"},
      {"file-syntax", 3, replaced(good, "ortho", "orthogonal"), "orthogonal"},
      {"file-syntax", 2, replaced(good, "0, 0, 1.5", "8000, 0, 1.5"), "lmax is 2"},
      {"file-syntax", 5, replaced(good, "0, 0, 1.5", "-1, 0, 1.5"), "above 0"},
      {"file-truncated", 11, replaced(good, "# phase cs", "# phase cs\n# kind potential").substr(0, 1000), "r0"},
  };
  for (const Bad& bad : all) {
    const std::string found = fault_of([&] { read_as_text(path, bad.text); });
    INFO(bad.text << "\n" << found);
    CHECK_THAT(found, StartsWith(std::string(bad.fault) + ": " + path) && Contains(bad.words));
    if (bad.line && std::string(bad.words) != "r0") CHECK_THAT(found, Contains(fmt::format(":{}: ", bad.line)));
  }
}

TEST_CASE("every prefix and many damaged copies of a .sh file are read or named errors", "[shtools]") {
  const TemporaryFolder folder;
  const std::string path = folder / "c.sh";
  int read = 0;
  for (std::size_t length = 0; length < good.size(); ++length) {
    const std::string found = fault_of([&] { read_as_text(path, good.substr(0, length)); });
    INFO(length << ": " << found);
    CHECK((found == "none" || found.rfind("file-", 0) == 0));
    read += found == "none";
  }
  CHECK(read == 0); // not even without the last line's end
  for (std::uint32_t seed = 0; seed < 600; ++seed) {
    const std::string found = fault_of([&] { read_as_text(path, damaged(good, seed)); });
    INFO(seed << ": " << found);
    CHECK((found == "none" || found.rfind("file-", 0) == 0));
  }
}

TEST_CASE("a .sh file opens in pyshtools: comments, then the header line of a potential, then rows", "[shtools]") {
  const TemporaryFolder folder;
  CoefficientSet set = set_of(random_coefficients(3, 1, 1), {Normalisation::four_pi, Phase::none});
  set.kind = CoefficientKind::potential;
  set.reference_radius = 2;
  set.gm = 0.1;
  written_and_read(set, folder / "c.sh");
  // What shio.shread(header=True) does: comments out, commas out, a header of four words, rows in order, the last row's
  // first number is lmax.
  std::istringstream text(read_text(folder / "c.sh"));
  std::vector<std::vector<std::string>> lines;
  for (std::string line; std::getline(text, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    lines.emplace_back(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
  }
  REQUIRE(lines.size() == 11);
  CHECK(lines[0] ==
        std::vector<std::string>{"2.0000000000000000e+00", "1.0000000000000001e-01", "0.0000000000000000e+00", "3"});
  std::size_t at = 1;
  for (int l = 0; l <= 3; ++l)
    for (int m = 0; m <= l; ++m, ++at) {
      REQUIRE(lines[at].size() == 4);
      CHECK(lines[at][0] == std::to_string(l));
      CHECK(lines[at][1] == std::to_string(m));
      CHECK(std::stod(lines[at][2]) == set.first[set.index(0, l, m)]);
      CHECK(std::stod(lines[at][3]) == set.second[set.index(0, l, m)]);
    }
}

TEST_CASE("a file of ours whose lines on the convention were taken out is refused by name, and no other quantity",
          "[shtools][coefficient-file]") {
  const TemporaryFolder folder;
  CoefficientSet set = set_of(random_coefficients(3, 1, 1), {Normalisation::four_pi, Phase::condon_shortley});
  set.kind = CoefficientKind::potential;
  set.reference_radius = 2;
  set.gm = 2.5;
  set.mass = 2.5;
  set.gravitational_constant = 1;
  set.length_unit = "of the mesh";
  set.provenance.program = "cowgpu 9";
  written_and_read(set, folder / "c.sh");
  const std::string text = read_text(folder / "c.sh");
  for (const char* line : {"# normalisation 4pi\n", "# phase cs\n"}) {
    const std::string without = replaced(text, line, ""), key = std::string(line).substr(2, 5);
    for (const char* more : {"", "# cowgpu", "# program"}) {
      const std::string part = *more ? replaced(without, more, "# x") : without;
      const std::string found = fault_of([&] { read_as_text("c.sh", part); });
      INFO(line << more << ": " << found);
      CHECK_THAT(found, StartsWith("file-syntax: c.sh:") && Contains("no line '# " + key));
    }
  }
  // Without the line of the version the others still count.
  const std::string unsigned_text = text.substr(text.find('\n') + 1);
  const CoefficientSet same = read_as_text("c.sh", unsigned_text);
  CHECK(same.convention == set.convention);
  CHECK(same.gravitational_constant == 1.0);
  CHECK(same.length_unit == "of the mesh");
  CHECK(same.notes.empty());
  // Another program's table that says one of them means it.
  const CoefficientSet foreign = read_as_text("f.sh", "# normalisation schmidt\n0 0 1\n1 0 2\n1 1 3 4\n");
  CHECK(foreign.convention == Convention{Normalisation::schmidt, Phase::none});
  CHECK(foreign.normalisation_stated);
  CHECK_FALSE(foreign.phase_stated);
  CHECK_THAT(fault_of([&] { read_as_text("f.sh", "# normalisation schmidt\n2.0 1 0 1 1 1\n1 0 2 0\n1 1 3 4\n"); }),
             StartsWith("file-syntax: f.sh:2: the sixth value") && Contains("line 1 says"));
  // The same of our CSV, complex as convert writes it.
  set.form = Form::complex;
  set.kind = CoefficientKind::multipoles;
  written_and_read(set, folder / "c.csv");
  const std::string csv = read_text(folder / "c.csv");
  for (const char* line : {"# normalisation 4pi\n", "# phase cs\n", "# kind multipoles\n"}) {
    write_text(folder / "d.csv", replaced(csv, line, ""));
    INFO(line);
    CHECK_THAT(fault_of([&] { read_coefficient_set(folder / "d.csv"); }),
               StartsWith("file-syntax: ") && Contains("is missing"));
  }
}

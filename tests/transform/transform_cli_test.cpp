#include "host/io/coefficient_file.hpp"
#include "host/io/grid_file.hpp"
#include "host/spectrum/convert.hpp"
#include "host/spectrum/roundtrip.hpp"
#include "tests/support/fields.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <fmt/format.h>
#include <sys/stat.h>

#include <filesystem>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

ProgramRun run_on_cpu(std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), {"--device", "cpu"});
  return run_program(arguments);
}

void write_random(const std::string& path, int lmax, int fields, Convention convention = {}) {
  AtomicFile out(path);
  write_coefficient_set(set_of(random_coefficients(lmax, fields, 2), convention), coefficient_format(path), out);
  out.commit();
}

bool same_files(const std::string& folder, std::size_t count) {
  const auto all = std::filesystem::directory_iterator(folder);
  return std::size_t(std::distance(begin(all), end(all))) == count;
}

} // namespace

TEST_CASE("coefficients survive a synthesis and an analysis on files of any kind", "[transform-cli]") {
  const TemporaryFolder folder;
  for (const int lmax : {0, 1, 7, 20})
    for (const char* grid : {"gl", "cc", "dh", "dh1"})
      for (const bool netcdf : {true, false}) {
        INFO(lmax << " " << grid << " " << netcdf);
        const std::string suffix = netcdf ? ".nc" : ".csv";
        const std::string in = folder / ("in" + suffix), map = folder / ("map" + suffix),
                          out = folder / ("out" + suffix);
        write_random(in, lmax, 2, {Normalisation::schmidt, Phase::none});
        const ProgramRun there = run_on_cpu({"transform", "synthesise", in, map, "--grid", grid});
        INFO(there.err);
        REQUIRE(there.exit_code == 0);
        CHECK_THAT(there.out, Contains("computed: synthesis of 2 fields") && Contains("CPU path on"));
        const ProgramRun back =
            run_on_cpu({"transform", "analyse", map, out, "--normalisation", "4pi", "--phase", "cs"});
        INFO(back.err);
        REQUIRE(back.exit_code == 0);
        const CoefficientSet a = read_fields(in), b = read_fields(out);
        CHECK(b.convention == Convention{Normalisation::four_pi, Phase::condon_shortley});
        CHECK(compare(orthonormal(a), orthonormal(b)).max <= 2e-14);
      }
}

TEST_CASE("a field in closed form has its coefficients", "[transform-cli]") {
  const TemporaryFolder folder;
  GridFile file;
  file.grid = make_grid(GridKind::driscoll_healy, 3);
  file.names = {"dipole"};
  for (int i = 0; i < file.grid.rings; ++i)
    for (int j = 0; j < file.grid.ring_length; ++j)
      file.values.push_back(2 + std::sin(file.grid.theta[std::size_t(i)]) * std::sin(file.grid.phi(j)));
  file.lmax = 3;
  AtomicFile out(folder / "g.csv");
  write_grid(file, FileFormat::csv, out);
  out.commit();
  const ProgramRun run = run_on_cpu({"transform", "analyse", folder / "g.csv", folder / "c.csv", "--lmax", "1",
                                     "--normalisation", "unnormalised", "--phase", "none"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const std::string text = read_text(folder / "c.csv");
  CHECK_THAT(text, Contains("# normalisation unnormalised\n# phase none\n# fields dipole\nl,m,C,S\n"));
  const CoefficientSet real = read_fields(folder / "c.csv");
  CHECK(real.first[real.index(0, 0, 0)] == Approx(2).epsilon(1e-14));
  CHECK(real.second[real.index(0, 1, 1)] == Approx(1).epsilon(1e-14));
  CHECK(std::fabs(real.first[real.index(0, 1, 0)]) < 1e-14);
  CHECK(std::fabs(real.first[real.index(0, 1, 1)]) < 1e-14);
}

TEST_CASE("a lower degree leaves coefficients out and a higher one makes a finer grid", "[transform-cli]") {
  const TemporaryFolder folder;
  write_random(folder / "in.nc", 9, 1);
  const ProgramRun low = run_on_cpu({"transform", "synthesise", folder / "in.nc", folder / "low.nc", "--lmax", "4"});
  CHECK_THAT(low.out, Contains("note: degrees 5 to 9 were left out"));
  CHECK(read_grid(folder / "low.nc").lmax == 4);
  CHECK(run_on_cpu({"transform", "synthesise", folder / "in.nc", folder / "high.nc", "--lmax", "15"}).exit_code == 0);
  CHECK(read_grid(folder / "high.nc").grid.rings == 16);
  CHECK(run_on_cpu({"transform", "analyse", folder / "high.nc", folder / "back.nc"}).exit_code == 0);
  const SphereCoefficients back = orthonormal(read_fields(folder / "back.nc"));
  CHECK(back.lmax == 15);
  double above = 0;
  for (int m = 0; m <= 15; ++m)
    for (int l = std::max(m, 10); l <= 15; ++l) above = std::max(above, std::abs(back.at(0, l, m)));
  CHECK(above <= 1e-14);
}

TEST_CASE("a round trip prints its errors and is within its bound", "[transform-cli]") {
  for (const char* grid : {"gl", "cc", "dh", "dh1"})
    for (const char* lmax : {"0", "1", "2", "40"}) {
      INFO(grid << " " << lmax);
      const ProgramRun run = run_on_cpu({"transform", "roundtrip", "--lmax", lmax, "--grid", grid, "--fields", "2"});
      INFO(run.out << run.err);
      CHECK(run.exit_code == 0);
      CHECK_THAT(run.out, Contains("max_error") && Contains("passed") && Contains("seed 1"));
    }
}

TEST_CASE("a round trip on the device auto picks passes too", "[transform-cli][vulkan]") {
  const ProgramRun run = run_program({"transform", "roundtrip", "--lmax", "31", "--fields", "3"});
  INFO(run.out << run.err);
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("passed"));
}

TEST_CASE("what overflows is refused, not written, and no input is replaced", "[transform-cli]") {
  const TemporaryFolder folder;
  write_text(folder / "big.csv",
             "# normalisation orthonormal\n# phase cs\n# lmax 1\nl,m,re,im\n0,0,1.7e308,0\n1,0,1.7e308,0\n"
             "1,1,1.7e308,1.7e308\n");
  for (const char* device : {"cpu", "auto"}) {
    const ProgramRun run = run_program(
        {"transform", "synthesise", folder / "big.csv", folder / "map.csv", "--grid", "gl", "--device", device});
    INFO(run.out << run.err);
    CHECK(run.exit_code == 3);
    CHECK_THAT(run.err, Contains("overflow"));
    CHECK_FALSE(std::filesystem::exists(folder / "map.csv"));
  }
  const ProgramRun power = run_program({"spectrum", folder / "big.csv"});
  INFO(power.out << power.err);
  CHECK(power.exit_code == 3);
  write_random(folder / "c.nc", 4, 1);
  const std::string before = read_text(folder / "c.nc");
  const ProgramRun same = run_on_cpu({"transform", "synthesise", folder / "c.nc", folder / "c.nc", "--grid", "gl"});
  CHECK(same.exit_code == 2);
  CHECK(read_text(folder / "c.nc") == before);
}

TEST_CASE("usage errors of the transforms say what is allowed", "[transform-cli]") {
  const TemporaryFolder folder;
  write_random(folder / "c.nc", 4, 1);
  REQUIRE(run_on_cpu({"transform", "synthesise", folder / "c.nc", folder / "g.nc"}).exit_code == 0);
  const std::string c = folder / "c.nc", g = folder / "g.nc", out = folder / "out.nc";
  const std::vector<std::vector<std::string>> wrong = {
      {"transform"},
      {"transform", "turn"},
      {"transform", "analyse"},
      {"transform", "analyse", g},
      {"transform", "analyse", g, out, out},
      {"transform", "analyse", g, folder / "out.tif"},
      {"transform", "analyse", g, folder / "out"},
      {"transform", "analyse", c + ".txt", out},
      {"transform", "analyse", g, out, "--lmax", "-1"},
      {"transform", "analyse", g, out, "--lmax", "5"},
      {"transform", "analyse", g, out, "--lmax", "8193"},
      {"transform", "analyse", g, out, "--lmax", "x"},
      {"transform", "analyse", g, out, "--grid", "healpix"},
      {"transform", "analyse", g, out, "--normalisation", "5pi"},
      {"transform", "analyse", g, out, "--phase", "moon"},
      {"transform", "synthesise", c, out, "--grid", "GL"},
      {"transform", "synthesise", c, out, "--phase", "cs"},
      {"transform", "synthesise", c, out, "--lmax", "99999999999999999999"},
      {"transform", "roundtrip"},
      {"transform", "roundtrip", "--lmax", "-1"},
      {"transform", "roundtrip", "--lmax", "8193"},
      {"transform", "roundtrip", "--lmax", "4", "--fields", "0"},
      {"transform", "roundtrip", "--lmax", "4", "--fields", "65"},
      {"transform", "roundtrip", "--lmax", "4", "--seed", "-1"},
      {"transform", "roundtrip", "--lmax", "4", "--runs", "0"},
      {"transform", "roundtrip", "--lmax", "4", "file"},
      {"spectrum"},
      {"spectrum", c, "--cross"},
      {"spectrum", c, c},
  };
  for (const auto& arguments : wrong) {
    std::string line;
    for (const auto& word : arguments) line += word + " ";
    INFO(line);
    const ProgramRun run = run_program(arguments);
    INFO(run.err);
    CHECK(run.exit_code == 2);
    CHECK_THAT(run.err, StartsWith("cowgpu: error [bad-argument]: "));
    CHECK(run.out.empty());
  }
  CHECK(same_files(folder.path(), 2));
}

TEST_CASE("files that are missing, folders, or the wrong kind are named errors that leave nothing", "[transform-cli]") {
  const TemporaryFolder folder;
  write_random(folder / "c.nc", 4, 1);
  const std::string c = folder / "c.nc", g = folder / "g.nc", out = folder / "out.nc";
  REQUIRE(run_on_cpu({"transform", "synthesise", c, g}).exit_code == 0);
  std::filesystem::create_directory(folder / "folder.nc");
  write_text(folder / "milk.nc", "milk");
  write_text(folder / "milk.csv", "milk");
  write_text(folder / "cut.nc", read_text(g).substr(0, 700));
  const auto code = [&](const std::vector<std::string>& arguments, int expected, const char* fault) {
    const ProgramRun run = run_program(arguments);
    INFO(arguments[1] << " " << run.err);
    CHECK(run.exit_code == expected);
    CHECK_THAT(run.err, StartsWith(std::string("cowgpu: error [") + fault + "]: "));
  };
  code({"transform", "analyse", folder / "none.nc", out}, 5, "cannot-read");
  code({"transform", "analyse", folder / "folder.nc", out}, 5, "cannot-read");
  code({"transform", "analyse", g, folder / "folder.nc"}, 5, "cannot-write");
  code({"transform", "analyse", g, folder / "none/out.nc"}, 5, "cannot-write");
  code({"transform", "analyse", g, "/proc/out.nc"}, 5, "cannot-write");
  code({"transform", "analyse", folder / "milk.nc", out}, 3, "file-format");
  code({"transform", "analyse", folder / "milk.csv", out}, 3, "file-format");
  code({"transform", "analyse", folder / "cut.nc", out}, 3, "file-format");
  code({"transform", "analyse", c, out}, 3, "file-format");
  code({"transform", "analyse", g, out, "--grid", "dh"}, 3, "file-format");
  code({"transform", "synthesise", g, out}, 3, "file-format");
  code({"transform", "synthesise", "http://127.0.0.1:1/c.nc", out}, 5, "cannot-read");
  code({"spectrum", g}, 3, "file-format");
  code({"spectrum", folder / "none.json"}, 5, "cannot-read");
  code({"transform", "roundtrip", "--lmax", "8192", "--fields", "64", "--device", "cpu"}, 3, "too-large");
  CHECK(same_files(folder.path(), 6));
}

TEST_CASE("unnormalised coefficients of a high degree are refused with the reason", "[transform-cli]") {
  const TemporaryFolder folder;
  GridFile grid;
  grid.grid = make_grid(GridKind::gauss_legendre, 160);
  grid.lmax = 160;
  grid.names = {"value"};
  grid.values.resize(grid.grid.points());
  for (std::size_t i = 0; i < grid.values.size(); ++i) grid.values[i] = double(i % 7);
  AtomicFile out(folder / "g.nc");
  write_grid(grid, FileFormat::netcdf, out);
  out.commit();
  const ProgramRun run =
      run_on_cpu({"transform", "analyse", folder / "g.nc", folder / "c.nc", "--normalisation", "unnormalised"});
  CHECK(run.exit_code == 2);
  CHECK_THAT(run.err, Contains("unnormalised") && Contains("degree 150"));
  CHECK(same_files(folder.path(), 1));
}

TEST_CASE("a dry run of the transforms prints the memory and writes nothing", "[transform-cli]") {
  const TemporaryFolder folder;
  write_random(folder / "c.nc", 4, 1);
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"transform", "synthesise", folder / "c.nc", folder / "g.nc", "--lmax", "500"},
           {"transform", "roundtrip", "--lmax", "4096"}}) {
    auto words = arguments;
    words.emplace_back("--dry-run");
    const ProgramRun run = run_on_cpu(words);
    INFO(run.err);
    CHECK(run.exit_code == 0);
    CHECK_THAT(run.out, Contains("memory: at most") && Contains("grid: gl, "));
  }
  CHECK(same_files(folder.path(), 1));
}

TEST_CASE("the spectrum of a file is its power per degree, whatever its convention", "[transform-cli]") {
  const TemporaryFolder folder;
  SphereCoefficients fields(3, 2);
  fields.at(0, 0, 0) = 2;
  fields.at(0, 2, 1) = {0, 3};
  fields.at(1, 2, 1) = {1, -1};
  for (const auto n : {Normalisation::orthonormal, Normalisation::schmidt}) {
    CoefficientSet set = set_of(fields, {n, Phase::none});
    set.names = {"height", "gravity"};
    AtomicFile out(folder / "c.nc");
    write_coefficient_set(set, CoefficientFormat::netcdf, out);
    out.commit();
    const ProgramRun run = run_program({"spectrum", folder / "c.nc", "--cross"});
    INFO(run.out << run.err);
    CHECK(run.exit_code == 0);
    CHECK_THAT(run.out, Contains("height: integral of f^2 over the unit sphere 22\n") &&
                            Contains("gravity: integral of f^2 over the unit sphere 4\n") &&
                            Contains("height and gravity: integral of f g over the unit sphere -6"));
    CHECK_THAT(run.out, Contains("log10 from 1e") && Contains("####") && Contains("----"));
  }
}

TEST_CASE("the spectrum of what expand writes is the same from JSON and from CSV", "[transform-cli]") {
  const TemporaryFolder folder;
  REQUIRE(run_on_cpu({"expand", "builtin:box:1,2,3", "--lmax", "6", "-o", folder / "m.json", "-o", folder / "m.csv"})
              .exit_code == 0);
  const ProgramRun json = run_program({"spectrum", folder / "m.json"}),
                   csv = run_program({"spectrum", folder / "m.csv"});
  CHECK(json.exit_code == 0);
  CHECK_THAT(json.out, Contains("note: these are mass moments Q_lm / R^l with R = 1.87"));
  CHECK(json.out.substr(json.out.find('\n')).substr(5) == csv.out.substr(csv.out.find('\n')).substr(5));
  // Q_00 is the mass 6 over sqrt(4 pi).
  CHECK_THAT(json.out, Contains(fmt::format("{:.10e}", 36 / (4 * std::numbers::pi)).substr(0, 9)));
}

TEST_CASE("an interrupt ends a transform with 130 and leaves the old file", "[transform-cli]") {
  const TemporaryFolder folder;
  REQUIRE(mkfifo((folder / "pipe.nc").c_str(), 0600) == 0);
  write_text(folder / "out.nc", "old");
  ProgramOptions options;
  options.interrupt_after = 0.5;
  const ProgramRun run = run_program({"transform", "analyse", folder / "pipe.nc", folder / "out.nc"}, options);
  CHECK(run.exit_code == 130);
  CHECK(read_text(folder / "out.nc") == "old");
  CHECK(same_files(folder.path(), 2));
}

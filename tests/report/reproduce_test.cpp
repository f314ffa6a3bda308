#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include "host/error.hpp"
#include "host/reproduce/tables.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <set>

using namespace cowgpu::test;
using namespace cowgpu::reproduce;
using Catch::Contains;
using nlohmann::json;

namespace {

json read_json(const std::string& path) {
  std::ifstream file(path);
  REQUIRE(file.good());
  return json::parse(file);
}

ProgramRun reproduce(const TemporaryFolder& folder, std::vector<std::string> more) {
  std::vector<std::string> arguments = {"reproduce", "-o", folder / "out", "--device", "cpu"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments);
}

} // namespace

TEST_CASE("the unit of a printed number's last digit", "[reproduce]") {
  CHECK(last_digit("0.0152") == 1e-4);
  CHECK(last_digit("-1.81e-06") == 1e-8);
  CHECK(last_digit("4.00e-05") == 1e-7);
  CHECK(last_digit("9e+12") == 1e12);
  CHECK(last_digit("13652") == 1);
  CHECK_THROWS_AS(last_digit("cow"), cowgpu::Error);
  CHECK_THROWS_AS(last_digit(""), cowgpu::Error);
  CHECK_THROWS_AS(last_digit("1e"), cowgpu::Error);
}

TEST_CASE("a number agrees with the paper's where it rounds to its digits", "[reproduce]") {
  CHECK(compared({"t", "i", {"0.0152"}, "", "why"}, {0.015249}, "").verdict == Verdict::agrees);
  CHECK(compared({"t", "i", {"0.0152"}, "", "why"}, {0.015251}, "").verdict == Verdict::differs);
  CHECK(compared({"t", "i", {"-2e3"}, "", "why"}, {-1600}, "").verdict == Verdict::agrees);
  CHECK(compared({"t", "i", {"1.0"}, "", "why"}, {std::nan("")}, "").verdict == Verdict::differs);
  const Row row = compared({"t", "i", {"0.1", "-0.25"}, "", "why"}, {0.13, -0.21}, "");
  CHECK(row.printed == "0.1 - 0.25i");
  CHECK(row.verdict == Verdict::differs);
  CHECK(row.reason == "why");
  CHECK(*row.difference == Approx(0.05));
  const Row none = compared({"t", "i", {"0.1"}, "", "why"}, {}, "");
  CHECK(none.verdict == Verdict::not_computed);
  CHECK_FALSE(none.difference.has_value());
  CHECK(compared({"t", "i", {"0.1", "0.2"}, "", ""}, {1}, "").verdict == Verdict::not_computed);
}

TEST_CASE("without the stages' files every number of the paper is listed as not computed", "[reproduce]") {
  const std::vector<Row> rows = paper_rows({});
  CHECK(rows.size() == 116);
  for (const Row& row : rows) {
    INFO(row.table << ": " << row.item);
    CHECK(row.verdict == Verdict::not_computed);
    CHECK(row.ours.empty());
  }
}

TEST_CASE("of another body nothing is compared", "[reproduce]") {
  std::vector<Row> rows = {compared({"t", "i", {"1"}, "", ""}, {1}, ""), compared({"t", "i", {"1"}, "", ""}, {}, "")};
  not_the_papers_body(rows, "a horse");
  CHECK(rows[0].verdict == Verdict::not_compared);
  CHECK(rows[0].reason == "ours is of a horse");
  CHECK(rows[1].verdict == Verdict::not_computed);
}

TEST_CASE("what is of a body that the paper has no numbers about is not compared, and not missing", "[reproduce]") {
  const Documents documents = {
      {"tensors.json", {{"mass", 1}}}, {"radiate.json", {{"omega_after", "0.5"}}}, {"tip.json", {{"force_N", 1}}}};
  std::vector<Row> rows = paper_rows(documents);
  not_the_papers_body(rows, "a horse");
  for (const Row& row : rows) {
    const bool here = row.table == "tensors" || row.table == "radiation" || row.table == "tipping";
    INFO(row.table << ": " << row.item);
    CHECK(row.verdict == (here ? Verdict::not_compared : Verdict::not_computed));
    if (here) CHECK_THAT(row.reason, Contains("ours is of a horse") || Contains("has this body's"));
  }
}

TEST_CASE("reproduce goes on where it was", "[reproduce][cli]") {
  const TemporaryFolder folder;
  const std::vector<std::string> of_box = {"--mesh", "builtin:box:3,2,1", "--only", "mass,tensors"};
  const ProgramRun first = reproduce(folder, of_box);
  INFO(first.err);
  REQUIRE(first.exit_code == 0);
  CHECK_THAT(first.out, Contains("reproduce.md"));
  const json one = read_json(folder / "out/reproduce.json");
  CHECK(one["mesh"]["papers"] == false);
  CHECK(one["stages"].size() == 2);
  CHECK(one["stages"][0]["earlier_run"] == false);
  std::set<std::string> verdicts;
  for (const json& row : one["rows"]) verdicts.insert(row["verdict"]);
  CHECK(verdicts == std::set<std::string>{"not compared", "not computed"});

  const ProgramRun again = reproduce(folder, of_box);
  REQUIRE(again.exit_code == 0);
  CHECK_THAT(again.err, Contains("there already"));
  const json two = read_json(folder / "out/reproduce.json");
  CHECK(two["stages"][0]["earlier_run"] == true);
  CHECK(two["rows"] == one["rows"]);

  std::ofstream(folder / "out/data/mass.json", std::ios::app) << "\n";
  REQUIRE(reproduce(folder, of_box).exit_code == 0);
  const json mended = read_json(folder / "out/reproduce.json");
  CHECK(mended["stages"][0]["earlier_run"] == false);
  CHECK(mended["stages"][1]["earlier_run"] == true);

  std::ofstream(folder / "out/data/stages.json") << "{\"stages\": [";
  REQUIRE(reproduce(folder, of_box).exit_code == 0);
  CHECK(read_json(folder / "out/reproduce.json")["stages"][1]["earlier_run"] == false);

  REQUIRE(reproduce(folder, {"--mesh", "builtin:box:3,2,2", "--only", "mass,tensors"}).exit_code == 0);
  CHECK(read_json(folder / "out/reproduce.json")["stages"][1]["earlier_run"] == false);
}

TEST_CASE("with --only what was done before is shown, too, and the count of numbers is always the same",
          "[reproduce][cli]") {
  const TemporaryFolder folder;
  const std::vector<std::string> of_box = {"--mesh", "builtin:box:3,2,1", "--only"};
  const auto only = [&](const char* names) {
    std::vector<std::string> arguments = of_box;
    arguments.emplace_back(names);
    const ProgramRun run = reproduce(folder, arguments);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return read_json(folder / "out/reproduce.json");
  };
  const json first = only("mass"), second = only("tensors,inspect");
  CHECK(first["stages"].size() == 1);
  CHECK(second["stages"].size() == 3);
  CHECK(second["rows"].size() == first["rows"].size());
  CHECK(first["rows"].size() == paper_rows({}).size());
  std::ifstream text(folder / "out/reproduce.md");
  const std::string page((std::istreambuf_iterator<char>(text)), {});
  CHECK_THAT(page, Contains("THIS IS NOT THE PAPER'S COW") && Contains("Another body was asked for"));
}

TEST_CASE("a stage that fails is named, and the others go on", "[reproduce][cli]") {
  const TemporaryFolder folder;
  // A box is no body of genus 1, two boxes beside each other are no sphere.
  std::ofstream(folder / "two.off") << "OFF\n8 8 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n5 0 0\n6 0 0\n5 1 0\n5 0 1\n"
                                       "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n3 4 6 5\n3 4 5 7\n3 5 6 7\n3 4 7 6\n";
  const ProgramRun run = reproduce(folder, {"--mesh", folder / "two.off", "--only", "stretch,tensors"});
  INFO(run.err);
  CHECK(run.exit_code == 3);
  CHECK_THAT(run.err, Contains("FAILED with exit code 3"));
  const json found = read_json(folder / "out/reproduce.json");
  CHECK(found["stages"][0]["exit_code"] == 0);
  CHECK(found["stages"][1]["exit_code"] == 3);
  CHECK_THAT(found["stages"][1]["message"].get<std::string>(), Contains("map-topology"));
}

TEST_CASE("reproduce: what it refuses", "[reproduce][cli]") {
  const TemporaryFolder folder;
  const auto refused = [&](const std::vector<std::string>& arguments, int code, const char* word) {
    const ProgramRun run = reproduce(folder, arguments);
    INFO(run.err);
    CHECK(run.exit_code == code);
    CHECK_THAT(run.err, Contains(word));
  };
  refused({"--only", "milk"}, 2, "there is no such stage");
  refused({"--mesh", "builtin:horse"}, 2, "horse");
  refused({"--mesh", folder / "missing.off"}, 5, "missing.off");
  CHECK(run_program({"reproduce"}).exit_code == 2);
  CHECK(run_program({"reproduce", "-o", "/dev/null/out", "--mesh", "builtin:box"}).exit_code == 5);
}

TEST_CASE("an interrupted reproduce says so and keeps what it has", "[reproduce][cli]") {
  const TemporaryFolder folder;
  ProgramOptions options;
  options.interrupt_on = "[1/";
  const ProgramRun run = run_program(
      {"reproduce", "-o", folder / "out", "--device", "cpu", "--mesh", "builtin:cow@4", "--only", "tensors,mass,flow"},
      options);
  INFO(run.err);
  CHECK(run.exit_code == 130);
  CHECK_FALSE(std::filesystem::exists(folder / "out/reproduce.json"));
  CHECK(read_json(folder / "out/data/stages.json")["stages"].size() >= 1);
}

TEST_CASE("every number of the paper is computed for its own cow", "[reproduce][cli][long]") {
  if (!benchmark_cow()) return skip_without_cow();
  const TemporaryFolder folder;
  const ProgramRun run = reproduce(folder, {});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const json found = read_json(folder / "out/reproduce.json");
  CHECK(found["counts"]["not_computed"] == 0);
  CHECK(found["counts"]["not_compared"] == 0);
  // What is listed for a run that computed nothing has the names that the commands give.
  const std::vector<Row> listed = paper_rows({});
  REQUIRE(found["rows"].size() == listed.size());
  for (std::size_t i = 0; i < listed.size(); ++i) CHECK(found["rows"][i]["item"] == listed[i].item);
  for (const json& row : found["rows"]) {
    INFO(row.dump());
    CHECK((row["verdict"] == "agrees") == row["reason"].get<std::string>().empty());
  }
}

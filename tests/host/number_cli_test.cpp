// Numbers in the options of every command, walked by the table that `cowgpu man` prints.
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <fstream>
#include <sstream>

using namespace cowgpu::test;
using Catch::Contains;
using nlohmann::json;

namespace {

struct NumericOption {
  std::vector<std::string> command; // "transform", "roundtrip"
  std::string name, type;           // "--lmax", "L:INT in [0 - 8192]"
  bool integer() const {
    return type.starts_with("INT") || type.starts_with("UINT") || type.find("INT in [") != std::string::npos;
  }
};

std::string without(std::string text, const std::string& what) {
  for (std::size_t at = 0; (at = text.find(what)) != std::string::npos;) text.erase(at, what.size());
  return text;
}

std::vector<NumericOption> numeric_options() {
  const ProgramRun man = run_program({"man"});
  REQUIRE(man.exit_code == 0);
  std::vector<NumericOption> found;
  std::vector<std::string> command;
  std::istringstream lines(man.out);
  for (std::string line; std::getline(lines, line);) {
    line = without(line, "\\");
    if (line.starts_with(".SS cowgpu ")) {
      command.clear();
      std::istringstream words(line.substr(11));
      for (std::string word; words >> word;) command.push_back(word);
    }
    const std::size_t type = line.find(" fI");
    if (!line.starts_with(".B --") || type == std::string::npos) continue;
    NumericOption option{command, line.substr(3, line.find_first_of(", ", 3) - 3), line.substr(type + 3)};
    if (option.integer() || option.type.find("FLOAT") != std::string::npos) found.push_back(option);
  }
  return found;
}

// The first number that the range of the type allows.
std::string least(const NumericOption& option) {
  const std::size_t open = option.type.find('[');
  if (open == std::string::npos) return "1";
  return option.type.substr(open + 1, option.type.find(' ', open) - open - 1);
}

// Options are read before it turns out that there is one that does not exist: nothing is computed.
std::string complaint(const NumericOption& option, const std::string& value) {
  std::vector<std::string> arguments = option.command;
  arguments.push_back(option.name + "=" + value);
  arguments.emplace_back("--no-such-option");
  const ProgramRun run = run_program(arguments);
  CHECK(run.exit_code == 2);
  return run.err;
}

bool takes(const NumericOption& option, const std::string& value) {
  const std::string said = complaint(option, value);
  return said.find(option.name + ":") == std::string::npos && said.find("Could not convert") == std::string::npos;
}

} // namespace

TEST_CASE("every integer option of every command takes decimal digits and nothing else", "[number][cli]") {
  int integers = 0;
  for (const NumericOption& option : numeric_options()) {
    if (!option.integer()) continue;
    ++integers;
    const std::string number = least(option);
    INFO(option.command.front() << " " << option.name << " " << option.type);
    CHECK(takes(option, number));
    CHECK(takes(option, "00" + number));
    for (const std::string& wrong : {"0x1" + number, " " + number, number + ".0", number + "e0", std::string("nan")}) {
      INFO("'" << wrong << "'");
      CHECK_FALSE(takes(option, wrong));
    }
  }
  CHECK(integers > 40);
}

TEST_CASE("every number option of every command refuses what is not finite, hexadecimal or has a comma",
          "[number][cli]") {
  int numbers = 0;
  for (const NumericOption& option : numeric_options()) {
    if (option.integer()) continue;
    ++numbers;
    INFO(option.command.front() << " " << option.name << " " << option.type);
    for (const char* wrong : {"nan", "inf", "0x1p-3", "1,5"}) {
      INFO("'" << wrong << "'");
      CHECK_FALSE(takes(option, wrong));
    }
  }
  CHECK(numbers > 0);
}

TEST_CASE("010 is ten, as a degree, in lists of orders and in ranges of options", "[number][cli]") {
  const ProgramRun ten = run_program({"expand", "builtin:box", "--lmax", "010", "--device", "cpu", "--json"});
  REQUIRE(ten.exit_code == 0);
  CHECK(json::parse(ten.out)["expansions"]["mass"]["lmax"] == 10);
  const ProgramRun trip = run_program({"transform", "roundtrip", "--lmax", "+08", "--device", "cpu", "--json"});
  INFO(trip.err);
  REQUIRE(trip.exit_code == 0);
  CHECK(json::parse(trip.out)["lmax"] == 8);
  const ProgramRun orders = run_program(
      {"tip", "builtin:ellipsoid:1,1,2@2", "--of", "stretch", "--order", "009..010", "--device", "cpu", "--json"});
  INFO(orders.err);
  REQUIRE(orders.exit_code == 0);
  const json rows = json::parse(orders.out)["orders"];
  REQUIRE(rows.size() == 3);
  CHECK(rows[0]["order"] == 9);
  CHECK(rows[1]["order"] == 10);
  for (const char* list : {"0x1", "1.0", "1e1", " 1", "0..0x2"}) {
    INFO("'" << list << "'");
    CHECK(run_program({"tip", "builtin:box", "--order", list}).exit_code == 2);
  }
  const ProgramRun range = run_program({"expand", "builtin:box", "--lmax", "0x10"});
  CHECK(range.exit_code == 2);
  CHECK_THAT(range.err, Contains("--lmax") && Contains("hexadecimal") && Contains("from 0 to 4096"));
}

TEST_CASE("tip refuses what is no decimal number in options and in tables", "[number][tip][cli]") {
  const TemporaryFolder folder;
  const auto refused = [&](const std::vector<std::string>& more, int code, const char* word) {
    std::vector<std::string> arguments = {"tip", "builtin:box", "--length", "2m", "--density", "1g/cm3"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramRun run = run_program(arguments);
    INFO(run.err);
    CHECK(run.exit_code == code);
    CHECK_THAT(run.err, Contains(word));
  };
  for (const char* wrong : {"nan", "inf", "0x10", "1,5", ""}) {
    INFO("'" << wrong << "'");
    refused({"--gravity", wrong}, 2, "gravity");
    refused({"--friction", wrong}, 2, "friction");
    refused({"--push", std::string(wrong) + "N:1s"}, 2, "--push");
    refused({"--sustained", std::string(wrong) + "N"}, 2, "--sustained");
    refused({"--contact-tolerance", std::string(wrong) + "m"}, 2, "--contact-tolerance");
    if (std::string(wrong) == "1,5") continue; // two columns of a row too many
    std::ofstream(folder / "push.csv") << "time,force\n0,0\n1," << wrong << "\n";
    refused({"--push", folder / "push.csv"}, 3, "push.csv:3");
  }
  refused({"--push", "1,5N:1s"}, 2, "a point: 1.5");
  const std::string file = folder / "mean.csv";
  REQUIRE(run_program(
              {"expand", "builtin:ellipsoid:1,1,2@2", "--of", "stretch", "--lmax", "2", "--device", "cpu", "-o", file})
              .exit_code == 0);
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  const std::string key = "removed_mean_";
  const std::size_t at = text.str().find(key), value = text.str().find_first_of(" \t", at) + 1;
  REQUIRE(at != std::string::npos);
  for (const char* wrong : {"nan", "inf", "0x10", "1,5", "milk"}) {
    std::string changed = text.str();
    changed.replace(value, changed.find('\n', value) - value, wrong);
    std::ofstream(file) << changed;
    const ProgramRun run = run_program({"tip", file, "--order", "0..2", "--device", "cpu"});
    INFO(wrong << ": " << run.err);
    CHECK(run.exit_code == 3);
    CHECK_THAT(run.err, Contains(key));
  }
  std::ofstream(folder / "push.csv") << "time,force\n0,0\n1,2,5\n";
  refused({"--push", folder / "push.csv"}, 3, "push.csv:3");
}

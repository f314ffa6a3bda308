#include "host/error.hpp"
#include "host/io/file.hpp"
#include "host/report/page.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using nlohmann::json;

namespace {

constexpr const char* stub = "<title><!--cowgpu:title--></title><script>{\"cowgpu\":\"data\"}</script>end";

void write(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// A folder with a page in place of the one that node builds, and a result of a small cow.
struct Reports {
  TemporaryFolder folder;
  ProgramOptions options;

  Reports() {
    options.environment["COWGPU_PAGE"] = folder.path();
    write(folder / "report.html", stub);
    const ProgramRun expand = run_program({"expand", "builtin:cow@1", "--of", "mass,stretch", "--lmax", "6", "--device",
                                           "cpu", "-q", "-o", folder / "cow.json"});
    INFO(expand.err);
    REQUIRE(expand.exit_code == 0);
  }

  ProgramRun report(std::vector<std::string> words) const {
    words.insert(words.begin(), "report");
    words.insert(words.end(), {"--device", "cpu", "-o", folder / "cow.html"});
    return run_program(words, options);
  }

  /// Title and data of the page.
  std::pair<std::string, std::string> parts() const {
    const std::string page = read_file(folder / "cow.html"), between = "</title><script>", tail = "</script>end";
    const std::size_t at = page.find(between);
    REQUIRE(page.rfind("<title>", 0) == 0);
    REQUIRE(at != page.npos);
    REQUIRE(page.substr(page.size() - tail.size()) == tail);
    const std::size_t data = at + between.size();
    return {page.substr(7, at - 7), page.substr(data, page.size() - tail.size() - data)};
  }
};

} // namespace

TEST_CASE("a report puts a result with distances and physics into the page", "[report][cli]") {
  const Reports reports;
  const ProgramRun tensors = run_program({"tensors", "builtin:cow@1", "--json"});
  REQUIRE(tensors.exit_code == 0);
  write(reports.folder / "tensors.json", tensors.out);
  const ProgramRun run = reports.report({reports.folder / "cow.json", "--mesh", "builtin:cow@1", "--physics",
                                         reports.folder / "tensors.json", "--order", "5"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.err, Contains("wrote") && Contains("cow.html"));
  const auto [title, text] = reports.parts();
  CHECK(title == "builtin:cow@1 - cowgpu");
  CHECK(text.find_first_of("<>&") == text.npos);
  const json data = json::parse(text);
  CHECK(data["schema"] == "cowgpu.page.v1");
  CHECK(data["result"]["mesh"]["name"] == "builtin:cow@1");
  CHECK_FALSE(data["result"].contains("expansions"));
  REQUIRE(data["surfaces"].size() == 1);
  const json& surface = data["surfaces"][0];
  CHECK(surface["order"] == 5);
  CHECK(surface["lmax"] == 6);
  CHECK(surface["power"][0].size() == 7);
  CHECK(surface["coefficients"].get<std::string>().size() == 2688); // 6 fields of 21, re and im: 2016 bytes
  for (const char* fields : {"xyz", "f"}) {
    const json& distances = surface["distances"][fields];
    REQUIRE(distances.size() == 6);
    CHECK(distances[5]["rms"].get<double>() < distances[0]["rms"].get<double>());
    CHECK(distances[5]["rms"].get<double>() <= distances[5]["largest"].get<double>());
  }
  CHECK(data["physics"] == json::array({json::parse(tensors.out)}));
  CHECK(data["mesh"]["name"] == "builtin:cow@1");
  CHECK(data["mass"]["lmax"] == 6);
}

TEST_CASE("markup in names and documents cannot leave its place in the page", "[report][cli]") {
  const std::string hostile = "</script><!--<script>&\"x\"";
  const Reports reports;
  json result = json::parse(read_file(reports.folder / "cow.json"));
  result["mesh"]["name"] = hostile;
  result["notes"] = {hostile};
  write(reports.folder / "cow.json", result.dump());
  const json physics = {{"schema", "cowgpu.tip.v1"},
                        {"input", json::object()},
                        {"units", json::object()},
                        {"notes", json::array()},
                        {hostile, hostile}};
  write(reports.folder / "tip.json", physics.dump(2));
  const ProgramRun run = reports.report({reports.folder / "cow.json", "--physics", reports.folder / "tip.json"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const auto [title, text] = reports.parts();
  CHECK(title == "&lt;/script&gt;&lt;!--&lt;script&gt;&amp;&quot;x&quot; - cowgpu");
  CHECK(text.find_first_of("<>&") == text.npos);
  const json data = json::parse(text);
  CHECK(data["result"]["mesh"]["name"] == hostile);
  CHECK(data["physics"][0] == physics);
  CHECK(data["mesh"].is_null());
  CHECK(data["surfaces"][0]["distances"]["xyz"].empty());
}

TEST_CASE("a page holds what the parser read of a document, without its byte order mark", "[report][cli]") {
  const Reports reports;
  const std::string text = "{\"schema\": \"cowgpu.tip.v1\", \"input\": {}, \"units\": {},\n \"notes\": [\"</script>\"],"
                           " \"z\": 1.5e3, \"a\": [-0.0, 1e-300, 12345678901234567]}";
  write(reports.folder / "tip.json", "\xef\xbb\xbf" + text + "\n");
  const ProgramRun run = reports.report({reports.folder / "cow.json", "--physics", reports.folder / "tip.json"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const std::string data = reports.parts().second;
  CHECK(data.find("\xef\xbb\xbf") == std::string::npos);
  CHECK(data.find_first_of("<>&\n") == std::string::npos);
  CHECK(json::parse(data)["physics"] == json::array({json::parse(text)}));
  CHECK(data.find("\"z\":1500.0,\"a\":[-0.0,1e-300,12345678901234567]") != std::string::npos); // in the file's order
}

TEST_CASE("what is wrong with a report is said, and no page is written", "[report][cli]") {
  const Reports reports;
  const std::string cow = reports.folder / "cow.json", other = reports.folder / "other.json";
  const auto refused = [&](const std::vector<std::string>& words, int code, const char* fault, const char* what) {
    const ProgramRun run = reports.report(words);
    INFO(run.err);
    CHECK(run.exit_code == code);
    CHECK_THAT(run.err, Contains(fault) && Contains(what));
    CHECK_FALSE(std::filesystem::exists(reports.folder / "cow.html"));
  };
  refused({cow, "--order", "7"}, 2, "bad-argument", "degrees 0 to 6");
  refused({reports.folder / "none.json"}, 5, "cannot-read", "none.json");
  write(other, "{\"schema\": \"cowgpu.tensors.v1\"}");
  refused({other}, 3, "file-format", "cowgpu expand");
  write(other, "{\"schema\": \"other.v1\"}");
  refused({cow, "--physics", other}, 3, "file-format", "not a document of cowgpu");
  write(other, "{\"schema\": \"cowgpu.tensors.v1\"}");
  refused({cow, "--physics", other}, 3, "file-format", "no findings to show");
  refused({cow, "--physics", cow}, 3, "file-format", "no findings to show");
  write(other, "{\"schema\": \"cowgpu.tip.v1\"");
  refused({cow, "--physics", other}, 3, "file-syntax", "other.json");
  const std::string whole = "{\"schema\": \"cowgpu.tip.v1\", \"input\": {}, \"units\": {}, \"notes\": []}";
  for (const std::string& bad :
       {whole + std::string(1, '\0'), whole + std::string("\0{", 2), std::string(1, '\0') + whole,
        whole.substr(0, 9) + '\0' + whole.substr(9), whole + "\xef\xbb\xbf", whole + whole}) {
    write(other, bad);
    refused({cow, "--physics", other}, 3, "file-syntax", "other.json:1");
  }
  write(other, read_file(cow) + '\0');
  refused({other}, 3, "file-syntax", "other.json");
  write(other, "{\"schema\": \"cowgpu.tip.v1\", \"input\": {}, \"units\": {}, \"notes\": 5}");
  refused({cow, "--physics", other}, 3, "file-format", "'notes' is a list");
  refused({cow, "--mesh", "builtin:nothing"}, 2, "bad-argument", "builtin:nothing");
  write(reports.folder / "report.html", "<html>");
  refused({cow}, 3, "file-format", "not the page");
  std::filesystem::remove(reports.folder / "report.html");
  refused({cow}, 5, "page-missing", "--target page");
}

TEST_CASE("reports and figures tell when a result is of another mesh, and what a page must be called",
          "[report][cli]") {
  const Reports reports;
  const std::string cow = reports.folder / "cow.json", picture = reports.folder / "x.png";
  const ProgramRun other = reports.report({cow, "--mesh", "builtin:box"});
  CHECK(other.exit_code == 0);
  CHECK_THAT(other.err, Contains("another SHA-256") && Contains("warning"));
  CHECK_THAT(reports.report({cow, "--mesh", "builtin:cow@1"}).err, !Contains("warning"));
  const ProgramRun figure = run_program({"figure", "orders", "builtin:box", "--result", cow, "-o", picture});
  CHECK(figure.exit_code == 3);
  CHECK_THAT(figure.err, Contains("another mesh"));
  CHECK_FALSE(std::filesystem::exists(picture));
  const ProgramRun named = run_program({"report", cow, "-o", reports.folder / "cow.pdf"}, reports.options);
  CHECK(named.exit_code == 2);
  CHECK_THAT(named.err, Contains(".html"));
}

TEST_CASE("a report does not overwrite what it reads", "[report][cli]") {
  const Reports reports;
  const std::string cow = reports.folder / "cow.json", before = read_file(cow);
  const ProgramRun run = run_program({"report", cow, "-o", cow, "--device", "cpu"}, reports.options);
  CHECK(run.exit_code == 2);
  CHECK(read_file(cow) == before);
}

TEST_CASE("distances keep to their bytes' precision, and their mean square is by area on the sphere", "[report]") {
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, 8);
  std::vector<double> distances = {2};
  for (int ring = 1; ring + 1 < grid.rings; ++ring)
    for (int j = 0; j < grid.ring_length; ++j)
      distances.push_back(2 * std::abs(double(grid.cosine[std::size_t(ring)])));
  distances.push_back(2);
  const PageDistances found = page_distances(grid, distances);
  CHECK(found.largest == 2);
  CHECK(found.rms == Approx(2 / std::sqrt(3.0)).epsilon(1e-14));
  REQUIRE(found.roots.size() == distances.size());
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const double root = found.roots[i] / 255.0, bound = 2 * (2 * std::sqrt(distances[i] / 2) + 1 / 510.0) / 510;
    CHECK(std::abs(2 * root * root - distances[i]) <= bound * (1 + 1e-12));
  }
  const PageDistances none = page_distances(grid, std::vector<double>(distances.size(), 0.0));
  CHECK(none.largest == 0);
  CHECK(none.rms == 0);
  CHECK(none.roots == std::vector<std::uint8_t>(distances.size(), 0));
}

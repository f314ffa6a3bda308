#include "host/report/findings_report.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace cowgpu;
using namespace cowgpu::physics;

namespace {

Findings with_table() {
  Findings found;
  found.title = "a body";
  found.input_kind = "mesh";
  found.tables = {{"orders", "force by order", {{"order"}, {"force", "N"}, {"held"}}, {}}};
  found.tables[0].rows = {{0.0, -0.0, true}, {std::string("full"), 1234.56789, std::monostate{}}};
  return found;
}

} // namespace

TEST_CASE("a table of findings is a member with columns, units and rows", "[physics]") {
  const auto found = nlohmann::json(findings_json(with_table(), "cowgpu.tip.v1", {"cowgpu", "tip"}));
  CHECK(found["orders"]["columns"] == nlohmann::json({"order", "force", "held"}));
  CHECK(found["orders"]["units"] == nlohmann::json({"", "N", ""}));
  CHECK(found["orders"]["rows"] == nlohmann::json::parse(R"([[0, 0, true], ["full", 1234.56789, null]])"));
}

TEST_CASE("a table of findings stands in aligned columns on the screen", "[physics]") {
  std::string text;
  write_findings(with_table(), [&](std::string_view part) { text += part; });
  CHECK(text == "a body\n"
                "\nforce by order\n"
                "  order  force [N]  held\n"
                "      0          0   yes\n"
                "   full    1234.57     -\n");
}

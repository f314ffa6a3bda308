#include "host/io/document_json.hpp"
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
  const auto found = nlohmann::json::parse(json_text(document(with_table(), "cowgpu.tip.v1", {"cowgpu", "tip"})));
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

TEST_CASE("a table of entries is a list of objects, with columns that the screen leaves out", "[physics]") {
  Findings found = with_table();
  found.tables[0].as_entries = true;
  found.tables[0].columns[2].on_screen = false;
  const auto json = nlohmann::json::parse(json_text(document(found, "cowgpu.tip.v1", {"cowgpu", "tip"})));
  CHECK(json["orders"] == nlohmann::json::parse(R"([{"order": 0, "force": 0, "held": true},
                                                        {"order": "full", "force": 1234.56789, "held": null}])"));
  CHECK(json["units"]["orders.force"] == "N");
  std::string text;
  write_findings(found, [&](std::string_view part) { text += part; });
  CHECK(text == "a body\n"
                "\nforce by order\n"
                "  order  force [N]\n"
                "      0          0\n"
                "   full    1234.57\n");
}

TEST_CASE("a value that there is none of has no unit on the screen, and is null in JSON", "[physics]") {
  Findings found;
  found.title = "a body";
  found.rows = {
      {"mass_kg", "mass", {}, "kg"}, {"lift_s", "lifts off after", {}, "s", "never"}, {"g", "gravity", 9.5, "m"}};
  std::string text;
  write_findings(found, [&](std::string_view part) { text += part; });
  CHECK(text == "a body\n"
                "  mass                                   not known\n"
                "  lifts off after                        never\n"
                "  gravity                                9.5 m\n");
  const auto json = nlohmann::json::parse(json_text(document(found, "cowgpu.tip.v1", {"cowgpu", "tip"})));
  CHECK(json["mass_kg"].is_null());
  CHECK(json["lift_s"].is_null());
  CHECK(json["units"]["lift_s"] == "s");
}

TEST_CASE("remarks in a table's last column begin at one place", "[physics]") {
  Findings found = with_table();
  found.tables[0].rows[0][2] = std::string("a remark that is long");
  found.tables[0].rows[1][2] = std::string("none");
  std::string text;
  write_findings(found, [&](std::string_view part) { text += part; });
  CHECK(text == "a body\n"
                "\nforce by order\n"
                "  order  force [N]  held\n"
                "      0          0  a remark that is long\n"
                "   full    1234.57  none\n");
}

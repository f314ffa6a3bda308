#include "host/io/document_json.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

using namespace cowgpu;

namespace {

CoefficientRows rows(int lmax) {
  return {lmax, [](int l, int m, Numbers& numbers) {
            numbers.push_back(l + 0.5);
            numbers.push_back(-m);
          }};
}

} // namespace

TEST_CASE("a document has a member or an element a line, indented by its level", "[json]") {
  const Object document = {{"name", "a body"},
                           {"flags", List{}},
                           {"about", Object{}},
                           {"grid", Object{{"rings", 3}, {"sizes", Numbers{1, 0.25}}}},
                           {"centre", Vec3(1, -2, 3e300)}};
  CHECK(json_text(document) == "{\n"
                               " \"name\": \"a body\",\n"
                               " \"flags\": [],\n"
                               " \"about\": {},\n"
                               " \"grid\": {\n"
                               "  \"rings\": 3,\n"
                               "  \"sizes\": [\n"
                               "   1.0,\n"
                               "   0.25\n"
                               "  ]\n"
                               " },\n"
                               " \"centre\": [\n"
                               "  1.0,\n"
                               "  -2.0,\n"
                               "  3e+300\n"
                               " ]\n"
                               "}\n");
}

TEST_CASE("a document's coefficients have a row a line, below objects at the left margin", "[json]") {
  const Object document = {
      {"schema", "x"},
      {"expansions", Object{{"mass", Object{{"lmax", 1}, {"coefficients", rows(1)}}},
                            {"smooth", Object{{"grid", Object{{"rings", 2}}}, {"coefficients", rows(0)}}}}}};
  CHECK(json_text(document) == "{\n"
                               " \"schema\": \"x\",\n"
                               " \"expansions\": {\"mass\": {\n"
                               " \"lmax\": 1,\n"
                               " \"coefficients\": [\n"
                               "[0, 0, 0.5, 0],\n"
                               "[1, 0, 1.5, 0],\n"
                               "[1, 1, 1.5, -1]\n"
                               "]},\n"
                               " \"smooth\": {\n"
                               " \"grid\": {\n"
                               "  \"rings\": 2\n"
                               " },\n"
                               " \"coefficients\": [\n"
                               "[0, 0, 0.5, 0]\n"
                               "]}}\n"
                               "}\n");
}

TEST_CASE("values of a document read back as they were, and what is not known is null", "[json]") {
  const std::uint64_t largest = std::numeric_limits<std::uint64_t>::max();
  const Object document = {{"none", {}},
                           {"nan", std::nan("")},
                           {"infinite", Numbers{1, -INFINITY}},
                           {"missing", std::optional<double>()},
                           {"there", std::optional<int>(-7)},
                           {"no text", known_text("")},
                           {"largest", largest},
                           {"third", 1.0 / 3},
                           {"yes", true},
                           {"words", std::vector<std::string>{"a \"b\"\n", "\xff", "\x7f"}},
                           {"matrix", Eigen::Matrix3d(Eigen::Matrix3d::Identity())}};
  const std::string text = json_text(document);
  const auto json = nlohmann::json::parse(text);
  for (const char* key : {"none", "nan", "missing", "no text"}) CHECK(json[key].is_null());
  CHECK(json["infinite"] == nlohmann::json::parse("[1, null]"));
  CHECK(json["there"] == -7);
  CHECK(json["largest"].get<std::uint64_t>() == largest);
  CHECK(json["third"].get<double>() == 1.0 / 3);
  CHECK(json["yes"] == true);
  CHECK(json["words"][0] == "a \"b\"\n");
  CHECK(json["words"][1] == "\xef\xbf\xbd"); // not UTF-8: replaced
  CHECK(json["words"][2] == "\x7f");
  CHECK(text.find('\x7f') == std::string::npos); // a terminal would obey it
  CHECK(json["matrix"] == nlohmann::json::parse("[[1, 0, 0], [0, 1, 0], [0, 0, 1]]"));
}

TEST_CASE("a long document is written in parts that make the same text", "[json]") {
  const Object document = {{"coefficients", rows(150)}};
  std::string text;
  int parts = 0;
  write_json(document, [&](std::string_view part) {
    CHECK(part.size() < 70000);
    text += part;
    ++parts;
  });
  CHECK(parts > 1);
  const auto json = nlohmann::json::parse(text);
  REQUIRE(json["coefficients"].size() == 151 * 152 / 2);
  CHECK(json["coefficients"].back() == nlohmann::json::parse("[150, 150, 150.5, -150]"));
}

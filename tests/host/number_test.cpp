#include "host/number.hpp"

#include <catch2/catch.hpp>

#include <clocale>
#include <cmath>
#include <limits>

using namespace cowgpu;
using Catch::Contains;

TEST_CASE("a number is a sign, digits with or without a point, and an exponent", "[number]") {
  CHECK(read_number("12") == 12.0);
  CHECK(read_number("-0.5") == -0.5);
  CHECK(read_number("+.5") == 0.5);
  CHECK(read_number("5.") == 5.0);
  CHECK(read_number("010") == 10.0);
  CHECK(read_number("1e-3") == 1e-3);
  CHECK(read_number("1E+3") == 1e3);
  CHECK(read_number("0.1") == 0.1);
  CHECK(read_number("9007199254740993") == 9007199254740992.0); // to even
  CHECK(read_number("4.9e-324") == std::numeric_limits<double>::denorm_min());
  CHECK(std::signbit(read_number("-0").value()));
}

TEST_CASE("what is no number to the last character is none, and it is said why", "[number]") {
  for (const auto& [text, why] : std::initializer_list<std::pair<const char*, const char*>>{
           {"", "empty"},
           {"nan", "not finite"},
           {"-NaN", "not finite"},
           {"nan(5)", "not finite"},
           {"inf", "not finite"},
           {"+Infinity", "not finite"},
           {"0x10", "hexadecimal"},
           {"-0X1p3", "hexadecimal"},
           {"1,5", "a point: 1.5"},
           {"-1,5e3", "a point: -1.5e3"},
           {" 8", "blank"},
           {"8 ", "blank"},
           {"8\n", "blank"},
           {"1e400", "beyond the range of doubles"},
           {"1e-400", "beyond the range of doubles"},
           {"+-5", "not a number"},
           {"--5", "not a number"},
           {"1e", "not a number"},
           {"1e+", "not a number"},
           {".", "not a number"},
           {"e5", "not a number"},
           {"1.2.3", "not a number"},
           {"1_000", "not a number"},
           {"5m", "not a number"},
       }) {
    INFO("'" << text << "'");
    CHECK_FALSE(read_number(text));
    CHECK_THAT(not_a_number(text), Contains(why));
    CHECK_FALSE(read_whole(text));
  }
}

TEST_CASE("whole numbers are decimal, whatever zeros stand in front", "[number]") {
  CHECK(read_whole("010") == 10);
  CHECK(read_whole("0008") == 8);
  CHECK(read_whole("+8") == 8);
  CHECK(read_whole("-0") == 0);
  CHECK(read_whole("9223372036854775807") == std::numeric_limits<std::int64_t>::max());
  CHECK(read_whole("-9223372036854775808") == std::numeric_limits<std::int64_t>::min());
  CHECK(read_natural("18446744073709551615") == std::numeric_limits<std::uint64_t>::max());
  CHECK(read_natural("-0") == 0U);
  for (const char* text : {"8.0", "1e3", "0x10", " 8", "8 ", "", "+", "-", "9223372036854775808", "++8"}) {
    INFO("'" << text << "'");
    CHECK_FALSE(read_whole(text));
  }
  for (const char* text : {"-1", "18446744073709551616", "8.0", "-+5", "0x1"}) {
    INFO("'" << text << "'");
    CHECK_FALSE(read_natural(text));
  }
  CHECK(read_whole("7", 0, 7) == 7);
  CHECK_FALSE(read_whole("8", 0, 7));
  CHECK_FALSE(read_whole("-1", 0, 7));
  CHECK_FALSE(read_whole("4294967296", 0U, 4294967295U));
  CHECK_THAT(not_whole("8.0"), Contains("digits alone"));
  CHECK_THAT(not_whole("99999999999999999999"), Contains("too large"));
  CHECK_THAT(not_whole("0x10"), Contains("hexadecimal"));
}

TEST_CASE("a number is taken off the front of a text, and lists have single commas", "[number]") {
  std::string_view text = "2.5km";
  CHECK(take_number(text) == 2.5);
  CHECK(text == "km");
  text = "1e400m";
  CHECK_FALSE(take_number(text));
  CHECK(text == "1e400m");
  text = "3em";
  CHECK(take_number(text) == 3.0);
  CHECK(text == "em");
  CHECK(read_numbers<3>("1,-2,3e1").value() == std::array{1.0, -2.0, 30.0});
  for (const char* list : {"1,2", "1,2,3,4", "1,2,3,", "1, 2,3", "1,,2,3", "1,nan,3", ""}) {
    INFO("'" << list << "'");
    CHECK_FALSE(read_numbers<3>(list));
  }
}

TEST_CASE("numbers do not depend on the locale", "[number][alone]") {
  const char* const german = std::setlocale(LC_ALL, "de_DE.UTF-8");
  CHECK(read_number("1.5") == 1.5);
  CHECK_FALSE(read_number("1,5"));
  if (german) std::setlocale(LC_ALL, "C");
}

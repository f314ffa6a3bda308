#include "host/plot/axis.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace cowgpu::plot;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Range range_of(const std::vector<double>& values, const Axis& axis = {}) {
  const std::span<const double> all = values;
  return axis_range(axis, std::span(&all, 1));
}

/// Labels, with "|" for a small tick.
std::string labels(const Ticks& ticks) {
  std::string all;
  for (const Tick& tick : ticks.ticks) all += tick.label.empty() ? "|" : (all.empty() ? "" : " ") + tick.label;
  return all;
}

Axis logarithmic() {
  Axis axis;
  axis.scale = Scale::logarithmic;
  return axis;
}

} // namespace

TEST_CASE("ticks stand at multiples of 1, 2 or 5 and say so", "[plot]") {
  const auto linear = [](double low, double high, int most) {
    return labels(axis_ticks({low, high}, Scale::linear, most));
  };
  CHECK(linear(0, 1, 6) == "0.0 0.2 0.4 0.6 0.8 1.0");
  CHECK(linear(0, 1, 5) == "0.0 0.5 1.0");
  CHECK(linear(-0.04, 1.04, 12) == "0.0 0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9 1.0");
  CHECK(linear(-3, 7, 6) == "−2 0 2 4 6");
  CHECK(linear(-180, 180, 9) == "−150 −100 −50 0 50 100 150");
  CHECK(linear(0.95, 1.05, 6) == "0.96 0.98 1.00 1.02 1.04");
  CHECK(linear(-0.1, 0.1, 5) == "−0.10 −0.05 0.00 0.05 0.10");
}

TEST_CASE("large and small ticks share a power of ten", "[plot]") {
  const Ticks small = axis_ticks({0, 5e-5}, Scale::linear, 6);
  CHECK(small.power == -5);
  CHECK(labels(small) == "0 1 2 3 4 5");
  CHECK(small.ticks[3].at == 3e-5);
  const Ticks large = axis_ticks({-2.5e7, 1e7}, Scale::linear, 5);
  CHECK(large.power == 7);
  CHECK(labels(large) == "−2 −1 0 1");
  CHECK(axis_ticks({0, 20000}, Scale::linear, 5).power == 0);
}

TEST_CASE("ticks are exact, rise, stay inside and are no more than asked for", "[plot]") {
  for (const double low : {-1e300, -7.3e12, -1.0, 0.0, 1e-280, 0.12345, 99.0, 1e15})
    for (const double size : {1e-270, 3e-9, 0.7, 1.0, 12.0, 5e4, 8e22, 1e299})
      for (const int most : {2, 3, 7, 20}) {
        const std::vector<double> ends = {low, std::min(low + size, 1e300)};
        const Range range = range_of(ends);
        INFO(low << " + " << size << ", " << most << ": " << range.low << " to " << range.high);
        REQUIRE(range.low < range.high);
        const Ticks found = axis_ticks(range, Scale::linear, most);
        CHECK(found.ticks.size() <= std::size_t(most));
        if (most >= 3) CHECK(found.ticks.size() >= 1);
        const double slack = 1e-8 * (range.high / 2 - range.low / 2);
        for (std::size_t i = 0; i < found.ticks.size(); ++i) {
          CHECK(std::isfinite(found.ticks[i].at));
          CHECK(found.ticks[i].at >= range.low - slack);
          CHECK(found.ticks[i].at <= range.high + slack);
          if (i > 0) {
            CHECK(found.ticks[i].at > found.ticks[i - 1].at);
            CHECK(found.ticks[i].label != found.ticks[i - 1].label);
          }
        }
      }
  for (const Tick& tick : axis_ticks({0, 1}, Scale::linear, 11).ticks) CHECK(tick.at == std::round(tick.at * 10) / 10);
}

TEST_CASE("logarithmic axes have their decades, and others between where they are few", "[plot]") {
  const auto decades = [](double low, double high, int most) {
    return labels(axis_ticks({low, high}, Scale::logarithmic, most));
  };
  CHECK(decades(1, 100, 9) == "1 2|| 5|||| 10 20|| 50|||| 100");
  CHECK(decades(1, 1000, 5) == "1|||||||| 10|||||||| 100|||||||| 1000");
  CHECK(decades(1e-8, 1e-5, 5) == "10$^{−8}$|||||||| 10$^{−7}$|||||||| 10$^{−6}$|||||||| 10$^{−5}$");
  CHECK(decades(1e-20, 1, 6) == "10$^{−20}$|||| 10$^{−15}$|||| 10$^{−10}$|||| 10$^{−5}$|||| 10$^{0}$");
  CHECK(decades(0.02, 0.11, 5) == "0.02 0.04 0.06 0.08 0.10");
  const Ticks wide = axis_ticks({1e-300, 1e300}, Scale::logarithmic, 8);
  CHECK(labels(wide) == "10$^{−300}$ 10$^{−200}$ 10$^{−100}$ 10$^{0}$ 10$^{100}$ 10$^{200}$ 10$^{300}$");
  CHECK(wide.ticks[3].at == 1);
}

TEST_CASE("a range holds its data with a margin, and named ends stay", "[plot]") {
  const Range range = range_of({3, 1, 2});
  CHECK(range.low == Approx(1 - 0.08));
  CHECK(range.high == Approx(3 + 0.08));
  Axis from_zero;
  from_zero.low = 0;
  CHECK(range_of({3, 1}, from_zero).low == 0);
  from_zero.high = 2;
  CHECK(range_of({3, 1}, from_zero).high == 2);
  const Range decades = range_of({1e-4, 1}, logarithmic());
  CHECK(std::log10(decades.low) == Approx(-4.16));
  CHECK(std::log10(decades.high) == Approx(0.16));
  CHECK(axis_place(1e-2, {1e-4, 1}, Scale::logarithmic) == Approx(0.5));
  CHECK(axis_place(1e300, {-1e300, 1e300}, Scale::linear) == Approx(1));
}

TEST_CASE("nothing, one value, gaps and absurd numbers still give a range", "[plot]") {
  const auto is = [](const Range& range, double low, double high) {
    INFO(range.low << " to " << range.high);
    CHECK(range.low == Approx(low));
    CHECK(range.high == Approx(high));
  };
  is(range_of({}), 0, 1);
  is(range_of({NAN, infinity, -infinity}), 0, 1);
  is(range_of({}, logarithmic()), 1, 10);
  is(range_of({0, -3, NAN}, logarithmic()), 1, 10);
  is(range_of({5}), 4.5, 5.5);
  is(range_of({0, 0}), -1, 1);
  is(range_of({-2, -2, NAN}), -2.2, -1.8);
  is(range_of({7, 7}, logarithmic()), 0.7, 70);
  is(range_of({1, 1 + 1e-15}), 0.9, 1.1);
  is(range_of({0, 1e-2, infinity}), -0.0004, 0.0104);
  is(range_of({-1e305, 2, 4, 1e308}), 1.92, 4.08);
  is(range_of({-1e300, 1e300}), -1e300, 1e300);
  is(range_of({0, -1, 1e-2, 1e2}, logarithmic()), std::pow(10, -2.16), std::pow(10, 2.16));
  Axis named;
  named.low = 3;
  named.high = 3;
  is(range_of({1, 2}, named), 2.7, 3.3);
}

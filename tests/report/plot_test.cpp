#include "host/colour_scale.hpp"
#include "host/error.hpp"
#include "host/io/file.hpp"
#include "host/plot/label_places.hpp"
#include "host/plot/plot.hpp"
#include "host/plot/text.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <png.h>

#include <cmath>
#include <cstring>
#include <filesystem>

using namespace cowgpu;
using namespace cowgpu::plot;
using test::TemporaryFolder;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Plot falling() {
  Plot plot;
  plot.title = "Power";
  plot.x = {"degree $l$", "", Scale::logarithmic};
  plot.y = {"$S_l$", "m$^2$", Scale::logarithmic};
  Series a{"first", {}, {}}, b{"second", {}, {}};
  for (int l = 1; l <= 64; ++l) {
    a.x.push_back(l), a.y.push_back(std::pow(l, -2.0));
    b.x.push_back(l), b.y.push_back(l % 9 == 0 ? NAN : 1e-3 * std::pow(l, -3.0));
  }
  b.dash = Dash::dashed;
  b.marker = Marker::square;
  plot.series = {a, b};
  plot.points = {{8, 1.0 / 64, "here"}};
  plot.lines = {{true, 20, "limit"}, {false, 1e-5, "$ε$"}};
  plot.regions = {{"allowed", {1, 10}, {-infinity, -infinity}, {1e-4, infinity}}};
  return plot;
}

std::string written(const Plot& plot, const std::string& suffix) {
  const TemporaryFolder folder;
  write_plot(plot, folder / ("x" + suffix));
  return read_file(folder / ("x" + suffix));
}

/// Elements that an XML text opens and closes in their order, with quoted attributes; -1 where it does not.
int xml_elements(const std::string& text) {
  std::vector<std::string> open;
  int elements = 0;
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
    std::size_t end = at;
    for (bool quoted = false; end < text.size() && (quoted || text[end] != '>'); ++end)
      if (text[end] == '"') quoted = !quoted;
    if (end == text.size()) return -1;
    const std::string tag = text.substr(at + 1, end - at - 1);
    at = end;
    if (tag[0] == '?') continue;
    if (tag[0] == '/') {
      if (open.empty() || open.back() != tag.substr(1)) return -1;
      open.pop_back();
      continue;
    }
    ++elements;
    if (tag.back() != '/') open.push_back(tag.substr(0, tag.find_first_of(" \n")));
  }
  return open.empty() ? elements : -1;
}

Image pixels(const std::string& bytes) {
  png_image png;
  std::memset(&png, 0, sizeof png);
  png.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()));
  png.format = PNG_FORMAT_RGBA;
  Image image(int(png.width), int(png.height));
  REQUIRE(png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr));
  return image;
}

Image drawn(const Plot& plot, PlotFrame* frame = nullptr) {
  Canvas canvas(PictureFormat::png, plot_width, plot_height, 1);
  const PlotFrame found = draw(plot, canvas, {8, 6, plot_width - 16, plot_height - 12});
  if (frame) *frame = found;
  return canvas.image();
}

/// Pixels about this colour inside the frame.
int coloured(const Image& image, const Box& box, const Ink& ink, int off = 12) {
  int count = 0;
  for (int y = int(box.y) + 1; y < int(box.bottom()); ++y)
    for (int x = int(box.x) + 1; x < int(box.right()); ++x) {
      const std::uint8_t* p = image.pixel(x, y);
      if (std::abs(p[0] - 255 * ink.r) < off && std::abs(p[1] - 255 * ink.g) < off &&
          std::abs(p[2] - 255 * ink.b) < off)
        ++count;
    }
  return count;
}

Fault fault_of(const Plot& plot, const std::string& name) {
  const TemporaryFolder folder;
  try {
    write_plot(plot, folder / name);
  } catch (const Error& error) {
    CHECK(std::filesystem::is_empty(folder.path()));
    return error.fault();
  }
  FAIL("no error");
  return Fault::check_failed;
}

} // namespace

TEST_CASE("a plot is a PNG of three pixels a point and a well-formed SVG, and the same bytes again", "[plot]") {
  const std::string png = written(falling(), ".png"), svg = written(falling(), ".svg");
  const Image image = pixels(png);
  CHECK(image.width == 3 * plot_width);
  CHECK(image.height == 3 * plot_height);
  CHECK(svg.rfind("<?xml", 0) == 0);
  CHECK(svg.find("width=\"460pt\" height=\"320pt\"") != std::string::npos);
  CHECK(xml_elements(svg) > 100);
  CHECK(svg.find("<image") == std::string::npos);
  CHECK(written(falling(), ".png") == png);
  CHECK(written(falling(), ".svg") == svg);
  CHECK(xml_elements("<a><b/></a>") == 2);
  CHECK(xml_elements("<a><b></a></b>") == -1);
}

TEST_CASE("lines lie where the frame says", "[plot]") {
  Plot plot;
  plot.grid = false;
  plot.series = {{"", {0, 1, 2}, {0, 1, 0}}};
  PlotFrame frame;
  const Image image = drawn(plot, &frame);
  for (const double t : {0.1, 0.4, 0.9}) {
    const Point p = frame.at(t, t);
    CHECK(coloured(image, Box{p.x, p.y, 0, 0}.grown(3), blue) >= 2);
  }
  CHECK(coloured(image, Box{frame.at(1, 0.4).x, frame.at(1, 0.4).y, 0, 0}.grown(8), blue) == 0);
  CHECK(frame.at(frame.x.low, frame.y.low).x == Approx(frame.box.x));
  CHECK(frame.at(frame.x.high, frame.y.high).y == Approx(frame.box.y));
}

TEST_CASE("gaps break a line, and a point alone is a dot", "[plot]") {
  Plot plot;
  plot.grid = false;
  plot.series = {{"", {0, 1, 2, 3, 4, 5}, {1, 1, NAN, 1, infinity, 1}}};
  PlotFrame frame;
  const Image image = drawn(plot, &frame);
  const auto near = [&](double x) {
    const Point p = frame.at(x, 1);
    return coloured(image, Box{p.x, p.y, 0, 0}.grown(4), blue, 60);
  };
  CHECK(near(0.5) > 4);
  CHECK(near(1.5) == 0);
  CHECK(near(2.5) == 0);
  CHECK(near(3) > 1);
  CHECK(near(3.5) == 0);
  CHECK(near(5) > 1);
}

TEST_CASE("plots of nothing, of one point, of equal values and of absurd numbers are drawn", "[plot]") {
  const std::vector<std::pair<std::vector<double>, std::vector<double>>> cases = {
      {{}, {}},
      {{1}, {1}},
      {{0}, {0}},
      {{NAN, NAN}, {1, NAN}},
      {{1, 2, 3}, {5, 5, 5}},
      {{-1e300, 1e300}, {1e300, -1e300}},
      {{-1e308, 0, 1e308}, {infinity, 1, -infinity}},
      {{1e-308, 1e-300, 2e-300}, {1e-280, 3e-280, 1e-281}},
      {{1e15, 1e15 + 1, 1e15 + 2}, {1, 1 + 1e-15, 1 + 2e-15}},
      {{1, 2}, {0, -1}}};
  for (const Scale scale : {Scale::linear, Scale::logarithmic})
    for (const auto& [x, y] : cases) {
      Plot plot;
      plot.x.scale = plot.y.scale = scale;
      plot.series = {{"line", x, y}};
      plot.series[0].marker = Marker::disc;
      for (std::size_t i = 0; i < x.size(); ++i) plot.points.push_back({x[i], y[i], "p"});
      for (const double at : x) plot.lines.push_back({true, at, "v"}), plot.lines.push_back({false, at, "h"});
      plot.regions = {{"r", x, y, std::vector<double>(x.size(), infinity)}};
      INFO(x.size() << " " << (x.empty() ? 0 : x[0]) << (scale == Scale::linear ? " linear" : " logarithmic"));
      const PlotFrame frame = [&] {
        PlotFrame found;
        drawn(plot, &found);
        return found;
      }();
      CHECK(frame.x.low < frame.x.high);
      CHECK(frame.y.low < frame.y.high);
      CHECK(xml_elements(written(plot, ".svg")) > 5);
    }
  // A named window far inside the data: the line crosses it.
  Plot zoomed;
  zoomed.grid = false;
  zoomed.x.low = zoomed.y.low = -1;
  zoomed.x.high = zoomed.y.high = 1;
  zoomed.series = {{"", {-1e12, 1e12}, {-1e12, 1e12}}};
  PlotFrame frame;
  const Image image = drawn(zoomed, &frame);
  CHECK(frame.x.high == 1);
  CHECK(coloured(image, Box{frame.at(0, 0).x, frame.at(0, 0).y, 0, 0}.grown(40), blue, 60) > 50);
}

TEST_CASE("a legend covers no data: it takes a free corner, or stands outside", "[plot]") {
  Plot plot;
  plot.grid = false;
  Series upper{"in the way", {0, 1}, {0, 1}, blue};
  plot.series = {upper};
  PlotFrame frame, alone;
  const Image with = drawn(plot, &frame);
  CHECK(coloured(with, frame.box, blue, 60) > 250); // as long as the way, and the legend's own line
  plot.legend = LegendPlace::none;
  const Image bare = drawn(plot, &alone);
  CHECK(frame.box.width == alone.box.width);
  int changed = 0, hidden = 0;
  for (std::size_t i = 0; i < bare.rgba.size(); i += 4) {
    changed += bare.rgba[i] != with.rgba[i];
    hidden += bare.rgba[i] < 100 && with.rgba[i] > 200;
  }
  CHECK(changed > 100);
  CHECK(hidden == 0);
  plot.legend = LegendPlace::automatic;
  // Everywhere.
  Series full{"everywhere", {}, {}, blue};
  full.line = false;
  full.marker = Marker::disc;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) full.x.push_back(i), full.y.push_back(j);
  plot.series = {full};
  drawn(plot, &frame);
  CHECK(frame.box.width < alone.box.width - 80);
}

TEST_CASE("places for labels are found beside lines and other labels", "[plot]") {
  LabelPlaces places({0, 0, 100, 100});
  places.add_line({0, 50}, {100, 50});
  CHECK(places.cost({10, 10, 20, 10}) == 0);
  CHECK(places.cost({10, 45, 20, 10}) > 0);
  CHECK(places.cost({90, 10, 20, 10}) > 100);
  places.add_box({10, 10, 20, 10});
  const Box candidates[] = {{10, 45, 20, 10}, {12, 12, 20, 10}, {10, 70, 20, 10}, {40, 70, 20, 10}};
  CHECK(places.best(candidates).y == 70);
  CHECK(places.best(candidates).x == 10);
  Point a = {-1e9, 50}, b = {1e9, 50};
  REQUIRE(clip_line(a, b, {0, 0, 100, 100}));
  CHECK(a.x == Approx(0).margin(1e-6));
  CHECK(b.x == Approx(100));
  a = {-5, 0}, b = {0, -5};
  CHECK_FALSE(clip_line(a, b, {0, 0, 100, 100}));
}

TEST_CASE("text between dollars has scripts and slanted letters", "[plot]") {
  const auto shown_runs = [](const char* text) {
    std::string all;
    for (const TextRun& run : text_runs(text))
      all += std::string(all.empty() ? "" : " ") + (run.slanted ? "/" : "") +
             (run.script > 0   ? "^"
              : run.script < 0 ? "_"
                               : "") +
             run.letters;
    return all;
  };
  CHECK(shown_runs("plain_text^2") == "plain_text^2");
  CHECK(shown_runs("$f_{Δθ}$") == "/f _Δ /_θ");
  CHECK(shown_runs("10$^{−3}$ m") == "10 ^−3  m");
  CHECK(shown_runs("$Y_l^m$!") == "/Y /_l /^m !");
  CHECK(shown_runs("cost $$5") == "cost $5");
  CHECK(shown_runs("$x_{open") == "/x /_open");
  CHECK(shown_runs("") == "");
  Canvas canvas(PictureFormat::svg, 10, 10);
  CHECK(canvas.measure("$x_1$").width > canvas.measure("$x$").width);
  CHECK(canvas.measure("$x_1^2$").width < canvas.measure("$x_1$").width + 0.1);
  CHECK(canvas.measure("10$^3$").height() > canvas.measure("103").height());
}

TEST_CASE("colours: viridis rises in lightness, the lines' differ", "[plot]") {
  const auto lightness = [](const Ink& c) {
    return 0.2126 * to_linear(c.r) + 0.7152 * to_linear(c.g) + 0.0722 * to_linear(c.b);
  };
  for (int i = 0; i < 200; ++i) CHECK(lightness(viridis((i + 1) / 200.0)) > lightness(viridis(i / 200.0)));
  CHECK(viridis(-3).b == viridis(0).b);
  CHECK(viridis(7).r == viridis(1).r);
  CHECK(viridis(NAN).r == grey.r);
  CHECK(viridis(0.5).g == Approx(0x91 / 255.0).margin(0.006)); // #21918c
  CHECK(to_linear(0.5) == Approx(0.21404114));
  for (std::size_t i = 0; i < 7; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Ink a = line_colour(i), b = line_colour(j);
      CHECK(std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b) > 0.3);
    }
  CHECK(line_colour(7).b == line_colour(0).b);
}

TEST_CASE("plots that cannot be are refused by name, and no file is left", "[plot]") {
  CHECK(fault_of(falling(), "x.pdf") == Fault::bad_argument);
  CHECK(fault_of(falling(), "x") == Fault::bad_argument);
  CHECK(fault_of(falling(), "none/x.png") == Fault::cannot_write);
  Plot uneven = falling();
  uneven.series[0].x.pop_back();
  CHECK(fault_of(uneven, "x.png") == Fault::bad_argument);
  uneven = falling();
  uneven.regions[0].low.pop_back();
  CHECK(fault_of(uneven, "x.svg") == Fault::bad_argument);
  Plot equal = falling();
  equal.equal_scale = true;
  CHECK(fault_of(equal, "x.svg") == Fault::bad_argument);
  for (const double side : {0.0, -1.0, 1e9, double(NAN)}) CHECK_THROWS_AS(Canvas(PictureFormat::png, side, 100), Error);
  Canvas svg(PictureFormat::svg, 10, 10);
  CHECK_THROWS_AS(svg.image(), Error);
}

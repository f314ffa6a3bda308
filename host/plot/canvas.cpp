#include "host/plot/canvas.hpp"

#include "host/error.hpp"
#include "host/io/png.hpp"
#include "host/plot/text.hpp"

#include <cairo-svg.h>
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu::plot {
namespace {

constexpr double largest_side = 16384; // pixels
// Of DejaVu Sans, parts of its size.
constexpr double capital_height = 0.73, letter_ascent = 0.78, letter_descent = 0.24;
constexpr double script_size = 0.70, raised = 0.36, lowered = 0.18, slant = 0.2;

cairo_status_t append(void* to, const unsigned char* bytes, unsigned length) noexcept {
  try {
    static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(bytes), length);
    return CAIRO_STATUS_SUCCESS;
  } catch (...) {
    return CAIRO_STATUS_NO_MEMORY;
  }
}

struct PlacedRun {
  TextRun run;
  double x, y, size; ///< place of its first letter on the baseline, from the text's own; size of its letters
};

} // namespace

PictureFormat picture_format(const std::filesystem::path& path) {
  const std::string suffix = path.extension();
  if (suffix == ".png") return PictureFormat::png;
  if (suffix == ".svg") return PictureFormat::svg;
  throw Error(Fault::bad_argument, fmt::format("{}: the name of a picture must end in .png or .svg", path.string()));
}

struct Canvas::Page {
  PictureFormat format;
  double width, height, scale;
  std::string svg;
  cairo_surface_t* surface = nullptr;
  cairo_t* cairo = nullptr;

  ~Page() {
    if (cairo) cairo_destroy(cairo);
    if (surface) cairo_surface_destroy(surface);
  }

  void check(cairo_status_t status) const {
    if (status != CAIRO_STATUS_SUCCESS)
      throw Error(Fault::too_large, fmt::format("a picture of {} x {} points cannot be drawn: {}", width, height,
                                                cairo_status_to_string(status)));
  }
  void ink(const Ink& ink) const { cairo_set_source_rgba(cairo, ink.r, ink.g, ink.b, ink.opacity); }
  void ring(std::span<const Point> points) const {
    cairo_new_sub_path(cairo);
    for (const Point& p : points) cairo_line_to(cairo, p.x, p.y);
    cairo_close_path(cairo);
  }
  void pen(const Pen& pen) const {
    ink(pen.colour);
    cairo_set_line_width(cairo, pen.width);
    const double w = std::max(pen.width, 0.8);
    const double dashed[] = {4.5 * w, 3 * w}, dotted[] = {1.2 * w, 2 * w}, mixed[] = {5 * w, 2.5 * w, 1.2 * w, 2.5 * w};
    switch (pen.dash) {
    case Dash::solid: cairo_set_dash(cairo, nullptr, 0, 0); break;
    case Dash::dashed: cairo_set_dash(cairo, dashed, 2, 0); break;
    case Dash::dotted: cairo_set_dash(cairo, dotted, 2, 0); break;
    case Dash::dash_dot: cairo_set_dash(cairo, mixed, 4, 0); break;
    }
    cairo_set_line_cap(cairo, pen.dash == Dash::solid ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
  }
  void stroke(const Pen& with) const {
    pen(with);
    cairo_stroke(cairo);
  }
  void font(const TextRun& run, double size, bool bold) const {
    cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    // Slanted here, as the oblique face is not on every machine.
    cairo_matrix_t matrix;
    cairo_matrix_init(&matrix, size, 0, run.slanted ? -slant * size : 0, size, 0, 0);
    cairo_set_font_matrix(cairo, &matrix);
  }

  /// Runs side by side; a raised one above a lowered one.
  std::vector<PlacedRun> place(std::string_view text, const TextStyle& style, TextSize& size) const {
    std::vector<PlacedRun> placed;
    double x = 0, start = 0; // where the last run began
    int last = 0;
    size = {0, letter_ascent * style.size, letter_descent * style.size};
    for (const TextRun& run : text_runs(text)) {
      const double s = run.script == 0 ? style.size : script_size * style.size;
      const double y = run.script > 0 ? -raised * style.size : run.script < 0 ? lowered * style.size : 0;
      const bool stacked = run.script * last < 0;
      if (!stacked) start = x;
      font(run, s, style.bold);
      cairo_text_extents_t extents;
      cairo_text_extents(cairo, run.letters.c_str(), &extents);
      placed.push_back({run, start, y, s});
      // A slanted letter leans over what is raised behind it.
      const double lean = run.slanted && run.script >= 0 ? 0.04 * s : 0;
      x = std::max(x, start + extents.x_advance + lean);
      size.ascent = std::max(size.ascent, letter_ascent * s - y);
      size.descent = std::max(size.descent, letter_descent * s + y);
      last = run.script;
    }
    size.width = x;
    return placed;
  }

  static Point corner(const Point& at, const TextSize& size, const TextStyle& style) {
    const double dx = style.across == Across::left ? 0 : style.across == Across::middle ? size.width / 2 : size.width;
    const double dy = style.down == Down::top        ? size.ascent
                      : style.down == Down::middle   ? capital_height * style.size / 2
                      : style.down == Down::baseline ? 0
                                                     : -size.descent;
    return {at.x - dx, at.y + dy};
  }
};

Canvas::Canvas(PictureFormat format, double width, double height, double scale) : page_(std::make_unique<Page>()) {
  if (!(width > 0) || !(height > 0) || !(scale > 0) || !(width * scale <= largest_side) ||
      !(height * scale <= largest_side) || width * scale < 1 || height * scale < 1)
    throw Error(Fault::bad_argument, fmt::format("a picture of {} x {} points at {} pixels a point: a side must have 1 "
                                                 "to {} pixels",
                                                 width, height, scale, largest_side));
  Page& page = *page_;
  page.format = format;
  page.width = width;
  page.height = height;
  page.scale = format == PictureFormat::png ? scale : 1;
  page.surface = format == PictureFormat::png
                     ? cairo_image_surface_create(CAIRO_FORMAT_RGB24, int(std::lround(width * scale)),
                                                  int(std::lround(height * scale)))
                     : cairo_svg_surface_create_for_stream(append, &page.svg, width, height);
  page.check(cairo_surface_status(page.surface));
  page.cairo = cairo_create(page.surface);
  page.check(cairo_status(page.cairo));
  cairo_scale(page.cairo, page.scale, page.scale);
  cairo_set_line_join(page.cairo, CAIRO_LINE_JOIN_ROUND);
  cairo_set_fill_rule(page.cairo, CAIRO_FILL_RULE_EVEN_ODD);
  cairo_font_options_t* const options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(page.cairo, options);
  cairo_font_options_destroy(options);
  page.ink(white);
  cairo_rectangle(page.cairo, 0, 0, width, height);
  cairo_fill(page.cairo);
}

Canvas::~Canvas() = default;
Canvas::Canvas(Canvas&&) noexcept = default;
Canvas& Canvas::operator=(Canvas&&) noexcept = default;

double Canvas::width() const {
  return page_->width;
}
double Canvas::height() const {
  return page_->height;
}

void Canvas::line(std::span<const Point> points, const Pen& pen, bool closed) {
  if (points.empty()) return;
  for (const Point& p : points) cairo_line_to(page_->cairo, p.x, p.y);
  if (closed) cairo_close_path(page_->cairo);
  page_->stroke(pen);
}

void Canvas::fill(std::span<const std::span<const Point>> rings, const Ink& ink) {
  page_->ink(ink);
  for (const std::span<const Point> ring : rings) page_->ring(ring);
  cairo_fill(page_->cairo);
}

void Canvas::fill(std::span<const Point> ring, const Ink& ink) {
  fill(std::span(&ring, 1), ink);
}

void Canvas::fill(const Box& box, const Ink& ink) {
  page_->ink(ink);
  cairo_rectangle(page_->cairo, box.x, box.y, box.width, box.height);
  cairo_fill(page_->cairo);
}

void Canvas::frame(const Box& box, const Pen& pen) {
  cairo_rectangle(page_->cairo, box.x, box.y, box.width, box.height);
  page_->stroke(pen);
}

void Canvas::disc(const Point& centre, double radius, const Ink& ink) {
  page_->ink(ink);
  cairo_arc(page_->cairo, centre.x, centre.y, radius, 0, 2 * M_PI);
  cairo_fill(page_->cairo);
}

void Canvas::circle(const Point& centre, double radius, const Pen& pen) {
  cairo_arc(page_->cairo, centre.x, centre.y, radius, 0, 2 * M_PI);
  cairo_close_path(page_->cairo);
  page_->stroke(pen);
}

void Canvas::arc(const Point& centre, double radius, double from, double to, const Pen& pen) {
  const double a = -from * M_PI / 180, b = -to * M_PI / 180; // y is down
  if (b < a)
    cairo_arc_negative(page_->cairo, centre.x, centre.y, radius, a, b);
  else
    cairo_arc(page_->cairo, centre.x, centre.y, radius, a, b);
  page_->stroke(pen);
}

void Canvas::arrow(const Point& from, const Point& to, const Pen& pen, double bend) {
  const double dx = to.x - from.x, dy = to.y - from.y, length = std::hypot(dx, dy);
  if (!(length > 0)) return;
  // A quadratic curve whose middle is off the straight way by bend * length; the left of (dx, dy) is (dy, -dx).
  const Point control = {(from.x + to.x) / 2 + 2 * bend * dy, (from.y + to.y) / 2 - 2 * bend * dx};
  const double ex = to.x - control.x, ey = to.y - control.y, end = std::hypot(ex, ey);
  const double head = std::min(4 + 2 * pen.width, 0.6 * length), ux = ex / end, uy = ey / end;
  const Point neck = {to.x - 0.75 * head * ux, to.y - 0.75 * head * uy};
  cairo_move_to(page_->cairo, from.x, from.y);
  cairo_curve_to(page_->cairo, from.x + (control.x - from.x) * 2 / 3, from.y + (control.y - from.y) * 2 / 3,
                 neck.x + (control.x - neck.x) * 2 / 3, neck.y + (control.y - neck.y) * 2 / 3, neck.x, neck.y);
  page_->stroke(pen);
  const double wide = 0.38 * head;
  const Point triangle[] = {to,
                            {to.x - head * ux - wide * uy, to.y - head * uy + wide * ux},
                            neck,
                            {to.x - head * ux + wide * uy, to.y - head * uy - wide * ux}};
  fill(triangle, pen.colour);
}

void Canvas::text(const Point& at, std::string_view text, const TextStyle& style) {
  TextSize size;
  const std::vector<PlacedRun> runs = page_->place(text, style, size);
  cairo_t* const cairo = page_->cairo;
  cairo_save(cairo);
  cairo_translate(cairo, at.x, at.y);
  cairo_rotate(cairo, -style.angle * M_PI / 180);
  const Point origin = Page::corner({0, 0}, size, style);
  if (style.halo.opacity > 0)
    for (const PlacedRun& placed : runs) {
      page_->font(placed.run, placed.size, style.bold);
      cairo_move_to(cairo, origin.x + placed.x, origin.y + placed.y);
      cairo_text_path(cairo, placed.run.letters.c_str());
      page_->stroke({style.halo, 0.3 * style.size, Dash::solid});
    }
  for (const PlacedRun& placed : runs) {
    page_->font(placed.run, placed.size, style.bold);
    page_->ink(style.colour);
    cairo_move_to(cairo, origin.x + placed.x, origin.y + placed.y);
    cairo_show_text(cairo, placed.run.letters.c_str());
  }
  cairo_new_path(cairo);
  cairo_restore(cairo);
}

TextSize Canvas::measure(std::string_view text, const TextStyle& style) const {
  TextSize size;
  page_->place(text, style, size);
  return size;
}

Box Canvas::text_box(const Point& at, std::string_view text, const TextStyle& style) const {
  const TextSize size = measure(text, style);
  const Point origin = Page::corner(at, size, style);
  return {origin.x, origin.y - size.ascent, size.width, size.height()};
}

void Canvas::picture(const Image& image, const Box& box) {
  if (image.width < 1 || image.height < 1) return;
  cairo_surface_t* const pixels = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, image.width, image.height);
  const auto release = [](cairo_surface_t* surface) { cairo_surface_destroy(surface); };
  const std::unique_ptr<cairo_surface_t, decltype(release)> owner(pixels, release);
  page_->check(cairo_surface_status(pixels));
  unsigned char* const bytes = cairo_image_surface_get_data(pixels);
  const int stride = cairo_image_surface_get_stride(pixels);
  for (int y = 0; y < image.height; ++y) {
    auto* const row = reinterpret_cast<std::uint32_t*>(bytes + std::ptrdiff_t(y) * stride);
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* p = image.pixel(x, y);
      const std::uint32_t a = p[3];
      const auto times = [a](std::uint32_t c) { return (c * a + 127) / 255; };
      row[x] = a << 24 | times(p[0]) << 16 | times(p[1]) << 8 | times(p[2]);
    }
  }
  cairo_surface_mark_dirty(pixels);
  cairo_save(page_->cairo);
  cairo_translate(page_->cairo, box.x, box.y);
  cairo_scale(page_->cairo, box.width / image.width, box.height / image.height);
  cairo_set_source_surface(page_->cairo, pixels, 0, 0);
  cairo_pattern_set_filter(cairo_get_source(page_->cairo), CAIRO_FILTER_BEST);
  cairo_paint(page_->cairo);
  cairo_restore(page_->cairo);
}

void Canvas::clip(const Box& box) {
  cairo_save(page_->cairo);
  cairo_rectangle(page_->cairo, box.x, box.y, box.width, box.height);
  cairo_clip(page_->cairo);
}

void Canvas::clip(std::span<const Point> ring) {
  cairo_save(page_->cairo);
  page_->ring(ring);
  cairo_clip(page_->cairo);
}

void Canvas::end_clip() {
  cairo_restore(page_->cairo);
}

Image Canvas::image() const {
  if (page_->format != PictureFormat::png) throw Error(Fault::bad_argument, "an SVG page has no pixels");
  page_->check(cairo_status(page_->cairo));
  cairo_surface_flush(page_->surface);
  const unsigned char* const bytes = cairo_image_surface_get_data(page_->surface);
  const int stride = cairo_image_surface_get_stride(page_->surface);
  Image image(cairo_image_surface_get_width(page_->surface), cairo_image_surface_get_height(page_->surface));
  for (int y = 0; y < image.height; ++y) {
    const auto* const row = reinterpret_cast<const std::uint32_t*>(bytes + std::ptrdiff_t(y) * stride);
    for (int x = 0; x < image.width; ++x) {
      std::uint8_t* const p = image.pixel(x, y);
      p[0] = std::uint8_t(row[x] >> 16);
      p[1] = std::uint8_t(row[x] >> 8);
      p[2] = std::uint8_t(row[x]);
      p[3] = 255;
    }
  }
  return image;
}

void Canvas::write(AtomicFile& file) {
  if (page_->format == PictureFormat::png) return write_png(image(), file);
  page_->check(cairo_status(page_->cairo));
  cairo_surface_finish(page_->surface);
  page_->check(cairo_surface_status(page_->surface));
  // Cairo counts its surfaces; the number would be another one each time.
  std::string& svg = page_->svg;
  const std::size_t id = svg.find(" id=\"surface");
  if (id != std::string::npos) svg.erase(id, svg.find('"', id + 5) + 1 - id);
  file.write(svg);
}

} // namespace cowgpu::plot

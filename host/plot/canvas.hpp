// A page to draw on, through Cairo: one set of calls gives a PNG or an SVG.
#pragma once

#include "host/image.hpp"
#include "host/io/atomic_file.hpp"
#include "host/plot/colours.hpp"

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace cowgpu::plot {

enum class PictureFormat { png, svg };

/// By the name's end, .png or .svg. Throws Error(bad_argument) for others.
PictureFormat picture_format(const std::filesystem::path& path);

/// A place on the page: points (1/72 inch) from its upper left corner, y down.
struct Point {
  double x = 0, y = 0;
};

struct Box {
  double x = 0, y = 0, width = 0, height = 0; ///< upper left corner; both sizes at least 0
  double right() const { return x + width; }
  double bottom() const { return y + height; }
  Point middle() const { return {x + width / 2, y + height / 2}; }
  bool holds(const Point& p) const { return p.x >= x && p.x <= right() && p.y >= y && p.y <= bottom(); }
  bool meets(const Box& b) const { return x < b.right() && b.x < right() && y < b.bottom() && b.y < bottom(); }
  Box grown(double by) const { return {x - by, y - by, width + 2 * by, height + 2 * by}; }
};

enum class Dash { solid, dashed, dotted, dash_dot };

struct Pen {
  Ink colour = black;
  double width = 1; ///< points
  Dash dash = Dash::solid;
};

/// Which of its own points a text is placed by.
enum class Across { left, middle, right };
enum class Down { top, middle, baseline, bottom };

struct TextStyle {
  double size = 10; ///< points
  Ink colour = black;
  Across across = Across::left;
  Down down = Down::baseline;
  bool bold = false;
  double angle = 0;          ///< degrees, counter-clockwise about the place
  Ink halo = white.faded(0); ///< a rim behind the letters, so that they stand out from lines
};

/// Of a text that is not turned: `ascent` above the baseline and `descent` below it hold everything.
struct TextSize {
  double width = 0, ascent = 0, descent = 0;
  double height() const { return ascent + descent; }
};

/// Text is UTF-8 in DejaVu Sans, whose letters fontconfig finds. Between dollar signs it is mathematics: Latin and small
/// Greek letters slant, "_x" and "_{xyz}" are lowered, "^x" and "^{xyz}" raised (one after the other: above each other).
/// "$f_{Δθ}$", "10$^{-3}$". A dollar sign itself is "$$".
///
/// The same calls give the same bytes with one version of Cairo and of the font.
class Canvas {
public:
  /// A white page. `scale`: pixels a point, of PNG. Throws Error(bad_argument) for a size that is not above 0 or beyond 16384
  /// pixels, too_large where there is no memory.
  Canvas(PictureFormat format, double width, double height, double scale = 3);
  ~Canvas();
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;

  double width() const;
  double height() const;

  void line(std::span<const Point> points, const Pen& pen, bool closed = false);
  /// Even-odd: what several rings hold an odd number of times.
  void fill(std::span<const std::span<const Point>> rings, const Ink& ink);
  void fill(std::span<const Point> ring, const Ink& ink);
  void fill(const Box& box, const Ink& ink);
  void frame(const Box& box, const Pen& pen);
  void disc(const Point& centre, double radius, const Ink& ink);
  void circle(const Point& centre, double radius, const Pen& pen);
  /// From the angle `from` to `to`, degrees counter-clockwise from the right, the short way round or the long, as they say.
  void arc(const Point& centre, double radius, double from, double to, const Pen& pen);
  /// With a head of 4 + 2 pen widths at `to`. `bend`: how far the middle lies to the left of the straight way, a part of
  /// its length.
  void arrow(const Point& from, const Point& to, const Pen& pen, double bend = 0);
  void text(const Point& at, std::string_view text, const TextStyle& style = {});
  TextSize measure(std::string_view text, const TextStyle& style = {}) const;
  /// The box of a text that is not turned.
  Box text_box(const Point& at, std::string_view text, const TextStyle& style) const;
  /// Scaled to fill the box. An SVG has its pixels inside.
  void picture(const Image& image, const Box& box);
  /// Until end_clip() nothing is drawn outside.
  void clip(const Box& box);
  void clip(std::span<const Point> ring);
  void end_clip();

  /// The page so far, of PNG pages only (else Error(bad_argument)).
  Image image() const;
  /// Writes the page; the caller commits the file. Nothing can be drawn afterwards. Throws what write_png throws,
  /// too_large, cannot_write.
  void write(AtomicFile& file);

private:
  struct Page;
  std::unique_ptr<Page> page_;
};

} // namespace cowgpu::plot

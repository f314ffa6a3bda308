#include "host/cli/potential_places.hpp"

#include "host/cli/commands.hpp"
#include "host/error.hpp"
#include "host/io/point_file.hpp"
#include "host/io/shown.hpp"
#include "host/number.hpp"
#include "host/sphere_directions.hpp"
#include "host/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

namespace cowgpu::cli {
namespace {

constexpr int most_along_plane = 8192;

// "1.5R", "2m" or "2"; R is the body's sphere.
double parse_reach(const char* option, const std::string& text, const PlaceFrame& frame) {
  if (text.ends_with('R')) {
    const Measure many = parse_measure(option, std::string_view(text).substr(0, text.size() - 1), Dimension::length);
    if (!many.has_unit) return many.value * frame.radius;
  }
  const Measure length = parse_measure(option, text, Dimension::length);
  if (length.has_unit && !frame.metric)
    throw Error(
        Fault::bad_argument,
        fmt::format("{} {}: a length with a unit needs the mesh's: add --length-unit or --length; a bare number "
                    "is in the mesh's unit, and 1.5R is one and a half times its sphere",
                    option, text));
  return length.value;
}

struct Plane {
  int axis = 0, count = 0;
  std::string offset, extent;
};

Plane parse_plane(const std::string& text) {
  const auto refuse = [&] {
    return Error(
        Fault::bad_argument,
        fmt::format("--plane {}: it takes AXIS,OFFSET,EXTENT,N: the axis x, y or z across it, where it cuts that, "
                    "how far it goes to all four sides, and 2 to {} points along each; such as z,0,2R,101",
                    shown(text), most_along_plane));
  };
  std::vector<std::string> words;
  std::istringstream in(text);
  for (std::string word; std::getline(in, word, ',');) words.push_back(word);
  if (words.size() != 4 || words[0].size() != 1 || words[0][0] < 'x' || words[0][0] > 'z') throw refuse();
  Plane plane{words[0][0] - 'x', 0, words[1], words[2]};
  const auto count = read_whole(words[3], 2, most_along_plane);
  if (!count) throw refuse();
  plane.count = *count;
  return plane;
}

void add_plane(const std::string& text, const PlaceFrame& frame, Places& places) {
  const Plane plane = parse_plane(text);
  const double offset = parse_reach("--plane", plane.offset, frame),
               extent = parse_reach("--plane", plane.extent, frame);
  if (!(extent > 0))
    throw Error(Fault::bad_argument,
                fmt::format("--plane {}: a plane of the extent {} has no points", text, plane.extent));
  const int u = (plane.axis + 1) % 3, v = (plane.axis + 2) % 3;
  const double step = 2 * extent / (plane.count - 1);
  for (int j = 0; j < plane.count; ++j)
    for (int i = 0; i < plane.count; ++i) {
      Vec3 p = frame.origin;
      p[plane.axis] += offset;
      p[u] += i * step - extent;
      p[v] += j * step - extent;
      places.points.push_back(p);
    }
  places.name = fmt::format("plane across {} at {:.6g} from the origin, {} x {} points up to {:.6g} from its middle",
                            "xyz"[plane.axis], offset, plane.count, plane.count, extent);
}

void add_sphere(const PlaceOptions& options, const PlaceFrame& frame, Places& places) {
  places.radius = parse_reach("--sphere", options.sphere, frame);
  if (!(places.radius > 0))
    throw Error(Fault::bad_argument, fmt::format("--sphere {}: the radius must be above 0", options.sphere));
  places.grid = make_grid(GridKind::gauss_legendre, options.resolution - 1);
  const SphereDirections to(*places.grid);
  for (int i = 0; i < places.grid->rings; ++i)
    for (int j = 0; j < places.grid->ring_length; ++j)
      places.points.emplace_back(frame.origin + places.radius * to(i, j));
  places.name = fmt::format("sphere of radius {:.6g} about the origin, {} rings of {} points", places.radius,
                            places.grid->rings, places.grid->ring_length);
}

} // namespace

std::size_t count_places(const PlaceOptions& options) {
  if (!options.sphere.empty()) return std::size_t(options.resolution) * std::size_t(2 * options.resolution + 16);
  if (options.plane.empty()) return 0;
  const auto n = std::size_t(parse_plane(options.plane).count);
  return n * n;
}

Places read_places(const PlaceOptions& options, const PlaceFrame& frame) {
  const int given = int(!options.at.empty()) + int(!options.sphere.empty()) + int(!options.plane.empty());
  if (given != 1)
    throw Error(Fault::bad_argument, "--at, --sphere or --plane says where the potential is wanted: give one of them");
  Places places;
  if (!options.sphere.empty()) {
    add_sphere(options, frame, places);
  } else if (!options.plane.empty()) {
    add_plane(options.plane, frame, places);
  } else if (const auto point = parse_point(options.at)) {
    places.points = {*point};
    places.name = options.at;
  } else {
    std::error_code none;
    const bool numbers = options.at.find_first_not_of("0123456789+-.eE,; ") == std::string::npos;
    if ((numbers || std::count(options.at.begin(), options.at.end(), ',') == 2) && options.at != "-" &&
        !std::filesystem::exists(options.at, none))
      throw Error(Fault::bad_argument,
                  fmt::format("--at {}: it takes X,Y,Z, three finite numbers in the body's coordinates, or a file of "
                              "points",
                              shown(options.at)));
    places.points = read_points(options.at);
    places.name = options.at;
  }
  return places;
}

} // namespace cowgpu::cli

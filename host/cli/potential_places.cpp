#include "host/cli/potential_places.hpp"

#include "host/cli/commands.hpp"
#include "host/error.hpp"
#include "host/io/point_file.hpp"
#include "host/io/shown.hpp"
#include "host/number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string_view>

namespace cowgpu::cli {
namespace {

// "1.5R", "2m" or "2"; R is the body's sphere.
Reach parse_reach(const char* option, const std::string& text) {
  if (text.ends_with('R')) {
    const Measure many = parse_measure(option, std::string_view(text).substr(0, text.size() - 1), Dimension::length);
    if (!many.has_unit) return {many, true};
  }
  return {parse_measure(option, text, Dimension::length), false};
}

PlaneRequest parse_plane(const std::string& text) {
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
  const auto count = read_whole(words[3], 2, most_along_plane);
  if (!count) throw refuse();
  return {words[0][0] - 'x', parse_reach("--plane", words[1]), parse_reach("--plane", words[2]), *count};
}

GridRequest parse_grid(const std::string& text) {
  const std::size_t comma = text.find(',');
  const auto count = comma == std::string::npos
                         ? std::nullopt
                         : read_whole(std::string_view(text).substr(comma + 1), 2, most_along_grid);
  if (!count)
    throw Error(
        Fault::bad_argument,
        fmt::format("--grid {}: it takes EXTENT,N: how far it goes from the origin to all six sides, and 2 to {} "
                    "points along each axis; such as 2R,51",
                    shown(text), most_along_grid));
  return {parse_reach("--grid", text.substr(0, comma)), *count};
}

} // namespace

PlaceRequest parse_places(const PlaceOptions& options) {
  const int given = int(!options.at.empty()) + int(!options.sphere.empty()) + int(!options.plane.empty()) +
                    int(!options.grid.empty());
  if (given != 1)
    throw Error(Fault::bad_argument,
                "--at, --sphere, --plane or --grid says where the potential is wanted: give one of them");
  if (!options.sphere.empty()) return SphereRequest{parse_reach("--sphere", options.sphere), options.resolution};
  if (!options.grid.empty()) return parse_grid(options.grid);
  if (!options.plane.empty()) return parse_plane(options.plane);
  if (const auto point = parse_point(options.at)) return PointsRequest{{*point}, options.at};
  std::error_code none;
  const bool numbers = options.at.find_first_not_of("0123456789+-.eE,; ") == std::string::npos;
  if ((numbers || std::count(options.at.begin(), options.at.end(), ',') == 2) && options.at != "-" &&
      !std::filesystem::exists(options.at, none))
    throw Error(Fault::bad_argument,
                fmt::format("--at {}: it takes X,Y,Z, three finite numbers in the body's coordinates, or a file of "
                            "points",
                            shown(options.at)));
  return PointsRequest{read_points(options.at), options.at};
}

} // namespace cowgpu::cli

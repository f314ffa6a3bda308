#include "host/cli/expansion_words.hpp"

#include "host/error.hpp"
#include "host/number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>

namespace cowgpu::cli {
namespace {

// Where a method stands among made_maps.
std::size_t place(MapMethod method) {
  return std::size_t(std::find(made_maps.begin(), made_maps.end(), method) - made_maps.begin());
}

} // namespace

ExpansionChoice parse_expansions(const std::string& of, const std::string& recipe, const std::string& map_file,
                                 int lmax) {
  ExpansionChoice choice;
  choice.map_file = map_file;
  choice.lmax = lmax;
  choice.paper = recipe == "paper";
  std::array<bool, made_maps.size()> wanted{};
  std::istringstream list(of + ",");
  for (std::string word; std::getline(list, word, ',');) {
    if (word == "all") {
      choice.mass = true;
      wanted.fill(true);
    } else if (word == "mass")
      choice.mass = true;
    else if (const auto map = map_method_named(word))
      wanted[place(*map)] = true;
    else
      throw Error(
          Fault::bad_argument,
          fmt::format("--of {}: there is no expansion \"{}\"; there are mass, harmonic, stretch, smooth, flow and "
                      "all, separated by commas",
                      of, word));
  }
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (wanted[i]) choice.maps.push_back(made_maps[i]);
  const bool flow = wanted[place(MapMethod::flow)];
  if (choice.paper && !wanted[place(MapMethod::harmonic)] && !flow)
    throw Error(
        Fault::bad_argument,
        fmt::format("--recipe paper is about the harmonic map and the flow, and --of {} asks for neither; add --of "
                    "harmonic or --of flow",
                    of));
  if (!map_file.empty() && (choice.maps.size() != 1 || flow))
    throw Error(Fault::bad_argument,
                fmt::format("--map {}: the file is one map, and --of {} asks for {}; name the one that it stands for "
                            "with --of harmonic, stretch or smooth",
                            map_file, of,
                            choice.maps.empty()      ? "none"
                            : choice.maps.size() > 1 ? "several"
                                                     : "the flow, whose map is not kept in a file"));
  return choice;
}

double parse_flow_time(const std::string& text) {
  if (text == "auto") return 0;
  const auto time = read_number(text);
  if (!time || !(*time > 0))
    throw Error(Fault::bad_argument,
                fmt::format("--time {}: it must be auto or a number above 0, in the mesh's length unit", text));
  return *time;
}

} // namespace cowgpu::cli

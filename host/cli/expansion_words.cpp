#include "host/cli/expansion_words.hpp"

#include "host/coefficient_set.hpp"
#include "host/error.hpp"
#include "host/number.hpp"
#include "host/requests/paper_recipe.hpp"

#include <fmt/format.h>

#include <set>
#include <sstream>

namespace cowgpu::cli {

ExpansionChoice parse_expansions(const std::string& of, const std::string& recipe, const std::string& map_file,
                                 int lmax) {
  ExpansionChoice choice;
  choice.map_file = map_file;
  choice.lmax = lmax;
  std::set<MapMethod> wanted; // in the order of made_maps
  std::istringstream list(of + ",");
  for (std::string word; std::getline(list, word, ',');) {
    if (word == "all") {
      choice.mass = true;
      wanted.insert(made_maps.begin(), made_maps.end());
    } else if (word == mass_expansion)
      choice.mass = true;
    else if (const auto map = map_method_named(word))
      wanted.insert(*map);
    else
      throw Error(
          Fault::bad_argument,
          fmt::format("--of {}: there is no expansion \"{}\"; there are mass, harmonic, stretch, smooth, flow and "
                      "all, separated by commas",
                      of, word));
  }
  choice.maps.assign(wanted.begin(), wanted.end());
  if (recipe == "paper") take_paper_recipe(choice);
  check_expansions(choice);
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

SurfaceFields parse_fields(const std::string& text) {
  if (text == "xyz") return SurfaceFields::xyz;
  if (text == "f") return SurfaceFields::f;
  throw Error(Fault::bad_argument, fmt::format("--fields {}: it must be xyz or f", text));
}

} // namespace cowgpu::cli

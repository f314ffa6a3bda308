#include "host/requests/paper_recipe.hpp"

#include "host/error.hpp"
#include "host/paper/printed.hpp"
#include "host/units.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {

BodyRequest paper_body() {
  BodyRequest body;
  body.mesh = "benchmark";
  body.length_unit = paper::number("radiation", "length unit in m");
  body.density = 1000;
  return body;
}

RadiateRequest paper_radiation() {
  RadiateRequest request;
  request.body = paper_body();
  request.time = (13.787e9 - 12e6) * julian_year;
  return request;
}

void take_paper_recipe(ExpansionChoice& choice) {
  std::vector<std::string_view> words;
  if (choice.mass) words.emplace_back("mass");
  for (const MapMethod map : choice.maps) words.push_back(name(map));
  if (std::none_of(choice.maps.begin(), choice.maps.end(),
                   [](MapMethod map) { return map == MapMethod::harmonic || map == MapMethod::flow; }))
    throw Error(
        Fault::bad_argument,
        fmt::format("--recipe paper is about the harmonic map and the flow, and --of {} asks for neither; add --of "
                    "harmonic or --of flow",
                    fmt::join(words, ",")));
  choice.harmonic = paper::harmonic_map();
  choice.flow.meaning = FlowMeaning::steps;
  choice.flow.time = paper::flow_time;
  choice.flow.step = paper::flow_step;
  choice.reading = {true, false, true, true, true, "paper"};
}

} // namespace cowgpu

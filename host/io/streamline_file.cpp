#include "host/io/streamline_file.hpp"

#include "host/io/number.hpp"
#include "host/io/shown.hpp"
#include "host/version.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <iterator>
#include <utility>

namespace cowgpu {
namespace {

using nlohmann::ordered_json;

constexpr std::array<std::pair<FlowFlag, const char*>, 7> flag_names = {{{flow_slid, "slid"},
                                                                         {flow_stationary, "stationary"},
                                                                         {flow_inside, "inside"},
                                                                         {flow_restarted, "restarted"},
                                                                         {flow_unfinished, "unfinished"},
                                                                         {flow_surface, "surface"},
                                                                         {flow_notch, "notch"}}};

ordered_json vector_json(const Vec3& x) {
  return {x.x(), x.y(), x.z()};
}

std::string vector_text(const Vec3& x) {
  return fmt::format("{},{},{}", x.x() + 0., x.y() + 0., x.z() + 0.); // no -0
}

} // namespace

void write_streamlines_csv(const StreamlineTable& table, const std::function<void(std::string_view)>& sink) {
  const Vec3 u = table.plane.u(), v = table.plane.v();
  const FlowPoints& lines = table.found.lines;
  std::string text =
      fmt::format("# cowgpu {}\n# mesh {}\n# sha256 {}\n# normal {}\n# offset {}\n# axis_u {}\n# axis_v {}\n"
                  "# origin {}\n# time {}\n"
                  "line,time,x,y,z,u,v,height,distance,direction_u,direction_v,flags\n",
                  version, one_line(table.mesh), table.sha256, vector_text(table.plane.normal), table.plane.offset,
                  vector_text(u), vector_text(v), vector_text(table.origin), table.time);
  for (std::size_t i = 0; i < lines.positions.size(); ++i)
    for (std::size_t k = lines.first[i]; k < lines.first[i + 1]; ++k) {
      const Vec3 &x = lines.path[k], direction = (x - table.origin).stableNormalized();
      fmt::format_to(std::back_inserter(text), "{},", i);
      for (const double value : {lines.path_times[k], x.x(), x.y(), x.z(), u.dot(x), v.dot(x), table.plane.height(x),
                                 table.found.distances[k], u.dot(direction), v.dot(direction)}) {
        append_number(text, value + 0.); // no -0
        text += ',';
      }
      fmt::format_to(std::back_inserter(text), "{}\n", lines.flags[i]);
      if (text.size() > 65536) {
        sink(text);
        text.clear();
      }
    }
  sink(text);
}

ordered_json streamlines_json(const StreamlineTable& table) {
  const Vec3 u = table.plane.u(), v = table.plane.v();
  const FlowPoints& lines = table.found.lines;
  ordered_json cut = ordered_json::array(), all = ordered_json::array();
  for (const CutLoop& loop : table.cut) {
    ordered_json points = ordered_json::array();
    for (const Vec3& x : loop.points) points.push_back({x.x(), x.y(), x.z(), u.dot(x), v.dot(x)});
    cut.push_back({{"length", loop.length}, {"points", std::move(points)}});
  }
  for (std::size_t i = 0; i < lines.positions.size(); ++i) {
    ordered_json path = ordered_json::array(), flags = ordered_json::array();
    for (std::size_t k = lines.first[i]; k < lines.first[i + 1]; ++k) {
      const Vec3& x = lines.path[k];
      path.push_back({lines.path_times[k], x.x(), x.y(), x.z(), u.dot(x), v.dot(x), table.found.distances[k]});
    }
    for (const auto& [flag, word] : flag_names)
      if (lines.flags[i] & flag) flags.push_back(word);
    const Vec3& direction = table.found.directions[i];
    ordered_json line = {{"flags", std::move(flags)},
                         {"slide_time", lines.slide_times[i]}, // infinite is null
                         {"direction", vector_json(direction)},
                         {"circle", {u.dot(direction), v.dot(direction)}},
                         {"path", std::move(path)}};
    if (!table.starts.loops.empty()) line["loop"] = table.starts.loops[i];
    all.push_back(std::move(line));
  }
  const FlowReport& counts = table.found.report;
  return {{"mesh", {{"name", table.mesh}, {"sha256", table.sha256}}},
          {"plane",
           {{"normal", vector_json(table.plane.normal)},
            {"offset", table.plane.offset},
            {"axis_u", vector_json(u)},
            {"axis_v", vector_json(v)}}},
          {"origin", vector_json(table.origin)},
          {"time", table.time},
          {"tolerance", table.tolerance},
          {"counts",
           {{"lines", counts.points},
            {"slid", counts.slid},
            {"stationary", counts.stationary},
            {"inside", counts.inside},
            {"restarted", counts.restarted},
            {"unfinished", counts.unfinished}}},
          {"cut", std::move(cut)},
          {"lines", std::move(all)}};
}

} // namespace cowgpu

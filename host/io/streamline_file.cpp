#include "host/io/streamline_file.hpp"

#include "host/io/number.hpp"
#include "host/io/shown.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <array>
#include <iterator>
#include <utility>

namespace cowgpu {
namespace {

constexpr std::array<std::pair<FlowFlag, const char*>, 7> flag_names = {{{flow_slid, "slid"},
                                                                         {flow_stationary, "stationary"},
                                                                         {flow_inside, "inside"},
                                                                         {flow_restarted, "restarted"},
                                                                         {flow_unfinished, "unfinished"},
                                                                         {flow_surface, "surface"},
                                                                         {flow_notch, "notch"}}};

std::string vector_text(const Vec3& x) {
  return fmt::format("{},{},{}", x.x() + 0., x.y() + 0., x.z() + 0.); // no -0
}

} // namespace

void write_streamlines_csv(const StreamlineTable& table, const Sink& sink) {
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

Object members(const StreamlineTable& table) {
  const Vec3 u = table.plane.u(), v = table.plane.v();
  const FlowPoints& lines = table.found.lines;
  List cut, all;
  for (const CutLoop& loop : table.cut) {
    List points;
    for (const Vec3& x : loop.points) points.push_back(Numbers{x.x(), x.y(), x.z(), u.dot(x), v.dot(x)});
    cut.push_back(Object{{"length", loop.length}, {"points", std::move(points)}});
  }
  for (std::size_t i = 0; i < lines.positions.size(); ++i) {
    List path, flags;
    for (std::size_t k = lines.first[i]; k < lines.first[i + 1]; ++k) {
      const Vec3& x = lines.path[k];
      path.push_back(Numbers{lines.path_times[k], x.x(), x.y(), x.z(), u.dot(x), v.dot(x), table.found.distances[k]});
    }
    for (const auto& [flag, word] : flag_names)
      if (lines.flags[i] & flag) flags.push_back(word);
    const Vec3& direction = table.found.directions[i];
    Object line = {{"flags", std::move(flags)},
                   {"slide_time", lines.slide_times[i]}, // infinite where it does not slide
                   {"direction", direction},
                   {"circle", Numbers{u.dot(direction), v.dot(direction)}},
                   {"path", std::move(path)}};
    if (!table.starts.loops.empty()) line.add("loop", table.starts.loops[i]);
    all.push_back(std::move(line));
  }
  const FlowReport& counts = table.found.report;
  return {
      {"mesh", Object{{"name", table.mesh}, {"sha256", table.sha256}}},
      {"plane", Object{{"normal", table.plane.normal}, {"offset", table.plane.offset}, {"axis_u", u}, {"axis_v", v}}},
      {"origin", table.origin},
      {"time", table.time},
      {"tolerance", table.tolerance},
      {"counts", Object{{"lines", counts.points},
                        {"slid", counts.slid},
                        {"stationary", counts.stationary},
                        {"inside", counts.inside},
                        {"restarted", counts.restarted},
                        {"unfinished", counts.unfinished}}},
      {"cut", std::move(cut)},
      {"lines", std::move(all)}};
}

} // namespace cowgpu

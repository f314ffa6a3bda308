#include "host/report/streamlines_report.hpp"

#include "host/report/document_parts.hpp"
#include "host/report/flow_result.hpp"

#include <fmt/format.h>

namespace cowgpu {

Object document(const StreamlinesResult& result, const std::vector<std::string>& command) {
  Object all = opening("cowgpu.streamlines.v1", command);
  all.add(members(result.table));
  all.add({{"device", members(result.device)},
           {"notes", result.notes},
           {"timings", Object{{"read", result.read_seconds}, {"flow", result.flow_seconds}}}});
  return all;
}

void write_streamlines(const StreamlinesResult& result, const std::string& plane, const Sink& sink) {
  const StreamlineTable& table = result.table;
  sink(mesh_line(result.mesh) + "\n");
  for (const std::string& note : result.notes) sink("note: " + note + "\n");
  double length = 0;
  for (const CutLoop& loop : table.cut) length += loop.length;
  sink(fmt::format("cut: plane {}, {} closed line{} of length {:.9g}\n", plane, table.cut.size(),
                   table.cut.size() == 1 ? "" : "s", length));
  sink(fmt::format("streamlines: to t = {:.6g}; {}\n", table.time, flow_points_text(table.found.report)));
  sink(fmt::format("time: read {:.3f} s, flow {:.3f} s\n", result.read_seconds, result.flow_seconds));
}

} // namespace cowgpu

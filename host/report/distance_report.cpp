#include "host/report/distance_report.hpp"

#include "host/report/document_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace cowgpu {
namespace {

struct Summary {
  std::size_t inside = 0, outside = 0, on_surface = 0, overlapped = 0;
  double smallest = std::numeric_limits<double>::infinity(), largest = -smallest;
};

Summary summary_of(const ClosestPoints& points) {
  Summary s;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double d = points.distance[i];
    s.inside += d < 0;
    s.outside += d > 0;
    s.on_surface += d == 0;
    s.overlapped += !points.winding.empty() && points.winding[i] != 0 && points.winding[i] != 1;
    s.smallest = std::min(s.smallest, d);
    s.largest = std::max(s.largest, d);
  }
  return s;
}

} // namespace

std::string lattice_text(const PointLattice& lattice) {
  return fmt::format("{} x {} x {} points {:.6g} apart, the bounding box enlarged by {}", lattice.counts[0],
                     lattice.counts[1], lattice.counts[2], lattice.spacing, lattice_enlargement);
}

Object document(const DistanceResult& result, const std::vector<std::string>& command) {
  const Summary summary = summary_of(result.points);
  Object all = opening("cowgpu.distance.v1", command);
  all.add({{"mesh", members(result.mesh)},
           {"points", result.queries.size()},
           {"signed", result.with_sign},
           {"outside", summary.outside},
           {"on_surface", summary.on_surface},
           {"smallest", summary.smallest},
           {"largest", summary.largest},
           {"device", members(result.device)},
           {"notes", result.notes},
           {"timings", Object{{"read", result.read_seconds},
                              {"setup", result.setup_seconds},
                              {"distance", result.report.seconds},
                              {"write", result.write_seconds}}}});
  if (result.with_sign) all.add({{"inside", summary.inside}, {"overlapped", summary.overlapped}});
  if (!result.input.empty()) all.add("input", result.input);
  if (!result.output.empty()) all.add("output", result.output);
  if (const auto& lattice = result.lattice)
    all.add("grid", Object{{"counts", lattice->counts},
                           {"first", lattice->first},
                           {"spacing", lattice->spacing},
                           {"enlargement", lattice_enlargement}});
  return all;
}

void write_distance(const DistanceResult& result, const Sink& sink) {
  const Summary summary = summary_of(result.points);
  sink(mesh_line(result.mesh) + "\n");
  for (const std::string& note : result.notes) sink("note: " + note + "\n");
  if (result.lattice) sink("grid: " + lattice_text(*result.lattice) + "\n");
  const double rate = double(result.queries.size()) / result.report.seconds;
  sink(fmt::format("computed: {} distances of {} points in {:.3f} s, {:.3g} a second\n",
                   result.with_sign ? "signed" : "unsigned", result.queries.size(), result.report.seconds, rate));
  sink(fmt::format("distances: {:.17g} to {:.17g}\n", summary.smallest, summary.largest));
  if (result.with_sign)
    sink(fmt::format(
        "points: {} inside, {} outside, {} on the surface, {} where the winding number is neither 0 nor 1\n",
        summary.inside, summary.outside, summary.on_surface, summary.overlapped));
  sink("device: " + device_line(result.device) + "\n");
  sink(fmt::format("time: read {:.3f} s, set-up {:.3f} s, distances {:.3f} s, write {:.3f} s\n", result.read_seconds,
                   result.setup_seconds, result.report.seconds, result.write_seconds));
}

} // namespace cowgpu

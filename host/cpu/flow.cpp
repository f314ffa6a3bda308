#include "host/flow.hpp"

#include "host/clock.hpp"
#include "host/cpu/flow_path.hpp"
#include "host/error.hpp"
#include "host/parallel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

constexpr std::size_t batch = 512;

class CpuFlow : public DistanceFlow {
public:
  CpuFlow(std::span<const Vec3> vertices, std::span<const Face> faces, unsigned threads)
      : surface_(vertices, faces), threads_(threads) {}

  FlowPoints flow(std::span<const Vec3> starts, std::span<const Vec3> normals, const FlowOptions& options,
                  Monitor& monitor, FlowReport* report) const override;

private:
  cpu::FlowEnd forward(const Vec3& start, const Vec3& normal, const FlowOptions& options, std::uint32_t warm,
                       cpu::FlowTrace* trace) const;
  cpu::FlowEnd backward(const Vec3& start, const FlowOptions& options, std::uint32_t warm, cpu::FlowTrace* trace) const;

  cpu::FlowSurface surface_;
  unsigned threads_;
};

void check(std::span<const Vec3> starts, std::span<const Vec3> normals, const FlowOptions& options) {
  if (!(options.time >= 0) || !std::isfinite(options.time))
    throw Error(Fault::bad_argument, fmt::format("a flow takes a time of 0 or more, not {}", options.time));
  if (!(options.tolerance >= 1e-12) || !(options.tolerance <= 1e-2))
    throw Error(Fault::bad_argument,
                fmt::format("the tolerance of a flow is 1e-12 to 1e-2, not {}", options.tolerance));
  if (!normals.empty() && (normals.size() != starts.size() || options.backward))
    throw Error(Fault::bad_argument, options.backward
                                         ? std::string("a backward flow takes no normals")
                                         : fmt::format("{} normals for {} starts", normals.size(), starts.size()));
  for (const auto list : {starts, normals})
    for (std::size_t i = 0; i < list.size(); ++i)
      if (!list[i].allFinite())
        throw Error(Fault::bad_argument, fmt::format("start {} of the flow, or its normal, is not finite", i));
}

cpu::FlowEnd CpuFlow::forward(const Vec3& start, const Vec3& normal, const FlowOptions& options, std::uint32_t warm,
                              cpu::FlowTrace* trace) const {
  cpu::FlowEnd end = cpu::FlowPath(surface_, options.time, options.tolerance, trace).run(start, normal, warm);
  if (!(end.flags & flow_unfinished)) return end;
  const cpu::FlowEnd first = end;
  end = cpu::FlowPath(surface_, options.time, std::max(options.tolerance / 100, 1e-13), trace).run(start, normal, warm);
  end.flags |= flow_restarted;
  end.queries += first.queries;
  end.events += first.events;
  end.steps += first.steps;
  return end;
}

cpu::FlowEnd CpuFlow::backward(const Vec3& start, const FlowOptions& options, std::uint32_t warm,
                               cpu::FlowTrace* trace) const {
  cpu::FlowEnd end;
  end.face = surface_.nearest(start, warm);
  end.queries = 1;
  end.position = start;
  const cpu::Foot foot = surface_.foot(end.face, start);
  end.distance = foot.distance;
  if (surface_.winding_number(start) > 0) {
    end.flags = flow_inside;
    end.distance = -foot.distance;
  } else if (foot.distance <= options.time) {
    end.position = foot.point;
    end.distance = 0;
    end.flags = flow_surface;
  } else {
    end.distance = foot.distance - options.time;
    end.position = foot.point + end.distance / foot.distance * (start - foot.point);
  }
  if (trace) {
    trace->places = {start, end.position};
    trace->times = {0, end.flags & flow_inside ? 0 : std::min(options.time, foot.distance)};
  }
  return end;
}

void summarise(const FlowPoints& points, FlowReport& report) {
  report.points = points.positions.size();
  std::vector<double> times;
  for (std::size_t i = 0; i < points.flags.size(); ++i) {
    const auto has = [&](FlowFlag flag) { return (points.flags[i] & flag) != 0; };
    report.stationary += has(flow_stationary);
    report.inside += has(flow_inside);
    report.restarted += has(flow_restarted);
    report.unfinished += has(flow_unfinished);
    report.queries += points.queries[i];
    if (!has(flow_slid)) continue;
    const Vec3& place = points.slide_places[i];
    report.slide_low = times.empty() ? place : Vec3(report.slide_low.cwiseMin(place));
    report.slide_high = times.empty() ? place : Vec3(report.slide_high.cwiseMax(place));
    times.push_back(points.slide_times[i]);
  }
  report.slid = times.size();
  if (times.empty()) return;
  const auto middle = times.begin() + std::ptrdiff_t(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  report.median_slide = *middle;
  report.first_slide = *std::min_element(times.begin(), times.end());
}

FlowPoints CpuFlow::flow(std::span<const Vec3> starts, std::span<const Vec3> normals, const FlowOptions& options,
                         Monitor& monitor, FlowReport* report) const {
  check(starts, normals, options);
  const auto begin = Clock::now();
  const std::size_t n = starts.size();
  FlowPoints points;
  points.positions.resize(n);
  points.distances.resize(n);
  points.faces.resize(n);
  points.flags.resize(n);
  points.slide_times.resize(n);
  points.slide_places.resize(n);
  points.queries.resize(n);
  std::vector<cpu::FlowTrace> traces(options.streamlines ? n : 0);
  FlowReport found;
  // A round is what the threads do between two words of progress.
  const std::size_t batches = (n + batch - 1) / batch;
  const std::size_t round = std::max<std::size_t>(64, batches / 50);
  std::vector<std::array<std::uint64_t, 2>> counts(batches);
  for (std::size_t done = 0; done < batches; done += round) {
    check_stop(monitor);
    monitor.progress("flowing points", double(done) / double(batches));
    parallel_for(threads_, std::min(round, batches - done), [&](std::size_t task, unsigned) {
      const std::size_t b = done + task;
      for (std::size_t i = b * batch; i < std::min(n, (b + 1) * batch); ++i) {
        if (i % 64 == 0) check_stop(monitor);
        cpu::FlowTrace* trace = options.streamlines ? &traces[i] : nullptr;
        const Vec3 normal = normals.empty() ? Vec3(Vec3::Zero()) : normals[i];
        const cpu::FlowEnd end = options.backward ? backward(starts[i], options, no_face, trace)
                                                  : forward(starts[i], normal, options, no_face, trace);
        points.positions[i] = end.position;
        points.distances[i] = end.distance;
        points.faces[i] = end.face;
        points.flags[i] = end.flags;
        points.slide_times[i] = end.slide_time;
        points.slide_places[i] = end.slide_place;
        points.queries[i] = end.queries;
        counts[b][0] += end.events;
        counts[b][1] += end.steps;
      }
    });
  }
  if (options.streamlines) {
    points.first.push_back(0);
    for (const cpu::FlowTrace& trace : traces) {
      points.path.insert(points.path.end(), trace.places.begin(), trace.places.end());
      points.path_times.insert(points.path_times.end(), trace.times.begin(), trace.times.end());
      points.first.push_back(points.path.size());
    }
  }
  if (report) {
    summarise(points, found);
    for (const auto& count : counts) found.events += count[0], found.steps += count[1];
    found.seconds = seconds_since(begin);
    *report = found;
  }
  monitor.progress("flowing points", 1);
  return points;
}

} // namespace

std::unique_ptr<DistanceFlow> make_cpu_flow(std::span<const Vec3> vertices, std::span<const Face> faces,
                                            unsigned threads) {
  return std::make_unique<CpuFlow>(vertices, faces, threads);
}

} // namespace cowgpu

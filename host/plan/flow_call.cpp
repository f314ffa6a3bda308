#include "host/plan/flow_call.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/geometry/morton.hpp"
#include "host/plan/closest_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu::plan {
namespace {

void check(std::span<const Vec3> starts, std::span<const Vec3> normals, const FlowOptions& options) {
  if (!(options.time >= 0) || !std::isfinite(options.time))
    throw Error(Fault::bad_argument, fmt::format("a flow takes a time of 0 or more, not {}", options.time));
  if (!(options.tolerance >= 1e-12) || !(options.tolerance <= 1e-2))
    throw Error(Fault::bad_argument,
                fmt::format("the tolerance of a flow is 1e-12 to 1e-2, not {}", options.tolerance));
  if (!normals.empty() && (normals.size() != starts.size() || options.backward))
    throw Error(Fault::bad_argument,
                options.backward ? std::string("a backward flow takes no normals")
                                 : fmt::format("the flow has {} normals and {} starts: pass one normal for each start",
                                               normals.size(), starts.size()));
  if (starts.size() >= no_face)
    throw Error(Fault::too_large,
                fmt::format("{} starts are too many at once; fewer than 2^32 are possible", starts.size()));
  for (const auto list : {starts, normals})
    for (std::size_t i = 0; i < list.size(); ++i)
      if (!list[i].allFinite())
        throw Error(Fault::bad_argument, fmt::format("start {} of the flow, or its normal, is not finite", i));
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

} // namespace

std::uint64_t distance_flow_bytes(std::uint64_t vertices, std::uint64_t faces, std::uint64_t starts) {
  constexpr std::uint64_t frame = sizeof(TriangleFrame<double>) + sizeof(Vec3);
  constexpr std::uint64_t one = 2 * sizeof(Vec3) + 2 * sizeof(double) + 2 * sizeof(std::uint32_t) + 1;
  return ClosestTree::bytes(faces, vertices) + faces * frame + starts * (one + 20);
}

FlowCall::FlowCall(const FlowSurface& surface, std::span<const Vec3> starts, std::span<const Vec3> normals,
                   const FlowOptions& options, unsigned threads)
    : surface_(surface), starts_(starts), normals_(normals), options_(options), begin_(Clock::now()) {
  check(starts, normals, options);
  const std::size_t n = starts.size();
  points_.positions.resize(n);
  points_.distances.resize(n);
  points_.faces.resize(n);
  points_.flags.resize(n);
  points_.slide_times.resize(n);
  points_.slide_places.resize(n);
  points_.queries.resize(n);
  traces_.resize(options.streamlines ? n : 0);
  order_ = surface.order(starts, threads);
}

FlowEnd FlowCall::backward(std::uint32_t start, std::uint32_t face) {
  const Vec3& from = starts_[start];
  FlowEnd end;
  end.face = face;
  end.queries = 1;
  end.position = from;
  const Foot foot = surface_.foot(face, from);
  end.distance = foot.distance;
  if (surface_.winding_number(from) > 0) {
    end.flags = flow_inside;
    end.distance = -foot.distance;
  } else if (foot.distance <= options_.time) {
    end.position = foot.point;
    end.distance = 0;
    end.flags = flow_surface;
  } else {
    end.distance = foot.distance - options_.time;
    end.position = foot.point + end.distance / foot.distance * (from - foot.point);
  }
  if (FlowTrace* const kept = trace(start)) {
    kept->places = {from, end.position};
    kept->times = {0, end.flags & flow_inside ? 0 : std::min(options_.time, foot.distance)};
  }
  return end;
}

void FlowCall::set(std::uint32_t start, const FlowEnd& end) {
  points_.positions[start] = end.position;
  points_.distances[start] = end.distance;
  points_.faces[start] = end.face;
  points_.flags[start] = end.flags;
  points_.slide_times[start] = end.slide_time;
  points_.slide_places[start] = end.slide_place;
  points_.queries[start] = end.queries;
  events_.fetch_add(end.events, std::memory_order_relaxed);
  steps_.fetch_add(end.steps, std::memory_order_relaxed);
}

FlowPoints FlowCall::finish(FlowReport* report) {
  if (options_.streamlines) {
    points_.first.push_back(0);
    for (const FlowTrace& kept : traces_) {
      points_.path.insert(points_.path.end(), kept.places.begin(), kept.places.end());
      points_.path_times.insert(points_.path_times.end(), kept.times.begin(), kept.times.end());
      points_.first.push_back(points_.path.size());
    }
  }
  if (report) {
    *report = {};
    summarise(points_, *report);
    report->events = events_;
    report->steps = steps_;
    report->seconds = seconds_since(begin_);
  }
  return std::move(points_);
}

FlowRun::FlowRun(FlowCall& call, std::uint32_t start)
    : call_(&call), start_(start),
      path_(call.surface_, call.options_.time, call.options_.tolerance, call.trace(start)) {
  path_.start(call.starts_[start], call.normals_.empty() ? Vec3(Vec3::Zero()) : call.normals_[start]);
}

void FlowRun::answer(std::uint32_t face) {
  FlowCall& call = *call_;
  if (call.options_.backward) {
    path_.stop();
    return call.set(start_, call.backward(start_, face));
  }
  path_.answer(face);
  if (path_.done()) arrive(path_.end());
}

double FlowRun::tighter(double tolerance) {
  return std::max(tolerance / 100, 1e-13);
}

void FlowRun::pass(const Vec3& place, double time) {
  if (FlowTrace* const kept = call_->trace(start_)) {
    kept->places.push_back(place);
    kept->times.push_back(time);
    ++passed_;
  }
}

void FlowRun::go_back() {
  if (FlowTrace* const kept = call_->trace(start_)) {
    kept->places.resize(kept->places.size() - passed_);
    kept->times.resize(kept->places.size());
  }
  passed_ = 0;
}

void FlowRun::arrive(const FlowEnd& found) {
  FlowCall& call = *call_;
  FlowEnd end = found;
  if ((end.flags & flow_unfinished) && !again_) {
    again_ = true;
    passed_ = 0;
    first_ = end;
    path_ = FlowPath(call.surface_, call.options_.time, tighter(call.options_.tolerance), call.trace(start_));
    return path_.start(call.starts_[start_], call.normals_.empty() ? Vec3(Vec3::Zero()) : call.normals_[start_]);
  }
  if (again_) {
    end.flags |= flow_restarted;
    end.queries += first_.queries;
    end.events += first_.events;
    end.steps += first_.steps;
  }
  path_.stop();
  call.set(start_, end);
}

} // namespace cowgpu::plan

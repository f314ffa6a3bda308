#include "host/gpu/flow.hpp"

#include "engine/kernels/flow.hpp"
#include "host/gpu/closest_faces.hpp"
#include "host/gpu/errors.hpp"
#include "host/parallel.hpp"
#include "host/plan/flow_call.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

namespace cowgpu::gpu {
namespace {

using engine::FlowPlace;
using engine::FlowStatus;
using engine::FlowTask;
using engine::FlowWhat;

constexpr std::size_t most_live = std::size_t(1) << 15; // points on their way at once
constexpr std::size_t part = 256;                       // points a thread takes at a time
// So few are the host's after so many passes without a new start: some paths have thousands of steps, and a pass costs more
// than the host's way from the start.
constexpr std::size_t few_live = 128, most_passes = 256;
static_assert(most_live <= ClosestFaces::batch);
static_assert(engine::flow_no_face == no_face);

Vec3 vector(const double* v) {
  return {v[0], v[1], v[2]};
}
void put(const Vec3& v, double* to) {
  for (int c = 0; c < 3; ++c) to[c] = v[c];
}

// The points on their way.
class Wavefront {
public:
  Wavefront(plan::FlowCall& call, const plan::FlowSurface& surface, ClosestFaces& faces, engine::Flow& device,
            const engine::FlowNumbers& numbers)
      : call_(call), surface_(surface), faces_(faces), device_(device), numbers_(numbers) {}

  void run(Monitor& monitor, FlowReport& report) {
    const auto size = double(std::max<std::size_t>(1, call_.size()));
    room_ = std::min(most_live, call_.size());
    if (room_ > 0) translated([&] { device_.reserve(std::uint32_t(room_)); });
    live_.reserve(room_);
    for (fill(); !going_.empty() && (going_.size() > few_live || passes_ < most_passes); fill()) {
      check_stop(monitor);
      monitor.progress("flowing points", double(next_ - going_.size()) / size);
      translated([&] { pass(report); });
      ++report.passes;
      ++passes_;
    }
    parallel_for(0, going_.size(), [&](std::size_t i, unsigned) {
      check_stop(monitor);
      plan::FlowRun& run = live_[going_[i]].run;
      run.go_back();
      while (!run.done()) run.answer(surface_.nearest(run.query(), run.warm()));
    });
    for (const std::uint32_t place : going_) {
      report.device_queries -= live_[place].answers;
      report.device_moves -= live_[place].moves;
    }
    monitor.progress("flowing points", 1);
  }

private:
  struct Live {
    plan::FlowRun run;
    FlowWhat what = FlowWhat::find;
    std::uint32_t face = no_face;         // the answer, if the host gave it
    std::uint32_t answers = 0, moves = 0; // by the device
  };

  // Those that ended give their places to new starts.
  void fill() {
    const auto order = call_.order();
    const std::size_t kept = going_.size();
    std::size_t to = 0;
    for (std::size_t i = 0; i < kept; ++i) {
      const std::uint32_t place = going_[i];
      if (live_[place].run.done()) {
        if (next_ == order.size()) continue;
        live_[place] = {plan::FlowRun(call_, order[next_++])};
        passes_ = 0;
        begin(place);
      }
      going_[to++] = place;
    }
    going_.resize(to);
    while (live_.size() < room_ && next_ < order.size()) {
      live_.push_back({plan::FlowRun(call_, order[next_++])});
      going_.push_back(std::uint32_t(live_.size() - 1));
      begin(going_.back());
    }
  }

  // From its start.
  void begin(std::uint32_t place) {
    Live& live = live_[place];
    live.what = FlowWhat::find;
    put(live.run.query(), device_.places()[place].query);
    device_.places()[place].marks = 0;
    answer_far(place);
  }

  // The search has nothing to say about queries very far away.
  void answer_far(std::uint32_t place) {
    const Vec3 query = vector(device_.places()[place].query);
    live_[place].face = surface_.tree().is_far(query) ? surface_.nearest(query, no_face) : no_face;
  }

  bool is_sliding(std::uint32_t place) const {
    return live_[place].what == FlowWhat::go_on && device_.places()[place].phase == engine::FlowAsks::slide;
  }
  bool is_on_sheet(std::uint32_t place) const {
    return live_[place].what != FlowWhat::find && live_[place].what != FlowWhat::depart &&
           (device_.places()[place].marks & FlowPlace::on_sheet);
  }

  // One event of each.
  void pass(FlowReport& report) {
    const std::span<FlowPlace> places = device_.places();
    const std::span<FlowTask> tasks = device_.tasks();
    const auto asks = [&](std::uint32_t place) {
      return live_[place].what != FlowWhat::resume && live_[place].face == no_face;
    };
    queries_.clear();
    asking_.clear();
    for (const std::uint32_t place : going_)
      if (asks(place)) {
        queries_.push_back(vector(places[place].query));
        asking_.push_back(place);
      }
    const std::vector<std::uint32_t> order = surface_.order(queries_, 0);
    faces_.put(queries_, order);
    // Points with as much to do next to each other, those on sheets last.
    std::size_t count = 0, others = 0;
    for (const bool sheet : {false, true}) {
      for (const bool slides : {false, true})
        for (std::size_t i = 0; i < order.size(); ++i) {
          const std::uint32_t place = asking_[order[i]];
          if (is_on_sheet(place) == sheet && (sheet || is_sliding(place)) == slides)
            tasks[count++] = {place, live_[place].what, no_face, std::uint32_t(i)};
        }
      for (const std::uint32_t place : going_)
        if (!asks(place) && is_on_sheet(place) == sheet)
          tasks[count++] = {place, live_[place].what, live_[place].face, 0};
      if (!sheet) others = count;
    }
    device_.pass(faces_.kernel(), !queries_.empty(), numbers_, std::uint32_t(count), std::uint32_t(count - others));
    std::atomic<std::uint64_t> answers = 0, moves = 0;
    parallel_for(0, (going_.size() + part - 1) / part, [&](std::size_t task, unsigned) {
      for (std::size_t i = task * part; i < std::min(going_.size(), (task + 1) * part); ++i) {
        Live& live = live_[going_[i]];
        const bool asked = asks(going_[i]);
        const FlowStatus status = take_over(going_[i]);
        const bool answered = asked && status != FlowStatus::left;
        const bool moved = status == FlowStatus::asks || status == FlowStatus::done;
        answers += answered;
        moves += moved;
        live.answers += answered;
        live.moves += moved;
      }
    });
    report.device_moves += moves;
    report.device_queries += answers;
  }

  // What became of a point.
  FlowStatus take_over(std::uint32_t place) {
    Live& live = live_[place];
    FlowPlace& point = device_.places()[place];
    const FlowStatus status = point.status;
    if (status != FlowStatus::left && (point.marks & FlowPlace::recorded))
      live.run.pass(vector(point.place), point.time);
    switch (status) {
    case FlowStatus::asks:
      live.what = FlowWhat::go_on;
      answer_far(place);
      break;
    case FlowStatus::busy:
      live.what = FlowWhat::resume;
      live.face = no_face;
      break;
    case FlowStatus::found: depart(place, point.face); break;
    case FlowStatus::left: live.face = surface_.nearest(vector(point.query), no_face); break;
    default: arrive(place);
    }
    return status;
  }

  // The first answer is taken by the host, which has the winding numbers.
  void depart(std::uint32_t place, std::uint32_t face) {
    Live& live = live_[place];
    live.run.answer(face);
    if (live.run.done()) return;
    const plan::FlowDeparture from = live.run.path().departure();
    const plan::FlowEnd& so_far = live.run.path().end();
    FlowPlace& point = device_.places()[place];
    put(live.run.query(), point.query);
    put(from.place, point.place);
    put(from.foot, point.foot);
    put(from.normal, point.normal);
    point.time = from.time;
    point.distance = from.distance;
    point.radius = from.radius;
    point.phase = from.asks == plan::FlowDeparture::Asks::lift  ? engine::FlowAsks::lift
                  : from.asks == plan::FlowDeparture::Asks::ray ? engine::FlowAsks::ray
                                                                : engine::FlowAsks::last;
    point.face = from.face;
    point.flags = so_far.flags;
    point.marks = (from.inside ? FlowPlace::inside : 0) | (live.run.tighter() ? FlowPlace::tighter : 0);
    point.rounds = from.rounds;
    point.queries = so_far.queries;
    point.events = so_far.events;
    point.steps = so_far.steps;
    live.what = FlowWhat::depart;
    answer_far(place);
  }

  void arrive(std::uint32_t place) {
    const FlowPlace& point = device_.places()[place];
    plan::FlowEnd end;
    end.position = vector(point.place);
    end.distance = point.distance;
    end.face = point.face;
    end.flags = std::uint8_t(point.flags);
    if (end.flags & flow_slid) {
      end.slide_time = point.radius;
      end.slide_place = vector(point.foot);
    }
    end.queries = point.queries;
    end.events = point.events;
    end.steps = point.steps;
    live_[place].run.arrive(end);
    if (live_[place].run.done()) return;
    live_[place].answers = live_[place].moves = 0;
    begin(place);
  }

  plan::FlowCall& call_;
  const plan::FlowSurface& surface_;
  ClosestFaces& faces_;
  engine::Flow& device_;
  const engine::FlowNumbers numbers_;
  std::vector<Live> live_;            // by place
  std::vector<std::uint32_t> going_;  // places in use
  std::vector<std::uint32_t> asking_; // those of queries_
  std::vector<Vec3> queries_;
  std::size_t room_ = 0;
  std::size_t next_ = 0;   // the next point in the call's order
  std::size_t passes_ = 0; // since the last start
};

// A surface on the device.
struct GpuSurface {
  GpuSurface(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget, std::span<const Vec3> vertices,
             std::span<const Face> triangles)
      : surface(vertices, triangles), faces(std::move(gpu), iteration_budget, surface.tree()) {
    std::vector<double> frames;
    frames.reserve(22 * surface.faces());
    for (std::uint32_t f = 0; f < surface.faces(); ++f) {
      const plan::TriangleFrame<double>& t = surface.frame(f);
      for (const double* v : {t.a, t.u, t.v, t.n}) frames.insert(frames.end(), v, v + 3);
      for (const double x : {t.length, t.cx, t.cy, t.c_inverse, t.ex, t.ey, t.e_inverse}) frames.push_back(x);
      for (int c = 0; c < 3; ++c) frames.push_back(surface.normal(f)[c]);
    }
    std::vector<std::uint32_t> face_of;
    for (const std::uint32_t slot : faces.slots()) face_of.push_back(surface.tree().face_of_slot[slot]);
    device =
        std::make_unique<engine::Flow>(faces.device().device(), engine::FlowInput{frames, face_of, iteration_budget});
  }

  plan::FlowSurface surface;
  ClosestFaces faces;
  std::unique_ptr<engine::Flow> device;
};

class GpuFlow final : public DistanceFlow {
public:
  GpuFlow(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget, std::span<const Vec3> vertices,
          std::span<const Face> faces)
      : gpu_(std::move(gpu)), iteration_budget_(iteration_budget), vertices_(vertices), faces_(faces) {}

  MemoryNeed memory(std::uint64_t starts) const override {
    const std::uint64_t live = std::min<std::uint64_t>(starts, most_live);
    MemoryNeed need;
    need.device = ClosestFaces::device_bytes(faces_.size(), live) + engine::Flow::surface_bytes(faces_.size()) +
                  engine::Flow::batch_bytes(live);
    // The device's tree is built beside a tree of boxes, and both are given up.
    need.host = plan::distance_flow_bytes(vertices_.size(), faces_.size(), starts) + 360 * faces_.size() + need.device +
                live * (sizeof(plan::FlowRun) + sizeof(Vec3) + 48);
    return need;
  }

  void prepare() override {
    if (!on_device_)
      on_device_ = translated([&] { return std::make_unique<GpuSurface>(gpu_, iteration_budget_, vertices_, faces_); });
  }

  FlowPoints flow(std::span<const Vec3> starts, std::span<const Vec3> normals, const FlowOptions& options,
                  Monitor& monitor, FlowReport* report) override {
    prepare();
    const plan::FlowSurface& surface = on_device_->surface;
    plan::FlowCall call(surface, starts, normals, options, 0);
    const engine::StopScope stop(*gpu_, [&monitor] { return monitor.stopped(); });
    gpu_->take_profile();
    engine::FlowNumbers numbers;
    numbers.time = options.time;
    numbers.time_reached = options.time * (1 - plan::FlowPath::time_digits);
    numbers.scale = surface.diagonal();
    const double tolerances[] = {options.tolerance, plan::FlowRun::tighter(options.tolerance)};
    for (int way = 0; way < 2; ++way) {
      numbers.tolerance[way] = tolerances[way];
      numbers.longest[way] = plan::FlowPath::longest_step(tolerances[way]);
      numbers.rounds[way] = plan::FlowPath::most_steps(tolerances[way]);
    }
    FlowReport passes;
    Wavefront(call, surface, on_device_->faces, *on_device_->device, numbers).run(monitor, passes);
    FlowPoints points = call.finish(report);
    if (report) {
      report->passes = passes.passes;
      report->device_queries = passes.device_queries;
      report->device_moves = passes.device_moves;
      for (const auto& k : gpu_->take_profile()) report->kernels.push_back({k.kernel, k.dispatches, k.seconds});
    }
    return points;
  }

private:
  std::shared_ptr<engine::Gpu> gpu_;
  std::uint32_t iteration_budget_;
  std::span<const Vec3> vertices_;
  std::span<const Face> faces_;
  std::unique_ptr<GpuSurface> on_device_;
};

} // namespace

std::unique_ptr<DistanceFlow> distance_flow(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget,
                                            std::span<const Vec3> vertices, std::span<const Face> faces) {
  return std::make_unique<GpuFlow>(std::move(gpu), iteration_budget, vertices, faces);
}

} // namespace cowgpu::gpu

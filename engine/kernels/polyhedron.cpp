#include "engine/kernels/polyhedron.hpp"

#include "engine/job.hpp"
#include "shaders/polyhedron.h"
#include "shaders/polyhedron.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <iterator>

namespace cowgpu::engine {
namespace {

constexpr std::uint64_t texel_bytes = 16, lanes = POLYHEDRON_LANES;
static_assert(polyhedron_points == POLYHEDRON_GROUP && POLYHEDRON_GROUP == 2 * POLYHEDRON_LANES);
static_assert(polyhedron_numbers == 2 * POLYHEDRON_STEP_TEXELS);

using Work = std::array<std::uint32_t, 4>; // group, range, step, how many

// Work of a list, in dispatches: [first, end) of `work`, in each of which every group occurs once at most.
struct Dispatches {
  std::vector<Work> work;
  std::vector<std::array<std::uint32_t, 2>> parts;
  std::vector<std::uint64_t> steps; // [group]: steps of its list
};

// `strips`: steps that strips begin with. Dispatches end where strips do: what a step needs of those before is not kept.
Dispatches dispatches_of(const PolyhedronList& list, std::span<const std::uint32_t> strips, std::uint64_t budget,
                         std::uint64_t most_steps, std::uint32_t most_groups) {
  const std::size_t groups = list.starts.size() - 1;
  Dispatches found;
  found.steps.resize(groups);
  struct At {
    std::uint32_t range, step;
    std::uint64_t left;
  };
  std::vector<At> at(groups);
  for (std::size_t g = 0; g < groups; ++g) {
    for (std::uint32_t r = list.starts[g]; r < list.starts[g + 1]; ++r)
      found.steps[g] += list.ranges[r][1] - list.ranges[r][0];
    const bool any = found.steps[g] > 0;
    at[g] = {list.starts[g], any ? list.ranges[list.starts[g]][0] : 0, found.steps[g]};
  }
  for (bool more = true; more;) {
    more = false;
    std::uint64_t sum = 0;
    auto first = std::uint32_t(found.work.size());
    const auto end_part = [&] {
      if (found.work.size() > first) found.parts.push_back({first, std::uint32_t(found.work.size())});
      first = std::uint32_t(found.work.size());
      sum = 0;
    };
    for (std::size_t g = 0; g < groups; ++g) {
      At& own = at[g];
      if (own.left == 0) continue;
      const At begin = own;
      std::uint64_t steps = 0;
      while (own.left > 0) {
        const std::uint32_t range_end = list.ranges[own.range][1];
        std::uint32_t stop = range_end;
        if (steps + (range_end - own.step) > budget) {
          const std::uint64_t reach = own.step + (budget - steps);
          stop = *std::prev(std::upper_bound(strips.begin(), strips.end(), reach));
          if (stop <= own.step) break;
        }
        steps += stop - own.step;
        own.left -= stop - own.step;
        own.step = stop;
        if (stop < range_end) break;
        ++own.range;
        if (own.left > 0) own.step = list.ranges[own.range][0];
      }
      if (steps == 0)
        throw Error(Failure::out_of_range, 0,
                    fmt::format("{} loop iterations an invocation are fewer than a strip of faces takes", budget));
      if (sum + steps > most_steps || found.work.size() - first == most_groups) end_part();
      found.work.push_back({std::uint32_t(g), begin.range, begin.step, std::uint32_t(steps)});
      sum += steps;
      more = more || own.left > 0;
    }
    end_part();
  }
  return found;
}

} // namespace

Polyhedron::Polyhedron(Device& device, const PolyhedronInput& input)
    : device_(device), second_(input.second), seeds_(input.seeds || !device.software()), touching_(input.touching),
      budget_(std::max(1U, input.iteration_budget - input.iteration_budget / 32)) {
  const std::uint64_t texels = input.steps.size_bytes() / texel_bytes;
  if (texels > device.limits().maxTexelBufferElements)
    throw Error(Failure::out_of_range, 0,
                fmt::format("{} faces are more than the device {} sums, which reads {} texels from a buffer; use "
                            "--device cpu",
                            texels / POLYHEDRON_STEP_TEXELS, device.name(), device.limits().maxTexelBufferElements));
  steps_ =
      std::make_unique<Buffer>(device, std::max<std::uint64_t>(input.steps.size_bytes(), texel_bytes), "the faces");
  steps_->write(std::as_bytes(input.steps));
  for (std::size_t at = 0; at < input.steps.size(); at += polyhedron_numbers)
    if (std::bit_cast<std::uint64_t>(input.steps[at + polyhedron_numbers - 1]) & POLYHEDRON_FLAG_FIRST)
      strips_.push_back(std::uint32_t(at / polyhedron_numbers));
}

Polyhedron::~Polyhedron() = default;

std::size_t Polyhedron::rows() const {
  return second_ ? POLYHEDRON_ROWS_SECOND : POLYHEDRON_ROWS_FIRST;
}

std::uint64_t Polyhedron::sum_bytes(std::uint64_t groups, std::uint64_t ranges, bool second) {
  const std::uint64_t rows = second ? POLYHEDRON_ROWS_SECOND : POLYHEDRON_ROWS_FIRST;
  return groups * (POLYHEDRON_GROUP * 8 * (3 + rows) + lanes * 4) + ranges * 8 + 256;
}

void Polyhedron::sum(std::span<const double> points, std::span<const std::uint32_t> counts, const PolyhedronList& near,
                     const PolyhedronList& far, std::span<double> sums, const Hook& hook) {
  const std::size_t groups = near.starts.size() - 1;
  if (groups == 0) return;
  if (groups >> POLYHEDRON_COUNT_SHIFT)
    throw Error(Failure::out_of_range, 0, fmt::format("{} groups of points are more than a call takes", groups));
  Buffer point_buffer(device_, points.size_bytes(), "the points"), sum_buffer(device_, sums.size_bytes(), "the sums");
  Buffer seen(device_, 4 * lanes * groups, "the counts");
  point_buffer.write(std::as_bytes(points));
  sum_buffer.clear();
  seen.clear();
  const std::uint64_t most_steps = (device_.software() ? 20'000'000 : 1'000'000'000) / POLYHEDRON_GROUP;
  const std::uint32_t most_groups = device_.limits().maxComputeWorkGroupCount[0];
  std::vector<std::uint64_t> expected(groups);
  std::uint64_t all = 0, done = 0;
  Dispatches planned[2];
  for (std::size_t k = 0; k < 2; ++k) {
    planned[k] = dispatches_of(k == 0 ? near : far, strips_, std::min<std::uint64_t>(budget_, most_steps), most_steps,
                               most_groups);
    for (std::size_t g = 0; g < groups; ++g) {
      expected[g] += planned[k].steps[g];
      all += planned[k].steps[g];
    }
  }
  for (std::size_t k = 0; k < 2; ++k) {
    const PolyhedronList& list = k == 0 ? near : far;
    const Dispatches& own = planned[k];
    if (own.parts.empty()) continue;
    const Kernel& kernel = device_.kernel({"polyhedron",
                                           shaders::polyhedron,
                                           POLYHEDRON_BINDINGS,
                                           sizeof(shaders::PolyhedronPush),
                                           {POLYHEDRON_LANES, k == 0 ? 1U : 0U, second_ ? 1U : 0U, seeds_ ? 1U : 0U},
                                           {BindingKind::texel_doubles}});
    for (Work& work : planned[k].work) work[0] |= counts[work[0]] << POLYHEDRON_COUNT_SHIFT;
    Buffer ranges(device_, list.ranges.size_bytes(), "the lists of faces");
    Buffer work(device_, own.work.size() * sizeof(Work), "the work");
    ranges.write(std::as_bytes(list.ranges));
    work.write(std::as_bytes(std::span(own.work)));
    const BufferRange bound[POLYHEDRON_BINDINGS] = {{steps_.get()},  {&ranges},     {&work},
                                                    {&point_buffer}, {&sum_buffer}, {&seen}};
    Job job(device_);
    for (const auto& [first, end] : own.parts) {
      const shaders::PolyhedronPush push = {first, 0, touching_};
      job.dispatch(kernel, bound, std::as_bytes(std::span(&push, 1)), end - first);
      job.run(); // one at a time: a stop is answered in between
      for (std::uint32_t w = first; w < end; ++w) done += own.work[w][3];
      if (hook && !hook(double(done) / double(all)))
        throw Error(Failure::stopped, 0, "stopped between two dispatches of the field of a polyhedron");
    }
  }
  std::vector<std::uint32_t> steps(lanes * groups);
  seen.read(std::as_writable_bytes(std::span(steps)));
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (2 * (i % lanes) < counts[i / lanes] && steps[i] != std::uint32_t(expected[i / lanes]))
      throw Error(Failure::cut_short, 0,
                  fmt::format("the device {} ended a loop early: it summed {} of {} faces; the result would be wrong; "
                              "use --device cpu and report this",
                              device_.name(), steps[i], expected[i / lanes]));
  sum_buffer.read(std::as_writable_bytes(sums));
}

} // namespace cowgpu::engine

#include "engine/kernels/moments.hpp"

#include "engine/job.hpp"
#include "shaders/moments.h"
#include "shaders/moments.hpp"
#include "shaders/moments_sum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <thread>
#include <vector>

namespace cowgpu::engine {
namespace {

constexpr std::uint32_t most_workgroups = 64;   // each has a partial sum
constexpr std::uint32_t dispatches_per_job = 4; // a stop is answered between jobs

// Degrees first ... last of all groups, in one go or after the slice before.
struct Slice {
  std::uint32_t first = 1, last = 0;
  std::uint64_t size = 0;   // doubles of a partial sum
  std::uint64_t offset = 0; // in the total, doubles
};

class Layout {
public:
  Layout(const MomentsShape& shape, std::uint64_t largest_range, int lmax) : shape_(shape), lmax_(std::uint32_t(lmax)) {
    while (slices.empty() || slices.back().last < lmax_) {
      Slice slice;
      if (!slices.empty()) {
        slice.first = slices.back().last + 1;
        slice.offset = (slices.back().offset + slices.back().size + 31) / 32 * 32;
      }
      for (std::uint32_t degree = slice.first; degree <= lmax_; degree += shape.levels) {
        const std::uint64_t size = slice.size + sweep_doubles(degree);
        const bool fits = iterations(slice.first, degree, true) <= shape.iteration_budget &&
                          size * 8 * shape.workgroups <= largest_range;
        if (!fits && slice.last) break;
        slice.last = std::min(degree + shape.levels - 1, lmax_);
        slice.size = size;
      }
      if (slice.last == 0) break; // lmax 0
      slices.push_back(slice);
    }
    const std::uint64_t group_bytes =
        std::max<std::uint64_t>(keeps_state() ? state_bytes() : 0, std::uint64_t(8) * MOMENTS_INPUTS * shape.lanes);
    const std::uint64_t budget = keeps_state() ? std::min(shape.state_budget, largest_range) : largest_range;
    chunk = std::max<std::uint64_t>(budget / group_bytes, 1);
    // Whole turns of the workgroups, so that a group's partial sum does not depend on the chunk.
    if (chunk > shape.workgroups) chunk -= chunk % shape.workgroups;
  }

  // Columns that one sweep from `degree` writes, three an iteration.
  std::uint64_t sweep_iterations(std::uint32_t degree) const { return (degree + 3 * shape_.levels) / 3; }
  std::uint64_t sweep_doubles(std::uint32_t degree) const { return sweep_iterations(degree) * 3 * 2 * shape_.levels; }

  // Loop iterations one group costs an invocation for degrees first ... last, the one that ends each loop counted too;
  // `state` if rows are loaded and stored.
  std::uint64_t iterations(std::uint32_t first, std::uint32_t last, bool state) const {
    std::uint64_t count = 8 + (last + 4 * shape_.levels + 3) / 4;
    if (state) count += 2 * (std::uint64_t(last) + shape_.levels + 1);
    for (std::uint32_t degree = first; degree <= last; degree += shape_.levels) count += 2 + sweep_iterations(degree);
    return count;
  }

  // Iterations of the innermost loop for a group that ends at degree `last`.
  std::uint64_t steps(std::uint32_t last) const {
    std::uint64_t count = 0;
    for (std::uint32_t degree = 1; degree <= last; degree += shape_.levels) count += sweep_iterations(degree);
    return count;
  }

  bool keeps_state() const { return shape_.rows_in_buffer || slices.size() > 1; }
  std::uint32_t state_columns() const { return lmax_ + 4 * shape_.levels + 4; }
  std::uint64_t state_bytes() const { return std::uint64_t(8) * MOMENTS_ROWS * shape_.lanes * state_columns(); }
  std::uint64_t partial_doubles() const {
    std::uint64_t most = 1;
    for (const Slice& s : slices) most = std::max(most, s.size);
    return most * shape_.workgroups;
  }
  std::uint64_t total_doubles() const { return slices.empty() ? 1 : slices.back().offset + slices.back().size; }

  std::vector<Slice> slices;
  std::uint64_t chunk = 1; // groups worked on through all slices before the next ones

private:
  const MomentsShape& shape_;
  std::uint32_t lmax_;
};

// Few different sizes, so that a compiled shader serves many degrees.
std::uint32_t private_columns(const MomentsShape& shape, int lmax) {
  if (shape.rows_in_buffer) return 1;
  const std::uint32_t needed = std::uint32_t(lmax) + 4 * shape.levels + 4;
  for (const std::uint32_t size : {192U, 320U, 576U, 1088U, 2112U})
    if (needed <= size) return size;
  return needed;
}

template <class T>
std::span<const std::byte> push_bytes(const T& push) {
  return std::as_bytes(std::span(&push, 1));
}

// From the total's columns to rows sorted by l, then m.
void gather(const MomentsShape& shape, const Layout& layout, const Slice& slice, std::span<const double> total,
            std::span<double> sums) {
  const std::uint64_t levels = shape.levels;
  const double* sweep = total.data();
  for (std::uint32_t degree = slice.first; degree <= slice.last; degree += shape.levels) {
    for (std::uint64_t j = 0; j < levels && degree + j <= slice.last; ++j) {
      const std::uint64_t l = degree + j;
      double* row = &sums[l * (l + 1)];
      for (std::uint64_t m = 0; m <= l; ++m) {
        const double* column = sweep + 2 * (levels * (m + levels + j - 1) + j);
        row[2 * m] = column[0];
        row[2 * m + 1] = column[1];
      }
    }
    sweep += layout.sweep_doubles(degree);
  }
}

} // namespace

MomentsShape moments_shape(const GpuFacts& facts, MomentsShape wanted) {
  const bool software = facts.type == "software";
  if (wanted.lanes == 0) wanted.lanes = facts.subgroup_size;
  if (wanted.levels == 0) wanted.levels = 4;
  if (wanted.workgroups == 0)
    wanted.workgroups = software ? std::clamp(std::bit_ceil(std::thread::hardware_concurrency()), 4U, 64U) : 64;
  if (!software) wanted.rows_in_buffer = true;
  return wanted;
}

std::uint64_t moments_device_bytes(const MomentsShape& shape, const GpuFacts& facts, int lmax, std::uint64_t groups) {
  const Layout layout(shape, facts.largest_range, lmax);
  const std::uint64_t resident = std::min(groups, layout.chunk);
  return groups * (8 * MOMENTS_INPUTS * shape.lanes + 8) + 8 * (layout.partial_doubles() + layout.total_doubles()) +
         (layout.keeps_state() ? resident * layout.state_bytes() : 0);
}

void moments(Device& device, const MomentsShape& shape, const MomentsInput& input, std::span<double> sums,
             const Hook& hook) {
  const std::uint32_t groups = std::uint32_t(input.last_degrees.size());
  if (groups == 0 || input.lmax == 0) return;
  if (shape.lanes != device.physical().subgroup_size)
    throw Error(Failure::out_of_range, 0,
                fmt::format("a group of {} pairs does not fit the subgroups of {} lanes of the device {}", shape.lanes,
                            device.physical().subgroup_size, device.name()));
  if (!std::has_single_bit(shape.levels) || shape.levels < 2 || shape.levels > 16 ||
      !std::has_single_bit(shape.workgroups) || shape.workgroups > most_workgroups)
    throw Error(Failure::out_of_range, 0,
                fmt::format("{} levels and {} workgroups: both must be powers of two, 2 to 16 and 1 to {}",
                            shape.levels, shape.workgroups, most_workgroups));
  const Layout layout(shape, device.largest_range(), input.lmax);
  const Kernel& kernel = device.kernel({"moments",
                                        shaders::moments,
                                        MOMENTS_BINDINGS,
                                        sizeof(shaders::MomentsPush),
                                        {shape.lanes, shape.levels, private_columns(shape, input.lmax),
                                         shape.rows_in_buffer ? 1U : 0U, std::uint32_t(input.column_scale)}});
  const Kernel& sum_kernel =
      device.kernel({"moments_sum", shaders::moments_sum, MOMENTS_SUM_BINDINGS, sizeof(shaders::MomentsSumPush), {64}});

  Buffer pairs(device, input.pairs.size_bytes(), "the triangle pairs");
  Buffer degrees(device, input.last_degrees.size_bytes(), "the last degrees");
  Buffer partial(device, 8 * layout.partial_doubles(), "the partial sums");
  Buffer total(device, 8 * layout.total_doubles(), "the sums");
  const std::uint64_t resident = std::min<std::uint64_t>(groups, layout.chunk);
  Buffer state(device, layout.keeps_state() ? resident * layout.state_bytes() : 16, "the recursion's rows");
  pairs.write(std::as_bytes(input.pairs));
  degrees.write(std::as_bytes(input.last_degrees));
  Buffer steps(device, input.last_degrees.size_bytes(), "the step counts");
  partial.clear();
  total.clear();
  steps.clear();

  double all = 0, done = 0;
  for (const std::uint32_t l : input.last_degrees) all += double(l + 1) * double(l + 2);
  Job job(device);
  const auto finish_job = [&]() {
    job.run();
    if (!hook(std::min(1.0, done / all))) throw Error(Failure::stopped, 0, "stopped between two batches");
  };

  const std::uint64_t input_bytes = std::uint64_t(8) * MOMENTS_INPUTS * shape.lanes;
  for (std::uint64_t first = 0; first < groups; first += layout.chunk) {
    const auto count = std::uint32_t(std::min<std::uint64_t>(layout.chunk, groups - first));
    const auto last_degree = [&](std::uint32_t g) { return input.last_degrees[first + g]; };
    for (const Slice& slice : layout.slices) {
      std::uint32_t active = 0;
      while (active < count && last_degree(active) >= slice.first) ++active;
      if (active == 0) break;
      for (std::uint32_t begin = 0; begin < active;) {
        // Workgroup 0 has the longest groups: what it may do bounds the dispatch.
        std::uint64_t iterations = 0;
        std::uint32_t end = begin;
        while (end < active) {
          const std::uint32_t last = std::min(last_degree(end), slice.last);
          iterations += layout.iterations(slice.first, last, layout.keeps_state());
          if (end > begin && iterations > shape.iteration_budget) break;
          end += shape.workgroups;
        }
        end = std::min(end, active);
        const shaders::MomentsPush push = {std::ldexp(1.0, input.start_exponent),
                                           std::uint32_t(first),
                                           begin,
                                           end,
                                           slice.first,
                                           slice.last,
                                           std::uint32_t(slice.size),
                                           layout.state_columns()};
        const BufferRange ranges[MOMENTS_BINDINGS] = {
            {&pairs, first * input_bytes, count * input_bytes},
            {&degrees, 0, 0},
            {&state, 0, layout.keeps_state() ? std::min<std::uint64_t>(count, resident) * layout.state_bytes() : 0},
            {&partial, 0, 8 * slice.size * shape.workgroups},
            {&steps, 0, 0}};
        job.dispatch(kernel, ranges, push_bytes(push), std::min(shape.workgroups, end - begin));
        for (std::uint32_t g = begin; g < end; ++g) {
          const double to = std::min(last_degree(g), slice.last), from = slice.first - 1.0;
          done += (to + 1) * (to + 2) - (slice.first == 1 ? 0 : (from + 1) * (from + 2));
        }
        begin = end;
        if (job.dispatches() >= dispatches_per_job) finish_job();
      }
      const shaders::MomentsSumPush push = {std::uint32_t(slice.size), std::uint32_t(slice.size), shape.workgroups};
      const BufferRange ranges[MOMENTS_SUM_BINDINGS] = {{&partial, 0, 8 * slice.size * shape.workgroups},
                                                        {&total, 8 * slice.offset, 8 * slice.size}};
      // Enough invocations that none of them loops for long.
      job.dispatch(sum_kernel, ranges, push_bytes(push),
                   std::uint32_t(std::min<std::uint64_t>((slice.size + 255) / 256, 16384)));
    }
  }
  finish_job();

  std::vector<std::uint32_t> steps_done(groups);
  steps.read(std::as_writable_bytes(std::span(steps_done)));
  for (std::uint32_t g = 0; g < groups; ++g)
    if (steps_done[g] != layout.steps(input.last_degrees[g]))
      throw Error(
          Failure::cut_short, 0,
          fmt::format("the device {} ended a loop early: group {} of {} ran {} of {} steps; the result would be "
                      "wrong; use --device cpu and report this",
                      device.name(), g, groups, steps_done[g], layout.steps(input.last_degrees[g])));

  for (const Slice& slice : layout.slices) {
    std::vector<double> part(slice.size);
    total.read(std::as_writable_bytes(std::span(part)), 8 * slice.offset);
    gather(shape, layout, slice, part, sums);
  }
}

} // namespace cowgpu::engine

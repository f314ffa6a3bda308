#include "engine/kernels/potential.hpp"

#include "engine/job.hpp"
#include "shaders/potential.h"
#include "shaders/potential.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu::engine {
namespace {

constexpr std::uint32_t width = 64;
constexpr std::uint64_t alignment = 256; // the most that texel buffers may ask of offsets
constexpr std::uint64_t texel_bytes = 16;

std::uint64_t entries_of(std::uint32_t top) {
  return (std::uint64_t(top) + 1) * (std::uint64_t(top) + 2) / 2;
}

std::uint64_t aligned(std::uint64_t bytes) {
  return (bytes + alignment - 1) / alignment * alignment;
}

} // namespace

std::uint64_t Potential::device_bytes(std::uint32_t top, std::uint32_t sets, std::uint64_t lanes) {
  // At worst every order has a range of its own.
  return entries_of(top) * texel_bytes * (1 + sets) + alignment * (std::uint64_t(top) + 1) +
         lanes * (32 * (POTENTIAL_INPUTS + 2 + sets) + 8);
}

Potential::Potential(Device& device, const PotentialInput& input)
    : device_(device), top_(input.top), sets_(input.sets) {
  const std::uint64_t entry_bytes = texel_bytes * (1 + sets_);
  const std::uint64_t most =
      std::min<std::uint64_t>(device.limits().maxTexelBufferElements / (1 + sets_), input.iteration_budget);
  if (std::uint64_t(top_) + 2 > most)
    throw Error(
        Failure::out_of_range, 0,
        fmt::format("a potential to degree {} takes {} loop iterations and {} texels at once; the device {} has "
                    "{} texels a buffer, and {} iterations are allowed; use --device cpu or a lower degree",
                    top_, top_ + 2, (std::uint64_t(top_) + 2) * (1 + sets_), device.name(),
                    device.limits().maxTexelBufferElements, input.iteration_budget));
  std::uint64_t offset = 0;
  for (std::uint32_t first = 0; first <= top_;) {
    std::uint64_t iterations = 0, bytes = 0;
    std::uint32_t end = first;
    for (; end <= top_ && iterations + (top_ - end + 2) <= most; ++end) {
      iterations += top_ - end + 2;
      bytes += (top_ - end + 1) * entry_bytes;
    }
    ranges_.push_back({first, end, offset, bytes});
    offset = aligned(offset + bytes);
    first = end;
  }
  table_ = std::make_unique<Buffer>(device, offset, "the series");
  std::span<const std::byte> rest = std::as_bytes(input.table);
  for (const Range& range : ranges_) {
    table_->write(rest.first(range.bytes), range.offset);
    rest = rest.subspan(range.bytes);
  }
}

Potential::~Potential() = default;

std::uint32_t Potential::most_lanes() const {
  return device_.software() ? 1024 : 1U << 15;
}

void Potential::sum(std::span<const double> points, std::span<const std::uint32_t> tops, std::span<double> sums,
                    const Hook& hook) {
  const auto lanes = std::uint32_t(tops.size());
  const std::uint64_t state_doubles = potential_points_a_lane * (2 + sets_);
  const Kernel& kernel = device_.kernel({"potential",
                                         shaders::potential,
                                         POTENTIAL_BINDINGS,
                                         sizeof(shaders::PotentialPush),
                                         {width, sets_},
                                         {BindingKind::texel_doubles}});
  Buffer point_buffer(device_, points.size_bytes(), "the points");
  Buffer top_buffer(device_, tops.size_bytes(), "the points' degrees");
  Buffer state(device_, 8 * state_doubles * lanes, "the sums");
  Buffer seen(device_, 4 * std::uint64_t(lanes), "the counts");
  point_buffer.write(std::as_bytes(points));
  top_buffer.write(std::as_bytes(tops));
  const std::uint32_t top = *std::max_element(tops.begin(), tops.end());
  Job job(device_);
  for (const Range& range : ranges_) {
    if (range.first > top) break;
    const shaders::PotentialPush push = {lanes, range.first, range.end, top_};
    const BufferRange ranges[POTENTIAL_BINDINGS] = {
        {table_.get(), range.offset, range.bytes}, {&point_buffer}, {&top_buffer}, {&state}, {&seen}};
    job.dispatch(kernel, ranges, std::as_bytes(std::span(&push, 1)), (lanes + width - 1) / width);
    job.run(); // one at a time: a stop is answered in between
    if (hook && !hook(double(range.end) / double(top_ + 1)))
      throw Error(Failure::stopped, 0, "stopped between two ranges of orders of the potential");
  }
  std::vector<std::uint32_t> counts(lanes);
  seen.read(std::as_writable_bytes(std::span(counts)));
  for (std::uint32_t lane = 0; lane < lanes; ++lane)
    if (counts[lane] != entries_of(tops[lane]))
      throw Error(
          Failure::cut_short, 0,
          fmt::format("the device {} ended a loop early: it summed {} of {} terms; the result would be wrong; use "
                      "--device cpu and report this",
                      device_.name(), counts[lane], entries_of(tops[lane])));
  std::vector<double> states(state_doubles * lanes);
  state.read(std::as_writable_bytes(std::span(states)));
  const std::size_t skipped = 2 * potential_points_a_lane, own = potential_points_a_lane * sets_;
  for (std::uint32_t lane = 0; lane < lanes; ++lane) {
    const auto from = states.begin() + std::ptrdiff_t(lane * state_doubles + skipped);
    std::copy(from, from + std::ptrdiff_t(own), sums.begin() + std::ptrdiff_t(lane * own));
  }
}

} // namespace cowgpu::engine

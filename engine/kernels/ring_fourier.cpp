#include "engine/kernels/ring_fourier.hpp"

#include "engine/job.hpp"
#include "shaders/ring_fourier.h"
#include "shaders/ring_fourier.hpp"
#include "shaders/ring_fourier_pass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu::engine {
namespace {

constexpr std::uint32_t pass_lanes = 64;
constexpr std::uint32_t most_workgroups = 16384;

std::vector<BindingKind> binding_kinds() {
  return {BindingKind::texel_double, BindingKind::texel_doubles, BindingKind::texel_doubles,
          BindingKind::texel_doubles};
}

bool has_butterfly(std::uint32_t radix) {
  return radix <= 5 || radix == 8;
}

// Few different sizes, so that a compiled shader serves many rings.
std::uint32_t private_size(std::uint32_t points) {
  std::uint32_t size = 64;
  while (size < points) size *= size < 1024 ? 4 : 2;
  return size;
}

// Loop iterations of one invocation of ring_fourier.
std::uint64_t iterations(std::uint32_t points, std::uint32_t orders, const std::vector<std::uint32_t>& radices,
                         bool to_waves) {
  std::uint64_t count = to_waves ? points + orders : 2 * std::uint64_t(points);
  std::uint64_t length = points;
  for (const std::uint32_t radix : radices) {
    count += 1 + length / radix + points / radix;
    length /= radix;
  }
  return count;
}

} // namespace

std::vector<std::uint32_t> ring_radices(std::uint32_t points) {
  std::vector<std::uint32_t> radices;
  for (const std::uint32_t radix : {8U, 4U, 2U, 3U, 5U})
    for (; points % radix == 0; points /= radix) radices.push_back(radix);
  for (std::uint32_t prime = 7; points > 1; prime += 2) {
    if (prime * prime > points) prime = points;
    for (; points % prime == 0; points /= prime) radices.push_back(prime);
  }
  return radices;
}

bool rings_through_buffers(const RingFourierShape& shape, std::uint32_t points) {
  const auto radices = ring_radices(points);
  return !std::all_of(radices.begin(), radices.end(), has_butterfly) || points > shape.private_points ||
         radices.size() > RING_FOURIER_MOST_PASSES ||
         iterations(points, points, radices, true) > shape.iteration_budget;
}

RingFourier::RingFourier(Device& device, const RingFourierShape& shape, const RingFourierInput& input)
    : device_(device), shape_(shape), points_(std::uint32_t(input.points)), orders_(std::uint32_t(input.orders)),
      radices_(ring_radices(points_)), through_buffers_(rings_through_buffers(shape, points_)) {
  std::vector<double> table;
  table.reserve(2 * std::size_t(points_));
  for (std::uint32_t j = 0; j < points_; ++j) {
    const long double angle = 2 * std::numbers::pi_v<long double> * j / points_;
    table.push_back(double(std::cos(angle)));
    table.push_back(double(std::sin(angle)));
  }
  twiddles_ = std::make_unique<Buffer>(device, 8 * table.size(), "the roots of unity");
  twiddles_->write(std::as_bytes(std::span(table)));
  table.clear();
  for (std::size_t i = 0; i < input.x.size(); ++i) {
    table.push_back(input.weight[i]);
    table.push_back(input.x[i]);
  }
  rings_ = std::make_unique<Buffer>(device, 8 * table.size(), "the weights of rings");
  rings_->write(std::as_bytes(std::span(table)));
}

RingFourier::~RingFourier() = default;

void RingFourier::to_waves(Job& job, const Work& work) {
  through_buffers_ ? pass_by_pass(job, work, true) : whole_rings(job, work, true);
}

void RingFourier::to_values(Job& job, const Work& work) {
  through_buffers_ ? pass_by_pass(job, work, false) : whole_rings(job, work, false);
}

namespace {
shaders::RingFourierPush push_for(const RingFourier::Work& work, std::uint32_t points, std::uint32_t orders) {
  shaders::RingFourierPush push{};
  push.points = points;
  push.orders = orders;
  push.wave_columns = work.columns;
  push.fields = work.fields;
  push.pairs = work.slab.count;
  push.first_pair = work.slab.first;
  push.weighted = work.weighted ? 1 : 0;
  return push;
}
} // namespace

void RingFourier::whole_rings(Job& job, const Work& work, bool to_waves) {
  const std::uint64_t values_bytes = std::uint64_t(16) * work.fields * work.slab.count * points_;
  const std::uint64_t waves_bytes = std::uint64_t(32) * work.fields * work.slab.count * work.columns;
  std::uint32_t mask = 0;
  for (const std::uint32_t radix : radices_) mask |= 1U << radix;
  const Kernel& kernel = device_.kernel({"ring_fourier",
                                         shaders::ring_fourier,
                                         RING_FOURIER_COUNTS + 1,
                                         sizeof(shaders::RingFourierPush),
                                         {shape_.lanes, to_waves ? 1U : 0U, private_size(points_), mask},
                                         binding_kinds()});
  shaders::RingFourierPush push = push_for(work, points_, orders_);
  push.passes = std::uint32_t(radices_.size());
  std::copy(radices_.begin(), radices_.end(), push.radix);
  counted_ = (work.slab.count + shape_.lanes - 1) / shape_.lanes * work.fields;
  expected_ = std::uint32_t(iterations(points_, orders_, radices_, to_waves));
  if (!counts_ || counts_->size() < 4 * counted_)
    counts_ = std::make_unique<Buffer>(device_, 4 * counted_, "the step counts of rings");
  const BufferRange ranges[] = {{work.values, 0, values_bytes}, {work.waves, 0, waves_bytes}, {twiddles_.get()},
                                {rings_.get()},                 {work.values, 0, values_bytes}, {work.waves, 0, waves_bytes},
                                {counts_.get()}};
  job.dispatch(kernel, ranges, std::as_bytes(std::span(&push, 1)), counted_);
}

void RingFourier::pass_by_pass(Job& job, const Work& work, bool to_waves) {
  const std::uint64_t rows = std::uint64_t(work.fields) * work.slab.count;
  const std::uint64_t values_bytes = 16 * rows * points_, waves_bytes = 32 * rows * work.columns;
  if (!first_ || first_->size() < 16 * rows * points_) {
    first_ = std::make_unique<Buffer>(device_, 16 * rows * points_, "the passes of ring transforms");
    second_ = std::make_unique<Buffer>(device_, 16 * rows * points_, "the passes of ring transforms");
  }
  const Buffer *from = first_.get(), *to = second_.get();
  const auto dispatch = [&](std::uint32_t kind, std::uint64_t each, std::uint32_t radix, std::uint32_t length) {
    const std::uint64_t workgroups = std::min<std::uint64_t>((rows * each + pass_lanes - 1) / pass_lanes, most_workgroups);
    const std::uint64_t turns = (rows * each - 1) / (workgroups * pass_lanes) + 1;
    const std::uint64_t loops = turns * (1 + (has_butterfly(radix) ? 0 : radix + 1));
    if (loops > shape_.iteration_budget)
      throw Error(Failure::out_of_range, 0,
                  fmt::format("rings of {} points have the prime factor {}, too large for the loops of the device {} "
                              "({} iterations, {} allowed); take another ring length, or --device cpu",
                              points_, radix, device_.name(), loops, shape_.iteration_budget));
    const Kernel& kernel = device_.kernel({"ring_fourier_pass",
                                           shaders::ring_fourier_pass,
                                           RING_FOURIER_BINDINGS,
                                           sizeof(shaders::RingFourierPush),
                                           {pass_lanes, kind},
                                           binding_kinds()});
    shaders::RingFourierPush push = push_for(work, points_, orders_);
    push.radix[0] = radix;
    push.span = length;
    const BufferRange ranges[] = {{work.values, 0, values_bytes}, {work.waves, 0, waves_bytes}, {twiddles_.get()},
                                  {rings_.get()},                 {work.values, 0, values_bytes}, {work.waves, 0, waves_bytes},
                                  {from, 0, 16 * rows * points_}, {to, 0, 16 * rows * points_}};
    job.dispatch(kernel, ranges, std::as_bytes(std::span(&push, 1)), std::uint32_t(workgroups));
    std::swap(from, to);
  };
  dispatch(to_waves ? RING_FOURIER_READ_VALUES : RING_FOURIER_READ_WAVES, points_, 1, points_);
  std::uint32_t length = points_;
  for (const std::uint32_t radix : radices_) {
    dispatch(RING_FOURIER_PASS, has_butterfly(radix) ? points_ / radix : points_, radix, length);
    length /= radix;
  }
  dispatch(to_waves ? RING_FOURIER_WRITE_WAVES : RING_FOURIER_WRITE_VALUES, to_waves ? orders_ : points_, 1, points_);
}

void RingFourier::check_counts() {
  std::vector<std::uint32_t> counts(counted_);
  if (counted_) counts_->read(std::as_writable_bytes(std::span(counts)));
  for (const std::uint32_t count : counts)
    if (count != expected_)
      throw Error(Failure::cut_short, 0,
                  fmt::format("the device {} ended a loop early: a ring transform ran {} of {} steps; the result would "
                              "be wrong; use --device cpu and report this",
                              device_.name(), count, expected_));
}

} // namespace cowgpu::engine

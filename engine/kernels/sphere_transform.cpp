#include "engine/kernels/sphere_transform.hpp"

#include "engine/host_buffer.hpp"
#include "engine/job.hpp"

#include <algorithm>

namespace cowgpu::engine {
namespace {

// Pairs of rings of a slab, a multiple of 8: waves, values and passes fit into one binding each.
std::uint32_t slab_pairs(std::uint64_t most_bytes, std::uint64_t columns, std::uint64_t points, std::uint64_t fields,
                         std::uint32_t pairs) {
  // Texels of one double are counted like those of two, hence 32 bytes a point.
  const std::uint64_t each = fields * std::max(32 * columns, 32 * points);
  const std::uint64_t fit = std::max<std::uint64_t>(most_bytes / each / 8 * 8, 8);
  return std::uint32_t(std::min<std::uint64_t>(fit, pairs));
}

void stop_if(bool go_on) {
  if (!go_on) throw Error(Failure::stopped, 0, "stopped between two batches");
}

} // namespace

SphereTransformShape sphere_transform_shape(const GpuFacts& facts, SphereTransformShape wanted) {
  wanted.legendre = legendre_shape(facts, wanted.legendre);
  if (wanted.fourier.lanes == 0) wanted.fourier.lanes = facts.subgroup_size;
  if (facts.type != "software") wanted.fourier.private_points = 0;
  return wanted;
}

std::uint64_t sphere_transform_device_bytes(const SphereTransformShape& shape, const GpuFacts& facts, int lmax,
                                            int pairs, int points, int fields) {
  if (fields <= 0) return 0;
  const LegendreSizes sizes(shape.legendre, lmax);
  const std::uint64_t together = std::min<std::uint64_t>(std::uint64_t(fields), most_fields_together);
  const std::uint64_t lanes = sizes.lanes, steps = sizes.first_step.back(), series = 8 * sizes.series_doubles(together);
  const std::uint64_t slab = slab_pairs(shape.legendre.most_bytes, sizes.columns, std::uint64_t(points), together,
                                        std::uint32_t(pairs));
  const std::uint64_t segments = sizes.first_step[1] / shape.legendre.steps;
  // Recurrence, start values, first active rings, rings and roots of unity.
  const std::uint64_t fixed = 32 * steps * lanes + 16 * sizes.columns * pairs + 4 * segments * sizes.groups +
                              32 * std::uint64_t(pairs) + 16 * std::uint64_t(points);
  // Partial sums are cut so that those of some orders fit into a binding.
  const std::uint64_t slots = std::uint64_t(slab) / shape.legendre.analysis_pairs + 1;
  const std::uint64_t partial = slots == 1 && int(slab) == pairs ? 0 : std::min(slots * series, facts.largest_range);
  const std::uint64_t pairs_an_item = std::min(shape.legendre.synthesis_pairs, shape.legendre.analysis_pairs);
  const std::uint64_t items = 2 * 40 * sizes.groups * (std::uint64_t(pairs) / pairs_an_item + 2) * together;
  const std::uint64_t point_bytes = rings_through_buffers(shape.fourier, std::uint32_t(points)) ? 48 : 16;
  const std::uint64_t slab_bytes =
      together * slab * (32 * std::uint64_t(sizes.columns) + point_bytes * std::uint64_t(points));
  return fixed + series + partial + items + slab_bytes + (std::uint64_t(1) << 16);
}

SphereTransform::SphereTransform(Device& device, const SphereTransformShape& shape, const LegendreInput& legendre,
                                 const RingFourierInput& fourier)
    : device_(device), shape_(shape), pairs_(std::uint32_t(legendre.t.size())), points_(std::uint32_t(fourier.points)),
      legendre_(device, shape.legendre, legendre), fourier_(device, shape.fourier, fourier),
      job_(std::make_unique<Job>(device)) {}

SphereTransform::~SphereTransform() = default;

std::uint32_t SphereTransform::together(std::uint32_t fields) const {
  std::uint32_t count = std::min(fields, most_fields_together);
  const std::uint64_t largest = device_.physical().largest_allocation;
  while (largest && count > 1 && 8 * legendre_.sizes().series_doubles(count) > largest) --count;
  return count;
}

std::size_t SphereTransform::series_index(int m, std::uint32_t f, std::uint32_t fields) const {
  const std::uint32_t lanes = legendre_.sizes().lanes, order = std::uint32_t(m);
  return 4 * ((legendre_.sizes().first_step[order / lanes] * fields + f) * lanes + order % lanes);
}

std::size_t SphereTransform::series_stride(std::uint32_t fields) const {
  return std::size_t(4) * fields * legendre_.sizes().lanes;
}

std::size_t SphereTransform::series_steps(int m) const {
  const std::uint32_t group = std::uint32_t(m) / legendre_.sizes().lanes;
  return legendre_.sizes().first_step[group + 1] - legendre_.sizes().first_step[group];
}

std::vector<RingSlab> SphereTransform::slabs(std::uint32_t fields) const {
  const std::uint32_t size =
      slab_pairs(shape_.legendre.most_bytes, legendre_.sizes().columns, points_, fields, pairs_);
  std::vector<RingSlab> list;
  for (std::uint32_t first = 0; first < pairs_; first += size) list.push_back({first, std::min(size, pairs_ - first)});
  return list;
}

// Buffers are kept from call to call, and replaced where they are too small.
void SphereTransform::allocate(std::uint32_t fields) {
  const std::uint64_t slab = slabs(fields)[0].count;
  const std::uint64_t series = 8 * legendre_.sizes().series_doubles(fields);
  const std::uint64_t waves = 32 * slab * fields * legendre_.sizes().columns, values = 16 * slab * fields * points_;
  const auto too_small = [](const auto& buffer, std::uint64_t bytes) { return !buffer || buffer->size() < bytes; };
  if (too_small(series_, series)) {
    series_.reset();
    series_ = std::make_unique<HostBuffer>(device_, series, "the series of the orders");
    series_->clear();
  }
  if (too_small(values_, values)) {
    values_.reset();
    values_ = std::make_unique<HostBuffer>(device_, values, "the values on the rings");
  }
  if (too_small(waves_, waves)) {
    waves_.reset();
    waves_ = std::make_unique<Buffer>(device_, waves, "the waves of the rings");
    waves_->clear(); // columns beyond the last order stay 0
  }
}

void SphereTransform::to_values(std::uint32_t fields, bool weighted,
                                const std::function<void(std::span<double>)>& prepare, const Values& take,
                                const Hook& hook) {
  allocate(fields);
  const auto list = slabs(fields);
  prepare(series_->host<double>());
  series_->send();
  for (std::size_t s = 0; s < list.size(); ++s) {
    const auto at = [&](double part) { stop_if(hook((double(s) + part) / double(list.size()))); };
    legendre_.synthesis(*job_, series_->buffer(), *waves_, list[s], fields, at);
    fourier_.to_values(*job_, {&values_->buffer(), waves_.get(), list[s], fields, legendre_.sizes().columns, weighted});
    job_->run();
    legendre_.check_counts();
    fourier_.check_counts();
    at(1);
    values_->receive();
    take(list[s], values_->host<double>());
  }
}

void SphereTransform::to_series(std::uint32_t fields, bool weighted, const Values& give,
                                const std::function<void(std::span<const double>)>& finish, const Hook& hook) {
  allocate(fields);
  const auto list = slabs(fields);
  for (std::size_t s = 0; s < list.size(); ++s) {
    const auto at = [&](double part) { stop_if(hook((double(s) + part) / double(list.size()))); };
    give(list[s], values_->host<double>());
    values_->send();
    fourier_.to_waves(*job_, {&values_->buffer(), waves_.get(), list[s], fields, legendre_.sizes().columns, weighted});
    legendre_.analysis(*job_, *waves_, series_->buffer(), list[s], fields, s == 0, at);
    job_->run();
    legendre_.check_counts();
    fourier_.check_counts();
    at(1);
  }
  series_->receive();
  finish(series_->host<const double>());
}

} // namespace cowgpu::engine

#include "engine/kernels/translations.hpp"

#include "engine/job.hpp"
#include "shaders/translations.h"
#include "shaders/translations.hpp"
#include "shaders/translations_sum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace cowgpu::engine {
namespace {

static_assert(std::uint32_t(TranslationStep::multiply) == TRANSLATIONS_MULTIPLY &&
              std::uint32_t(TranslationStep::take) == TRANSLATIONS_TAKE &&
              std::uint32_t(TranslationStep::tilt) == TRANSLATIONS_TILT &&
              std::uint32_t(TranslationStep::tilt_back) == TRANSLATIONS_TILT_BACK &&
              std::uint32_t(TranslationStep::give) == TRANSLATIONS_GIVE);

using Texel = std::array<std::uint32_t, 4>;
constexpr std::uint64_t vector_bytes = 8 * translation_densities, run_bytes = 16, pair_bytes = 32;
constexpr std::uint32_t sum_width = 128;
constexpr std::uint64_t most_bytes = std::uint64_t(128) << 20; // largest buffer: every device binds so many bytes
constexpr std::uint64_t most_software_bytes = std::uint64_t(8) << 20; // in the caches of processors
constexpr std::uint64_t most_at_once = 1 << 16;                       // pairs

std::uint64_t harmonics(std::uint64_t order) {
  return (order + 1) * (order + 1);
}

// Loop iterations that a lane counts and runs.
std::uint32_t steps_of(std::span<const TranslationRecord> records) {
  std::uint32_t steps = 0;
  for (const TranslationRecord& r : records) steps += 1 + (r.step == TranslationStep::multiply ? r.columns : r.degree);
  return steps;
}

} // namespace

Translations::Translations(Device& device, const TranslationsInput& input)
    : device_(device), width_(device.software() ? device.physical().subgroup_size : 32), places_(input.places) {
  std::vector<Texel> texels;
  const auto matrix_texels = std::uint32_t((input.matrix.size() + 1) / 2);
  for (const auto& records : input.orders) {
    const std::uint32_t steps = steps_of(records);
    if (steps > input.iteration_budget)
      throw Error(Failure::out_of_range, 0,
                  fmt::format("translations of order {} take {} loop iterations, and {} are allowed; use --device cpu "
                              "or a larger tolerance",
                              orders_.size(), steps, input.iteration_budget));
    orders_.push_back({matrix_texels + std::uint32_t(texels.size()), std::uint32_t(records.size()), steps});
    for (const TranslationRecord& r : records) {
      if (r.step == TranslationStep::multiply)
        texels.push_back({TRANSLATIONS_MULTIPLY, r.entries / 2, r.place, r.columns | r.stride << 16});
      else
        texels.push_back({std::uint32_t(r.step), r.degree, 0, r.place});
      texels.push_back(r.rows);
    }
  }
  if (matrix_texels + texels.size() > device.limits().maxTexelBufferElements)
    throw Error(Failure::out_of_range, 0,
                fmt::format("translations take {} texels, and the device {} reads {} from a buffer; use --device cpu",
                            matrix_texels + texels.size(), device.name(), device.limits().maxTexelBufferElements));
  table_ = std::make_unique<Buffer>(device, (matrix_texels + texels.size()) * sizeof(Texel), "the translations");
  table_->write(std::as_bytes(input.matrix));
  table_->write(std::as_bytes(std::span(texels)), matrix_texels * sizeof(Texel));

  const std::uint64_t most = device.software() ? most_software_bytes : most_bytes;
  const std::uint64_t largest = std::max(most, vector_bytes * harmonics(highest()));
  // Parts of buffers begin at multiples of 64 pairs.
  const std::uint64_t rooms = most / (vector_bytes * places_ * width_);
  groups_ = std::uint32_t(std::max<std::uint64_t>(1, rooms * width_ / 64) * 64 / width_);
  multipoles_ = std::make_unique<Buffer>(device, largest, "the multipoles");
  expanded_ = std::make_unique<Buffer>(device, largest, "the translated multipoles");
  pairs_ = std::make_unique<Buffer>(device, pair_bytes * most_at_once, "the pairs of cells");
  seen_ = std::make_unique<Buffer>(device, 4 * most_at_once, "the counts");
  runs_ = std::make_unique<Buffer>(device, run_bytes * most_at_once, "the pairs' targets");
  room_ = std::make_unique<Buffer>(device, vector_bytes * places_ * width_ * groups_, "the lanes' rooms");
}

Translations::~Translations() = default;

std::uint64_t Translations::device_bytes(int highest_order, std::uint64_t locals) {
  const std::uint64_t of_one = vector_bytes * harmonics(std::uint64_t(highest_order));
  return 3 * std::max(most_bytes, of_one) + (pair_bytes + run_bytes + 4) * most_at_once + locals * of_one;
}

std::size_t Translations::most_sources(int order) const {
  return std::max<std::size_t>(1, multipoles_->size() / (vector_bytes * harmonics(std::uint64_t(order))));
}

std::size_t Translations::most_pairs(int order) const {
  return std::clamp<std::size_t>(expanded_->size() / (vector_bytes * harmonics(std::uint64_t(order))), 1, most_at_once);
}

void Translations::begin(std::size_t locals) {
  const std::uint64_t bytes = std::max<std::size_t>(1, locals) * vector_bytes * harmonics(highest());
  if (!locals_ || locals_->size() < bytes) {
    locals_.reset();
    locals_ = std::make_unique<Buffer>(device_, bytes, "the local expansions");
  }
  locals_->clear();
}

void Translations::add(int order, std::span<const double> multipoles, std::span<const TranslationPair> pairs,
                       std::span<const TranslationRun> runs) {
  if (pairs.empty()) return;
  const Order& own = orders_[std::size_t(order)];
  const auto size = std::uint32_t(harmonics(std::uint64_t(order)));
  multipoles_->write(std::as_bytes(multipoles));
  std::vector<std::array<double, 4>> places;
  for (const TranslationPair& pair : pairs)
    places.push_back({pair.shift[0], pair.shift[1], pair.shift[2], 0x1p52 + double(pair.source)});
  std::vector<Texel> targets;
  for (const TranslationRun& run : runs) targets.push_back({run.local, run.first, run.count, 0});
  pairs_->write(std::as_bytes(std::span(places)));
  runs_->write(std::as_bytes(std::span(targets)));

  const Kernel& kernel = device_.kernel({"translations",
                                         shaders::translations,
                                         TRANSLATIONS_BINDINGS,
                                         sizeof(shaders::TranslationsPush),
                                         {width_, places_},
                                         {BindingKind::texel_doubles}});
  const Kernel& sum = device_.kernel({"translations_sum",
                                      shaders::translations_sum,
                                      TRANSLATIONS_SUM_BINDINGS,
                                      sizeof(shaders::TranslationsSumPush),
                                      {sum_width}});
  Job job(device_);
  const std::size_t most = std::size_t(groups_) * width_;
  for (std::size_t first = 0; first < pairs.size(); first += most) {
    const std::size_t count = std::min(most, pairs.size() - first);
    const shaders::TranslationsPush push = {std::uint32_t(count), own.first, own.records, size};
    const BufferRange bound[TRANSLATIONS_BINDINGS] = {
        {table_.get()},
        {multipoles_.get()},
        {pairs_.get(), first * pair_bytes, count * pair_bytes},
        {expanded_.get(), first * vector_bytes * size, count * vector_bytes * size},
        {room_.get()},
        {seen_.get(), first * 4, count * 4}};
    job.dispatch(kernel, bound, std::as_bytes(std::span(&push, 1)), std::uint32_t((count + width_ - 1) / width_));
  }
  const std::uint64_t lanes = std::uint64_t(runs.size()) * size;
  const shaders::TranslationsSumPush push = {std::uint32_t(runs.size()), size, std::uint32_t(harmonics(highest())), 0};
  const BufferRange bound[TRANSLATIONS_SUM_BINDINGS] = {{runs_.get()}, {expanded_.get()}, {locals_.get()}};
  job.dispatch(sum, bound, std::as_bytes(std::span(&push, 1)), std::uint32_t((lanes + sum_width - 1) / sum_width));
  job.run();
  std::vector<std::uint32_t> counts(pairs.size());
  seen_->read(std::as_writable_bytes(std::span(counts)));
  for (const std::uint32_t count : counts)
    if (count != own.steps)
      throw Error(
          Failure::cut_short, 0,
          fmt::format("the device {} ended a loop early: it did {} of {} steps of a translation; the result would be "
                      "wrong; use --device cpu and report this",
                      device_.name(), count, own.steps));
}

void Translations::read(std::span<double> locals) {
  locals_->read(std::as_writable_bytes(locals));
}

} // namespace cowgpu::engine

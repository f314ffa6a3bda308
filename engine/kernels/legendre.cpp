#include "engine/kernels/legendre.hpp"

#include "engine/host_buffer.hpp"
#include "engine/job.hpp"
#include "shaders/legendre.h"
#include "shaders/legendre_analysis.hpp"
#include "shaders/legendre_sum.hpp"
#include "shaders/legendre_synthesis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace cowgpu::engine {
namespace {

constexpr std::uint32_t block_pairs = 8; // pairs in a block of the plan
constexpr double batch_work = 4e9;       // multiply-adds of a dispatch, so that stops are answered within a second

std::vector<BindingKind> binding_kinds() {
  return std::vector<BindingKind>(LEGENDRE_RINGS + 1, BindingKind::texel_doubles);
}

} // namespace

LegendreShape legendre_shape(const GpuFacts& facts, LegendreShape wanted) {
  const bool software = facts.type == "software";
  if (wanted.lanes == 0) wanted.lanes = facts.subgroup_size;
  if (wanted.steps == 0) wanted.steps = software ? 32 : 8;
  const auto choose = [&](LegendreShape::ByFields& rings, const LegendreShape::ByFields& on_software) {
    for (std::size_t f = 0; f < rings.size(); ++f)
      if (rings[f] == 0) rings[f] = software ? on_software[f] : 4;
  };
  choose(wanted.analysis_rings, {4, 2, 2});
  choose(wanted.synthesis_rings, {2, 1, 1});
  if (wanted.analysis_pairs == 0) wanted.analysis_pairs = software ? 1024 : 64;
  if (wanted.synthesis_pairs == 0) wanted.synthesis_pairs = software ? 128 : wanted.synthesis_rings[0];
  if (wanted.most_bytes == 0) wanted.most_bytes = facts.largest_range;
  wanted.most_bytes = std::min({wanted.most_bytes, facts.largest_range, 16 * facts.largest_texels});
  return wanted;
}

LegendreSizes::LegendreSizes(const LegendreShape& shape, int lmax) : lanes(shape.lanes) {
  groups = std::uint32_t(lmax) / lanes + 1;
  columns = groups * lanes;
  first_step.assign(1, 0);
  for (std::uint32_t g = 0; g < groups; ++g) {
    const std::uint64_t steps = (std::uint64_t(lmax) - std::uint64_t(g) * lanes) / 2 + 1;
    first_step.push_back(first_step.back() + (steps + shape.steps - 1) / shape.steps * shape.steps);
  }
}

// Consecutive groups of orders whose arrays fit into one binding each.
struct Legendre::Chunk {
  std::uint32_t begin = 0, end = 0; // groups
  std::uint32_t slots = 1;          // partial sums
  std::vector<Batch> batches;
};

// What one dispatch works on.
struct Legendre::Batch {
  std::uint32_t first = 0, count = 0; // items
  double work = 0;                    // multiply-adds
};

// An item and what it takes.
struct Legendre::Work {
  shaders::LegendreItem item;
  Cost cost;
};

// The items of one direction for a slab and a number of fields.
struct Legendre::Layout {
  RingSlab slab;
  std::uint32_t fields = 0;
  bool analysis = false;
  std::vector<shaders::LegendreItem> items;
  std::vector<std::uint32_t> expected; // counts
  std::vector<Chunk> chunks;
  std::unique_ptr<Buffer> item_buffer, counts;
};

Legendre::Legendre(Device& device, const LegendreShape& shape, const LegendreInput& input)
    : device_(device), shape_(shape), sizes_(shape, input.lmax), pairs_(std::uint32_t(input.t.size())),
      polar_pairs_(std::uint32_t(input.polar_pairs)) {
  check_shape();
  upload(input);
}

Legendre::~Legendre() = default;

void Legendre::check_shape() const {
  const auto refuse = [&](const std::string& why) { throw Error(Failure::out_of_range, 0, why); };
  if (shape_.lanes != device_.physical().subgroup_size)
    refuse(fmt::format("a group of {} orders does not fit the subgroups of {} lanes of the device {}", shape_.lanes,
                       device_.physical().subgroup_size, device_.name()));
  if (shape_.steps == 0 || shape_.steps % 8 || shape_.steps > 64)
    refuse(fmt::format("segments of {} steps: 8, 16, ... 64 are possible", shape_.steps));
  const auto check = [&](const LegendreShape::ByFields& all, std::uint32_t pairs) {
    for (const std::uint32_t rings : all) {
      if (!std::has_single_bit(rings) || rings > block_pairs)
        refuse(fmt::format("{} pairs of rings at once: 1, 2, 4 or 8 are possible", rings));
      if (pairs == 0 || pairs % rings)
        refuse(fmt::format("{} pairs of rings a workgroup, which works on {} at once", pairs, rings));
    }
  };
  check(shape_.analysis_rings, shape_.analysis_pairs);
  check(shape_.synthesis_rings, shape_.synthesis_pairs);
}

void Legendre::upload(const LegendreInput& input) {
  const std::uint32_t lanes = sizes_.lanes, steps = shape_.steps, blocks = pairs_ / block_pairs;
  first_segments_ = std::uint32_t(sizes_.first_step[1] / steps);
  first_.assign(std::size_t(sizes_.groups) * first_segments_, pairs_);
  HostBuffer recurrence(device_, 32 * sizes_.first_step.back() * lanes, "the recurrence coefficients");
  HostBuffer seeds(device_, std::uint64_t(16) * sizes_.columns * pairs_, "the recurrence's start values");
  recurrence.clear();
  seeds.clear();
  const std::span<double> to = recurrence.host<double>(), seeds_to = seeds.host<double>();
  for (std::uint32_t g = 0; g < sizes_.groups; ++g) {
    const std::uint64_t count = sizes_.first_step[g + 1] - sizes_.first_step[g];
    for (std::uint32_t lane = 0; lane < lanes; ++lane) {
      const std::uint64_t m = std::uint64_t(g) * lanes + lane;
      if (m > std::uint64_t(input.lmax)) break;
      const std::size_t own = input.offset[m + 1] - input.offset[m];
      for (std::size_t k = 0; k < std::min<std::size_t>(own, count); ++k) {
        const std::uint64_t polar = 2 * ((2 * sizes_.first_step[g] + k) * lanes + lane),
                            other = polar + 2 * count * lanes;
        to[polar] = to[other] = input.a[input.offset[m] + k];
        to[polar + 1] = input.b_polar[input.offset[m] + k];
        to[other + 1] = input.b[input.offset[m] + k];
      }
      for (std::uint32_t pair = 0; pair < pairs_; ++pair) {
        const std::size_t from = ((m * blocks + pair / block_pairs) * 2) * block_pairs + pair % block_pairs;
        double* z = &seeds_to[2 * ((std::uint64_t(g) * pairs_ + pair) * lanes + lane)];
        z[0] = input.seeds[from];
        z[1] = input.seeds[from + block_pairs];
      }
    }
    for (std::uint32_t segment = 0; segment < count / steps; ++segment)
      for (std::uint32_t block = blocks; block-- > 0;)
        if (input.start[std::size_t(g) * blocks + block] <= segment)
          first_[std::size_t(g) * first_segments_ + segment] = block * block_pairs;
        else
          break;
  }
  HostBuffer rings(device_, std::uint64_t(16) * pairs_, "the rings");
  for (std::uint32_t pair = 0; pair < pairs_; ++pair) rings.host<double>()[2 * pair] = input.t[pair];
  rings_ = rings.hand_over();
  recurrence_ = recurrence.hand_over();
  seeds_ = seeds.hand_over();
  first_active_ = std::make_unique<Buffer>(device_, 4 * first_.size(), "the first active rings");
  first_active_->write(std::as_bytes(std::span(first_)));
}

std::vector<RingSlab> Legendre::ranges(RingSlab slab, std::uint32_t most, std::uint32_t multiple, bool analysis) const {
  std::vector<RingSlab> list;
  const auto cut = [&](std::uint32_t begin, std::uint32_t end) {
    if (begin >= end) return;
    const std::uint32_t parts = (end - begin + most - 1) / most;
    const std::uint32_t size = ((end - begin + parts - 1) / parts + multiple - 1) / multiple * multiple;
    for (; begin < end; begin += size) list.push_back({begin, std::min(size, end - begin)});
  };
  const std::uint32_t end = slab.first + slab.count, middle = std::clamp(polar_pairs_, slab.first, end);
  if (analysis) {
    cut(slab.first, end);
  } else {
    cut(slab.first, middle);
    cut(middle, end);
  }
  return list;
}

Legendre::Cost Legendre::cost(std::uint32_t group, RingSlab range, std::uint32_t rings, bool analysis) const {
  const std::uint32_t end = range.first + range.count;
  const auto turns = [&](std::uint32_t from, std::uint32_t to) { return to > from ? (to - from - 1) / rings + 1 : 0; };
  Cost cost;
  if (!analysis) cost.counted = 2 * turns(range.first, end);
  cost.segments = std::uint32_t((sizes_.first_step[group + 1] - sizes_.first_step[group]) / shape_.steps);
  std::uint32_t loaded = end;
  for (std::uint32_t s = 0; s < cost.segments; ++s) {
    const std::uint32_t begun = std::clamp(first_[std::size_t(group) * first_segments_ + s], range.first, end);
    if (begun == end && s == cost.first_segment) ++cost.first_segment;
    if (begun == end && !analysis) continue;
    std::uint32_t turned = turns(begun, end);
    if (analysis) turned = turns(begun, std::min(end, polar_pairs_)) + turns(std::max(begun, polar_pairs_), end);
    cost.counted += 1 + turned + turns(begun, loaded);
    cost.loops += 8; // zones, and the ends of loops
    cost.work += double(turned) * rings;
    loaded = std::min(loaded, begun);
  }
  if (analysis) cost.first_segment = 0;
  cost.loops += cost.counted + 8;
  // Loading a segment costs about what two turns do.
  cost.work = (cost.work + 2.0 * (cost.segments - cost.first_segment) * rings) * shape_.steps * sizes_.lanes;
  return cost;
}

Legendre::Layout& Legendre::layout(RingSlab slab, std::uint32_t fields, bool analysis) {
  for (const auto& kept : layouts_)
    if (kept->slab.first == slab.first && kept->slab.count == slab.count && kept->fields == fields &&
        kept->analysis == analysis)
      return *kept;
  auto made = std::make_unique<Layout>();
  made->slab = slab;
  made->fields = fields;
  made->analysis = analysis;

  const std::uint32_t rings = this->rings(fields, analysis);
  std::uint32_t most = analysis ? shape_.analysis_pairs : shape_.synthesis_pairs;
  std::vector<RingSlab> parts;
  for (;; most = std::max(most / 2 / rings * rings, rings)) {
    parts = ranges(slab, most, rings, analysis);
    std::uint64_t loops = 0;
    for (const RingSlab& part : parts)
      for (std::uint32_t g = 0; g < sizes_.groups; ++g) loops = std::max(loops, cost(g, part, rings, analysis).loops);
    if (loops <= shape_.iteration_budget) break;
    if (most == rings)
      throw Error(Failure::out_of_range, 0,
                  fmt::format("{} loop iterations of a transform to this degree are more than the {} allowed on the "
                              "device {}; lower --lmax or use --device cpu",
                              loops, shape_.iteration_budget, device_.name()));
  }

  const std::uint64_t lanes = sizes_.lanes, slots = analysis ? parts.size() : 1;
  for (std::uint32_t begin = 0; begin < sizes_.groups;) {
    std::uint32_t end = begin + 1;
    while (end < sizes_.groups) {
      const std::uint64_t steps = sizes_.first_step[end + 1] - sizes_.first_step[begin];
      const std::uint64_t most_of_these =
          std::max({32 * steps * lanes, 32 * steps * lanes * fields * slots, 16 * (end + 1 - begin) * pairs_ * lanes});
      if (most_of_these > shape_.most_bytes) break;
      ++end;
    }
    add_chunk(*made, begin, end, parts);
    begin = end;
  }
  made->item_buffer = std::make_unique<Buffer>(device_, made->items.size() * sizeof(made->items[0]), "the work items");
  made->item_buffer->write(std::as_bytes(std::span(made->items)));
  made->counts = std::make_unique<Buffer>(device_, 4 * made->items.size(), "the step counts");
  made->counts->clear();
  layouts_.push_back(std::move(made));
  return *layouts_.back();
}

// Software devices give each thread a stretch of consecutive workgroups. Dealt by the bits of their rank in reverse, the
// items weigh about the same in every stretch, however many there are.
void Legendre::arrange(std::vector<Work>& sorted) {
  std::vector<Work> dealt;
  const std::uint32_t size = std::bit_ceil(std::uint32_t(sorted.size()));
  for (std::uint32_t i = 0; i < size; ++i) {
    std::uint32_t rank = 0;
    for (std::uint32_t bit = 1; bit < size; bit <<= 1) rank = 2 * rank + ((i & bit) != 0);
    if (rank < sorted.size()) dealt.push_back(sorted[rank]);
  }
  sorted = std::move(dealt);
}

void Legendre::add_chunk(Layout& layout, std::uint32_t begin, std::uint32_t end, const std::vector<RingSlab>& parts) {
  std::vector<Work> work;
  const std::uint64_t chunk_steps = sizes_.first_step[end] - sizes_.first_step[begin];
  double all = 0;
  for (std::uint32_t g = begin; g < end; ++g)
    for (std::size_t part = 0; part < parts.size(); ++part) {
      const Cost cost = this->cost(g, parts[part], rings(layout.fields, layout.analysis), layout.analysis);
      const std::uint64_t step = sizes_.first_step[g] - sizes_.first_step[begin];
      const shaders::LegendreItem item = {g,
                                          parts[part].first,
                                          parts[part].first + parts[part].count,
                                          cost.first_segment,
                                          cost.segments,
                                          std::uint32_t(2 * step * sizes_.lanes),
                                          std::uint32_t(std::uint64_t(g - begin) * pairs_ * sizes_.lanes),
                                          std::uint32_t(step),
                                          std::uint32_t(part * chunk_steps + step)};
      work.push_back({item, cost});
      all += cost.work;
    }
  // The heaviest first, dealt out to the batches in turn.
  std::stable_sort(work.begin(), work.end(), [](const Work& a, const Work& b) { return a.cost.work > b.cost.work; });
  const double multiply_adds = all * (2 + 4 * layout.fields);
  const auto batches = std::max<std::size_t>(
      {1, std::size_t(multiply_adds / batch_work), work.size() / device_.limits().maxComputeWorkGroupCount[0] + 1});
  Chunk chunk{begin, end, layout.analysis ? std::uint32_t(parts.size()) : 1, {}};
  for (std::size_t b = 0; b < batches; ++b) {
    std::vector<Work> mine;
    Batch batch{std::uint32_t(layout.items.size()), 0, 0};
    for (std::size_t i = b; i < work.size(); i += batches) mine.push_back(work[i]);
    if (mine.empty()) continue;
    if (device_.software()) arrange(mine);
    for (const Work& w : mine) {
      layout.items.push_back(w.item);
      layout.expected.push_back(w.cost.counted);
      batch.work += w.cost.work;
    }
    batch.count = std::uint32_t(mine.size());
    chunk.batches.push_back(batch);
  }
  layout.chunks.push_back(std::move(chunk));
}

void Legendre::run(Job& job, Layout& layout, const Buffer& input, const Buffer& result, bool add,
                   const Between& between) {
  const bool analysis = layout.analysis;
  const std::uint64_t lanes = sizes_.lanes, fields = layout.fields;
  const Kernel& kernel = device_.kernel({analysis ? "legendre_analysis" : "legendre_synthesis",
                                         analysis ? shaders::legendre_analysis : shaders::legendre_synthesis,
                                         LEGENDRE_BINDINGS,
                                         sizeof(shaders::LegendrePush),
                                         {shape_.lanes, shape_.steps, rings(layout.fields, analysis), layout.fields,
                                          analysis ? shape_.analysis_pairs : shape_.synthesis_pairs},
                                         binding_kinds()});
  const std::uint64_t wave_bytes = 32 * fields * sizes_.columns * layout.slab.count;
  double work = 0, all = 0, done = 0;
  for (const Chunk& chunk : layout.chunks)
    for (const Batch& batch : chunk.batches) all += batch.work;
  for (const Chunk& chunk : layout.chunks) {
    const std::uint64_t first_step = sizes_.first_step[chunk.begin], steps = sizes_.first_step[chunk.end] - first_step;
    const std::uint64_t series_bytes = 32 * fields * steps * lanes;
    const BufferRange series = {analysis ? &result : &input, 32 * fields * first_step * lanes, series_bytes};
    const BufferRange waves = {analysis ? &input : &result, 0, wave_bytes};
    const bool sum = analysis && (add || chunk.slots > 1);
    const BufferRange partial = {partial_.get(), 0, chunk.slots * series_bytes};
    const BufferRange ranges[LEGENDRE_BINDINGS] = {
        {recurrence_.get(), 32 * first_step * lanes, 32 * steps * lanes},
        {seeds_.get(), 16 * lanes * pairs_ * chunk.begin, 16 * lanes * pairs_ * (chunk.end - chunk.begin)},
        analysis ? waves : series,
        {rings_.get()},
        !analysis ? waves
        : sum     ? partial
                  : series,
        {layout.item_buffer.get()},
        {first_active_.get()},
        {layout.counts.get()}};
    for (const Batch& batch : chunk.batches) {
      const shaders::LegendrePush push = {batch.first, layout.slab.first, sizes_.columns, polar_pairs_,
                                          first_segments_};
      job.dispatch(kernel, ranges, std::as_bytes(std::span(&push, 1)), batch.count);
      work += batch.work * (2 + 4 * double(fields));
      done += batch.work;
      if (work < batch_work) continue;
      work = 0;
      job.run();
      between(done / all);
    }
    if (!sum) continue;
    const shaders::LegendreSumPush push = {std::uint32_t(series_bytes / 16), std::uint32_t(series_bytes / 16),
                                           chunk.slots, add ? 1U : 0U};
    const Kernel& sum_kernel = device_.kernel(
        {"legendre_sum", shaders::legendre_sum, LEGENDRE_SUM_BINDINGS, sizeof(shaders::LegendreSumPush), {64}});
    const BufferRange sum_ranges[LEGENDRE_SUM_BINDINGS] = {partial, series};
    job.dispatch(sum_kernel, sum_ranges, std::as_bytes(std::span(&push, 1)),
                 std::min<std::uint32_t>(push.size / 256 + 1, 16384));
  }
  ran_ = &layout;
}

void Legendre::synthesis(Job& job, const Buffer& series, const Buffer& waves, RingSlab slab, std::uint32_t fields,
                         const Between& between) {
  run(job, layout(slab, fields, false), series, waves, false, between);
}

void Legendre::analysis(Job& job, const Buffer& waves, const Buffer& series, RingSlab slab, std::uint32_t fields,
                        bool first, const Between& between) {
  Layout& layout = this->layout(slab, fields, true);
  std::uint64_t most = 0;
  for (const Chunk& chunk : layout.chunks)
    if (!first || chunk.slots > 1)
      most = std::max(most, 32 * fields * chunk.slots * sizes_.lanes *
                                (sizes_.first_step[chunk.end] - sizes_.first_step[chunk.begin]));
  if (most && (!partial_ || partial_->size() < most))
    partial_ = std::make_unique<Buffer>(device_, most, "the partial sums over rings");
  run(job, layout, waves, series, !first, between);
}

void Legendre::check_counts() {
  if (!ran_) return;
  std::vector<std::uint32_t> counts(ran_->expected.size());
  ran_->counts->read(std::as_writable_bytes(std::span(counts)));
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] != ran_->expected[i])
      throw Error(Failure::cut_short, 0,
                  fmt::format("the device {} ended a loop early: item {} of {} ran {} of {} steps; the result would be "
                              "wrong; use --device cpu and report this",
                              device_.name(), i, counts.size(), counts[i], ran_->expected[i]));
}

} // namespace cowgpu::engine

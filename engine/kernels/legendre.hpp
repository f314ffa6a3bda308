// The kernels legendre_analysis, legendre_synthesis and legendre_sum: between the waves E and O of pairs of rings and the
// series qe, qo and re, ro in the steps k of each order. The mathematics stands in host/plan/legendre.hpp, the shaders'
// interface in shaders/legendre.h.
#pragma once

#include "engine/gpu.hpp"
#include "engine/kernels/ring_fourier.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace cowgpu::engine {

/// Fields that share the recurrence at most.
inline constexpr std::uint32_t most_fields_together = 3;

/// How the work is laid out on a device. Zeros are filled in by the kind of device.
struct LegendreShape {
  using ByFields = std::array<std::uint32_t, most_fields_together>; // for 1, 2, 3 fields
  std::uint32_t lanes = 0;                                          ///< orders m a workgroup: the subgroup's size
  std::uint32_t steps = 0;           ///< steps k of a segment, unrolled; a multiple of 8, at most 64
  ByFields analysis_rings = {};      ///< pairs of rings worked on together; 1, 2, 4 or 8
  ByFields synthesis_rings = {};     ///< the same
  std::uint32_t analysis_pairs = 0;  ///< most pairs of rings a workgroup sums over; a multiple of all analysis_rings
  std::uint32_t synthesis_pairs = 0; ///< most pairs of rings a workgroup works on; a multiple of all synthesis_rings
  std::uint32_t iteration_budget = 60000; ///< loop iterations an invocation may run in one dispatch
  std::uint64_t most_bytes = 0;           ///< a binding spans at most; 0: what the device can
};

/// Software devices run 32 steps in registers, on few pairs of rings at a time where registers are short, and keep the
/// state of many pairs in private arrays. Others run 8 steps on 4 pairs; the synthesis keeps all state in registers.
LegendreShape legendre_shape(const GpuFacts& facts, LegendreShape wanted = {});

/// What host/plan/legendre.hpp makes; `start` and `seeds` for groups of `lanes` orders and segments of `steps` steps.
struct LegendreInput {
  int lmax = 0;
  int polar_pairs = 0;                 ///< a multiple of 8, as the number of pairs
  std::span<const double> t;           ///< [pair]
  std::span<const std::size_t> offset; ///< where each order begins in a, b, b_polar
  std::span<const double> a, b, b_polar;
  std::span<const std::uint32_t> start; ///< [group][block]
  std::span<const double> seeds;        ///< [m][block][2][8]
};

/// Sizes that follow from the shape and lmax.
struct LegendreSizes {
  LegendreSizes(const LegendreShape& shape, int lmax);
  std::uint32_t groups = 0;
  std::uint32_t columns = 0;             ///< groups * lanes: orders with padding
  std::vector<std::uint64_t> first_step; ///< first step of each group; groups + 1 entries
  std::uint64_t series_doubles(std::uint32_t fields) const { return first_step.back() * fields * 4 * lanes; }
  std::uint32_t lanes = 0;
};

class Legendre {
public:
  /// Uploads what stays the same. Throws Error(out_of_range) for a shape the device cannot take, Error(vulkan).
  Legendre(Device& device, const LegendreShape& shape, const LegendreInput& input);
  ~Legendre();

  /// Lays the work out and uploads the lists of it, unless that was done before. Not while a job is being recorded.
  void prepare(RingSlab slab, std::uint32_t fields, bool analysis) { layout(slab, fields, analysis); }

  /// After prepare(). Waves of the pairs of `slab`, [pair of the slab][field][column][E or O] complex, from `series`:
  /// [group][k][field][lane][qe or qo] complex. Runs the job and calls `between` with the fraction done after every
  /// bounded batch; the rest is left recorded.
  using Between = std::function<void(double)>;
  void synthesis(Job& job, const Buffer& series, const Buffer& waves, RingSlab slab, std::uint32_t fields,
                 const Between& between);
  /// The other direction: `series` [group][k][field][lane][re or ro] is set by the first slab of a transform and added to
  /// by the others.
  void analysis(Job& job, const Buffer& waves, const Buffer& series, RingSlab slab, std::uint32_t fields, bool first,
                const Between& between);

  /// After the job ran: throws Error(cut_short) if the device ended a loop early.
  void check_counts();

  const LegendreSizes& sizes() const { return sizes_; }

private:
  struct Chunk;
  struct Batch;
  struct Layout;
  struct Work;
  // Of a group of orders on a range of pairs.
  struct Cost {
    std::uint32_t first_segment = 0, segments = 0;
    std::uint32_t counted = 0; // loop iterations as the shader counts them
    std::uint64_t loops = 0;   // with those it does not count, at most
    double work = 0;           // steps on pairs, all lanes
  };
  void check_shape() const;
  void upload(const LegendreInput& input);
  std::uint32_t rings(std::uint32_t fields, bool analysis) const {
    return (analysis ? shape_.analysis_rings : shape_.synthesis_rings)[fields - 1];
  }
  std::vector<RingSlab> ranges(RingSlab slab, std::uint32_t most, std::uint32_t multiple, bool analysis) const;
  Cost cost(std::uint32_t group, RingSlab range, std::uint32_t rings, bool analysis) const;
  Layout& layout(RingSlab slab, std::uint32_t fields, bool analysis);
  void add_chunk(Layout& layout, std::uint32_t begin, std::uint32_t end, const std::vector<RingSlab>& parts);
  static void arrange(std::vector<Work>& sorted);
  void run(Job& job, Layout& layout, const Buffer& input, const Buffer& result, bool add, const Between& between);

  Device& device_;
  LegendreShape shape_;
  LegendreSizes sizes_;
  std::uint32_t pairs_, polar_pairs_, first_segments_;
  std::vector<std::uint32_t> first_; ///< [group][segment]: first active pair
  std::unique_ptr<Buffer> recurrence_, seeds_, rings_, first_active_, partial_;
  std::vector<std::unique_ptr<Layout>> layouts_;
  const Layout* ran_ = nullptr; // last
};

} // namespace cowgpu::engine

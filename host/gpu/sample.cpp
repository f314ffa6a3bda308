#include "host/gpu/sample.hpp"

#include "engine/kernels/sample.hpp"
#include "host/clock.hpp"
#include "host/gpu/errors.hpp"
#include "host/parallel.hpp"
#include "host/plan/sample.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <utility>

namespace cowgpu::gpu {
namespace {

constexpr std::size_t points_per_band = std::size_t(1) << 20;
constexpr int rings_per_task = 16;

int rings_per_band(const SphereGrid& grid) {
  return int(std::max<std::size_t>(1, points_per_band / std::size_t(grid.ring_length)));
}

// One band of rings on its way through the device.
class Band {
public:
  Band(const plan::Sample& sample, std::span<const std::uint32_t> ranks, int begin, int end)
      : sample_(sample), ranks_(ranks), begin_(begin), end_(end), n_(sample.grid.ring_length),
        first_(std::size_t(begin) * std::size_t(n_)) {}

  void prepare() {
    corners_.resize(9 * ranks_.size());
    for (std::size_t t = 0; t < ranks_.size(); ++t) {
      const plan::SampleCorners c = sample_.corners(ranks_[t]);
      double* to = &corners_[9 * t];
      for (const Vec3& v : {c.a, c.b, c.c})
        for (int k = 0; k < 3; ++k) *to++ = v[k];
    }
    const int tasks = (end_ - begin_ + rings_per_task - 1) / rings_per_task;
    std::vector<std::vector<engine::SampleSpan>> parts(static_cast<std::size_t>(tasks));
    parallel_for(0, parts.size(), [&](std::size_t task, unsigned) {
      const int begin = begin_ + int(task) * rings_per_task;
      add_spans(begin, std::min(end_, begin + rings_per_task), parts[task]);
    });
    for (const auto& part : parts) spans_.insert(spans_.end(), part.begin(), part.end());
  }

  void run(engine::Device& device) {
    std::vector<double> rings, longitudes;
    const SphereDirections& d = sample_.directions;
    for (int i = begin_; i < end_; ++i) rings.insert(rings.end(), {d.sine[std::size_t(i)], d.cosine[std::size_t(i)]});
    for (std::size_t j = 0; j < std::size_t(n_); ++j)
      longitudes.insert(longitudes.end(), {d.cosine_phi[j], d.sine_phi[j]});
    engine::sample(device, {spans_, corners_, rings, longitudes, plan::sample_filter}, output_);
  }

  // What the filter left open, exactly.
  void decide(SphereSamples& result) {
    auto& open = output_.open;
    std::sort(open.begin(), open.end());
    std::vector<plan::Place> places(open.size());
    result.exact_decisions += open.size();
    constexpr std::size_t chunk = 256;
    parallel_for(0, (open.size() + chunk - 1) / chunk, [&](std::size_t task, unsigned) {
      for (std::size_t i = task * chunk; i < std::min(open.size(), (task + 1) * chunk); ++i)
        places[i] = sample_.place(ranks_[open[i][1]], direction(open[i][0]));
    });
    for (std::size_t i = 0; i < open.size();) {
      const std::uint32_t p = open[i][0], before = output_.owners[p];
      std::uint32_t& owner = output_.owners[p];
      int inside = before == 0 ? 0 : output_.folded[p] != 0 ? 2 : 1;
      bool edge = false;
      for (; i < open.size() && open[i][0] == p; ++i) {
        if (places[i] == plan::Place::outside) continue;
        inside += places[i] == plan::Place::inside;
        const auto claim = std::uint32_t(ranks_.size()) - open[i][1];
        if (claim <= owner) continue;
        owner = claim;
        edge = places[i] == plan::Place::edge;
      }
      output_.folded[p] = inside > 1;
      result.edge_points += edge;
      if (owner == before) continue;
      const auto weights = plan::barycentric(direction(p), sample_.corners(rank_of(owner)));
      std::copy(weights.begin(), weights.end(), &output_.weights[3 * std::size_t(p)]);
    }
  }

  // Into the result; `hit` by rank. Returns points without a triangle, `lowest` the lowest of them.
  std::uint64_t finish(SphereSamples& result, std::span<std::uint8_t> hit, std::size_t& lowest) const {
    std::uint64_t uncovered = 0;
    std::mutex mutex;
    constexpr std::size_t chunk = 1 << 15;
    const std::size_t points = output_.owners.size();
    parallel_for(0, (points + chunk - 1) / chunk, [&](std::size_t task, unsigned) {
      std::uint64_t flipped = 0, folded = 0, open = 0;
      std::size_t least = result.points();
      for (std::size_t p = task * chunk; p < std::min(points, (task + 1) * chunk); ++p) {
        if (output_.owners[p] == 0) {
          ++open;
          least = std::min(least, first_ + p);
          continue;
        }
        const std::uint32_t rank = rank_of(output_.owners[p]);
        const plan::SampleFace& face = sample_.kept[rank];
        const double* w = &output_.weights[3 * p];
        result.faces[first_ + p] = face.face;
        result.weights[first_ + p] = {w[0], w[face.flipped ? 2 : 1], w[face.flipped ? 1 : 2]};
        std::atomic_ref(hit[rank]).store(1, std::memory_order_relaxed);
        flipped += face.flipped;
        folded += output_.folded[p] != 0;
      }
      const std::lock_guard lock(mutex);
      result.flipped_points += flipped;
      result.folded_points += folded;
      uncovered += open;
      lowest = std::min(lowest, least);
    });
    return uncovered;
  }

private:
  Vec3 direction(std::uint32_t p) const { return sample_.directions(begin_ + int(p) / n_, int(p) % n_); }
  std::uint32_t rank_of(std::uint32_t owner) const { return ranks_[ranks_.size() - owner]; }

  void add_spans(int begin, int end, std::vector<engine::SampleSpan>& to) const {
    const auto most = int(engine::sample_span_points());
    std::array<plan::RingSpan, 2> spans;
    for (std::size_t t = 0; t < ranks_.size(); ++t) {
      const plan::SampleFace& face = sample_.kept[ranks_[t]];
      if (face.last_ring < begin || face.first_ring >= end) continue;
      const plan::RingScan scan(sample_, ranks_[t]);
      for (int ring = std::max(begin, face.first_ring); ring <= std::min(end - 1, face.last_ring); ++ring)
        for (int s = 0, count = scan.spans(ring, spans); s < count; ++s) {
          const plan::RingSpan& span = spans[std::size_t(s)];
          for (int done = 0; done < span.count; done += most)
            to.push_back({std::uint32_t(t), std::uint32_t(ring - begin_), std::uint32_t(span.first + done),
                          std::uint32_t(std::min(most, span.count - done))});
        }
    }
  }

  const plan::Sample& sample_;
  std::span<const std::uint32_t> ranks_;
  int begin_, end_, n_;
  std::size_t first_;
  std::vector<double> corners_;
  std::vector<engine::SampleSpan> spans_;
  engine::SampleOutput output_;
};

class GpuSampler final : public SphereSampler {
public:
  GpuSampler(std::shared_ptr<engine::Gpu> gpu, const SphereGrid& grid) : gpu_(std::move(gpu)), grid_(grid) {}

  MemoryNeed memory(std::uint64_t faces) const override {
    const int rings = std::min(grid_.rings, rings_per_band(grid_));
    const std::uint64_t bands = std::uint64_t((grid_.rings + rings - 1) / rings);
    const std::uint64_t points = std::uint64_t(rings) * std::uint64_t(grid_.ring_length);
    // A span has a point; no point is expected to lie in the reach of more than four triangles.
    const std::uint64_t spans = 4 * points + faces;
    MemoryNeed need;
    need.device = engine::sample_device_bytes(points, faces, spans);
    need.host = grid_.points() * 28 + points * 32 + 3 * sizeof(engine::SampleSpan) * spans +
                faces * (72 + 1 + 2 * sizeof(plan::SampleFace) + 8 * bands) + 32 * std::uint64_t(grid_.rings) +
                32 * std::uint64_t(grid_.ring_length);
    return need;
  }

  SphereSamples sample(std::span<const Vec3> positions, std::span<const Face> faces, Monitor& monitor,
                       RunReport* report) const override {
    return watched(*gpu_, monitor, [&] { return found(positions, faces, monitor, report); });
  }

private:
  SphereSamples found(std::span<const Vec3> positions, std::span<const Face> faces, Monitor& monitor,
                      RunReport* report) const {
    const auto start = Clock::now();
    const plan::Sample plan(positions, faces, grid_, 0);
    const int rings = rings_per_band(grid_);
    const auto bands = plan.bands(rings);
    SphereSamples result = plan.samples();
    double setup = seconds_since(start);

    gpu_->take_profile();
    std::vector<std::uint8_t> hit(plan.kept.size(), 0);
    std::size_t lowest = grid_.points();
    std::uint64_t uncovered = 0;
    for (std::size_t b = 0; b < bands.size(); ++b) {
      check_stop(monitor);
      const int begin = int(b) * rings;
      Band band(plan, bands[b], begin, std::min(grid_.rings, begin + rings));
      const auto before = Clock::now();
      band.prepare();
      setup += seconds_since(before);
      band.run(gpu_->device());
      band.decide(result);
      uncovered += band.finish(result, hit, lowest);
      monitor.progress("sample", double(b + 1) / double(bands.size()));
    }
    if (uncovered > 0) plan.refuse(lowest, uncovered);
    result.faces_hit = std::uint64_t(std::count(hit.begin(), hit.end(), 1));
    if (report) {
      *report = {};
      report->setup_seconds = setup;
      report->seconds = seconds_since(start);
      for (const auto& k : gpu_->take_profile()) report->kernels.push_back({k.kernel, k.dispatches, k.seconds});
    }
    return result;
  }

  std::shared_ptr<engine::Gpu> gpu_;
  SphereGrid grid_;
};

} // namespace

std::unique_ptr<SphereSampler> sphere_sampler(std::shared_ptr<engine::Gpu> gpu, const SphereGrid& grid) {
  return std::make_unique<GpuSampler>(std::move(gpu), grid);
}

} // namespace cowgpu::gpu

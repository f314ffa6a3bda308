#include "host/cpu/sample.hpp"

#include "host/clock.hpp"
#include "host/parallel.hpp"
#include "host/plan/sample.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>

namespace cowgpu::cpu {
namespace {

constexpr int rings_per_band = 16;
constexpr std::uint32_t nobody = 0xffffffff;

// What is known of a point beside its owner.
constexpr std::uint8_t inside_one = 1, inside_more = 2, owner_edge = 4;

// The least n . d of a triangle's three planes, for consecutive points of a ring.
void least_values(const plan::RingScan& scan, const SphereDirections& directions, int ring, int first, int count,
                  double* least) {
  const auto i = std::size_t(ring);
  const double sine = directions.sine[i];
  const double* cosine_phi = &directions.cosine_phi[std::size_t(first)];
  const double* sine_phi = &directions.sine_phi[std::size_t(first)];
  const auto& n = scan.normals();
  const double ux = n[0].x(), uy = n[0].y(), u = n[0].z() * directions.cosine[i];
  const double vx = n[1].x(), vy = n[1].y(), v = n[1].z() * directions.cosine[i];
  const double wx = n[2].x(), wy = n[2].y(), w = n[2].z() * directions.cosine[i];
  for (int j = 0; j < count; ++j) {
    const double x = sine * cosine_phi[j], y = sine * sine_phi[j];
    const double a = (ux * x + uy * y) + u, b = (vx * x + vy * y) + v, c = (wx * x + wy * y) + w;
    const double ab = a < b ? a : b;
    least[j] = ab < c ? ab : c;
  }
}

class Band {
public:
  // Points of rings [begin, end). `owners` holds ranks, then faces.
  Band(const plan::Sample& sample, int begin, int end, SphereSamples& result)
      : sample_(sample), directions_(sample.directions), begin_(begin), end_(end), n_(sample.grid.ring_length),
        least_(std::size_t(n_)), known_(std::size_t(end - begin) * std::size_t(n_), std::uint8_t(0)),
        owners_(std::span(result.faces).subspan(at(begin), known_.size())),
        weights_(std::span(result.weights).subspan(at(begin), known_.size())) {
    std::fill(owners_.begin(), owners_.end(), nobody);
  }

  // Triangles come in the order of their ranks, so that the first to claim a point keeps it.
  void scan(std::uint32_t rank) {
    const plan::SampleFace& face = sample_.kept[rank];
    const plan::RingScan ring_scan(sample_, rank);
    std::array<plan::RingSpan, 2> spans;
    for (int ring = std::max(begin_, face.first_ring); ring <= std::min(end_ - 1, face.last_ring); ++ring)
      for (int s = 0, count = ring_scan.spans(ring, spans); s < count; ++s) {
        const plan::RingSpan& span = spans[std::size_t(s)];
        least_values(ring_scan, directions_, ring, span.first, span.count, least_.data());
        const std::size_t row = at(ring) - at(begin_) + std::size_t(span.first);
        for (int j = 0; j < span.count; ++j) {
          const double least = least_[std::size_t(j)];
          if (least < -plan::sample_filter) continue;
          auto place = plan::Place::inside;
          if (least <= plan::sample_filter) {
            place = sample_.place(rank, directions_(ring, span.first + j));
            ++exact;
          }
          if (place != plan::Place::outside) claim(row + std::size_t(j), rank, place);
        }
      }
  }

  // From owners to faces and weights.
  void finish(std::span<std::uint8_t> hit) {
    std::uint32_t last = nobody;
    plan::SampleCorners corners{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    for (int ring = begin_, p = 0; ring < end_; ++ring)
      for (int j = 0; j < n_; ++j, ++p) {
        const std::uint32_t rank = owners_[std::size_t(p)];
        if (rank == nobody) {
          first_uncovered = std::min(first_uncovered, at(begin_) + std::size_t(p));
          ++uncovered;
          continue;
        }
        const plan::SampleFace& face = sample_.kept[rank];
        if (rank != last) {
          corners = sample_.corners(rank);
          last = rank;
          std::atomic_ref(hit[rank]).store(1, std::memory_order_relaxed);
        }
        auto weights = plan::barycentric(directions_(ring, j), corners);
        if (face.flipped) std::swap(weights[1], weights[2]);
        owners_[std::size_t(p)] = face.face;
        weights_[std::size_t(p)] = weights;
        flipped += face.flipped;
        folded += (known_[std::size_t(p)] & inside_more) != 0;
        edges += (known_[std::size_t(p)] & owner_edge) != 0;
      }
  }

  std::uint64_t folded = 0, edges = 0, flipped = 0, uncovered = 0, exact = 0;
  std::size_t first_uncovered = std::numeric_limits<std::size_t>::max();

private:
  std::size_t at(int ring) const { return std::size_t(ring) * std::size_t(n_); }

  void claim(std::size_t p, std::uint32_t rank, plan::Place place) {
    if (owners_[p] == nobody) {
      owners_[p] = rank;
      if (place == plan::Place::edge) known_[p] |= owner_edge;
    }
    if (place == plan::Place::inside) known_[p] |= known_[p] & inside_one ? inside_more : inside_one;
  }

  const plan::Sample& sample_;
  const SphereDirections& directions_;
  int begin_, end_, n_;
  std::vector<double> least_;
  std::vector<std::uint8_t> known_;
  std::span<std::uint32_t> owners_;
  std::span<std::array<double, 3>> weights_;
};

class CpuSampler final : public SphereSampler {
public:
  CpuSampler(const SphereGrid& grid, unsigned threads) : grid_(grid), threads_(threads) {}

  MemoryNeed memory(std::uint64_t faces) const override {
    const std::uint64_t bands = std::uint64_t(grid_.rings) / rings_per_band + 1;
    const std::uint64_t ring = std::uint64_t(grid_.ring_length);
    // The result; a band a thread, of which there are never more than bands; faces twice while they are sorted, and once
    // in every band at worst.
    return {grid_.points() * (28 + 1) + (8 + 16) * ring + bands * 8 * ring + 32 * std::uint64_t(grid_.rings) +
                faces * (2 * sizeof(plan::SampleFace) + 1 + 8 * bands),
            0};
  }

  SphereSamples sample(std::span<const Vec3> positions, std::span<const Face> faces, Monitor& monitor,
                       RunReport* report) const override {
    const auto start = Clock::now();
    const plan::Sample plan(positions, faces, grid_, threads_);
    const auto bands = plan.bands(rings_per_band);
    SphereSamples result = plan.samples();
    const double setup = seconds_since(start);

    std::vector<std::uint8_t> hit(plan.kept.size(), 0);
    std::size_t first_uncovered = grid_.points(), done = 0;
    std::uint64_t uncovered = 0;
    std::mutex mutex;
    parallel_for(threads_, bands.size(), [&](std::size_t task, unsigned thread) {
      check_stop(monitor);
      const int begin = int(task) * rings_per_band;
      Band band(plan, begin, std::min(grid_.rings, begin + rings_per_band), result);
      for (const std::uint32_t rank : bands[task]) band.scan(rank);
      band.finish(hit);
      const std::lock_guard lock(mutex);
      result.folded_points += band.folded;
      result.edge_points += band.edges;
      result.flipped_points += band.flipped;
      result.exact_decisions += band.exact;
      uncovered += band.uncovered;
      first_uncovered = std::min(first_uncovered, band.first_uncovered);
      ++done;
      if (thread == 0) monitor.progress("sample", double(done) / double(bands.size()));
    });
    if (uncovered > 0) plan.refuse(first_uncovered, uncovered);
    result.faces_hit = std::uint64_t(std::count(hit.begin(), hit.end(), 1));
    if (report) {
      *report = {};
      report->setup_seconds = setup;
      report->seconds = seconds_since(start);
    }
    return result;
  }

private:
  SphereGrid grid_;
  unsigned threads_;
};

} // namespace

std::unique_ptr<SphereSampler> sphere_sampler(const SphereGrid& grid, unsigned threads) {
  return std::make_unique<CpuSampler>(grid, threads);
}

} // namespace cowgpu::cpu

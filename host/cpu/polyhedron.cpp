#include "host/cpu/polyhedron.hpp"

#include "host/clock.hpp"
#include "host/cpu/moments.hpp"
#include "host/cpu/polyhedron_fast.hpp"
#include "host/cpu/polyhedron_kernel.hpp"
#include "host/cpu/potential.hpp"
#include "host/parallel.hpp"
#include "host/plan/polyhedron_call.hpp"
#include "host/plan/polyhedron_fast.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <numeric>
#include <optional>

namespace cowgpu::cpu {
namespace {

constexpr std::size_t block = plan::direct_block;
constexpr std::size_t patches_at_once = 4096; // between two looks at whether to stop
static_assert(block % polyhedron_group == 0);

// What a problem's calls share, made by the first.
struct Prepared {
  plan::PolyhedronSurface surface;
  plan::PolyhedronPatches<double> patches;
  std::vector<std::uint32_t> all; // patches
  std::optional<Multipoles> moments;
};

class CpuPolyhedron final : public PreparedPolyhedron {
public:
  CpuPolyhedron(const PolyhedronProblem& problem, unsigned threads) : problem_(problem), threads_(threads) {}

  MemoryNeed memory(std::uint64_t points) const override {
    const std::uint64_t faces = problem_.faces.size();
    MomentProblem moments;
    moments.vertices = problem_.vertices;
    moments.faces = problem_.faces;
    moments.lmax = plan::far_degree;
    return {plan::polyhedron_call_bytes(problem_, points) +
                plan::PolyhedronPatches<double>::bytes(faces, faces / plan::direct_patch + 1) +
                cpu::moments(moments, threads_)->memory().host +
                plan::potential_bytes(points, plan::far_degree, problem_.derivatives),
            0};
  }

  PolyhedronValues at(std::span<const Vec3> points, Monitor& monitor, RunReport* report) const override {
    const auto start = Clock::now();
    const std::scoped_lock only(mutex_);
    prepare();
    const plan::PolyhedronPoints order = plan::polyhedron_points(prepared_->surface, points, threads_);
    PolyhedronValues values = plan::polyhedron_values(problem_, points.size());
    const double setup = seconds_since(start);
    sum(points, order.near, monitor, values);
    if (!order.far.empty()) add_far(points, order.far, monitor, values);
    if (report) {
      *report = {};
      report->setup_seconds = setup;
      report->seconds = seconds_since(start);
      report->elements = double(order.near.size()) * double(problem_.faces.size());
      report->full_elements = double(points.size()) * double(problem_.faces.size());
    }
    return values;
  }

private:
  void prepare() const {
    if (prepared_) return;
    Prepared made;
    made.surface = plan::polyhedron_surface(problem_, threads_);
    made.patches = plan::PolyhedronPatches<double>(problem_.vertices, problem_.faces, made.surface.patches(),
                                                   made.surface.unit, threads_);
    made.all.resize(made.patches.size());
    std::iota(made.all.begin(), made.all.end(), 0U);
    prepared_.emplace(std::move(made));
  }

  void sum(std::span<const Vec3> points, std::span<const std::uint32_t> near, Monitor& monitor,
           PolyhedronValues& values) const {
    using Rows = plan::PolyhedronRows;
    const double unit = prepared_->surface.unit;
    PolyhedronTerms terms;
    terms.second = problem_.derivatives == Derivatives::second;
    terms.touching = prepared_->surface.touching / unit;
    const std::size_t blocks = (near.size() + block - 1) / block;
    std::vector<PolyhedronScratch> scratch(threads_);
    std::atomic<std::size_t> done = 0;
    parallel_for(threads_, blocks, [&](std::size_t b, unsigned thread) {
      const std::size_t first = b * block, own = std::min(block, near.size() - first);
      const std::size_t count = (own + polyhedron_group - 1) / polyhedron_group * polyhedron_group;
      double places[3 * block], sums[Rows::second * block] = {};
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < 3; ++k)
          places[k * count + i] = points[near[first + std::min(i, own - 1)]][Eigen::Index(k)] / unit;
      const std::span all(prepared_->all);
      for (std::size_t p = 0; p < all.size(); p += patches_at_once) {
        check_stop(monitor);
        sum_patches(prepared_->patches, all.subspan(p, std::min(patches_at_once, all.size() - p)), places, count, terms,
                    scratch[thread], sums);
      }
      for (std::size_t i = 0; i < own; ++i) plan::store_sums(problem_, unit, sums + i, count, near[first + i], values);
      const std::size_t now = ++done;
      if (thread == 0) monitor.progress("polyhedron", double(now) / double(blocks));
    });
  }

  void add_far(std::span<const Vec3> points, std::span<const std::uint32_t> far, Monitor& monitor,
               PolyhedronValues& values) const {
    if (!prepared_->moments)
      prepared_->moments = cpu::moments(plan::far_moments(problem_, prepared_->surface), threads_)->run(monitor);
    const PotentialProblem series{*prepared_->moments, plan::far_degree, problem_.derivatives};
    const std::vector<Vec3> places = plan::far_places(prepared_->surface, points, far);
    plan::store_far(exterior_potential(series, threads_)->at(places, monitor), far, values);
  }

  PolyhedronProblem problem_;
  unsigned threads_;
  mutable std::mutex mutex_;
  mutable std::optional<Prepared> prepared_;
};

} // namespace

std::unique_ptr<PreparedPolyhedron> polyhedron(const PolyhedronProblem& problem, unsigned threads) {
  auto direct = std::make_unique<CpuPolyhedron>(problem, threads);
  if (problem.tolerance == 0) return direct;
  return plan::faster_polyhedron(problem, fast_polyhedron(problem, threads), std::move(direct),
                                 [=](std::uint64_t points) { return plan::fast_sum_pays(problem, points); });
}

} // namespace cowgpu::cpu

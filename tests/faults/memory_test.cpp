// What verbs say that they allocate, against what they allocate: every byte that this process takes from the heap is counted.
#include "host/backend.hpp"
#include "host/mass/verify.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reader_checks.hpp"
#include "tests/support/vulkan_faults.hpp"

#include <catch2/catch.hpp>
#include <malloc.h>

#include <atomic>
#include <cstddef>
#include <functional>
#include <iostream>
#include <random>

#if !defined(__SANITIZE_ADDRESS__) && !defined(COWGPU_CLANG_SANITIZES)
#define COWGPU_COUNTS_HEAP 1
#endif

namespace {

std::atomic<long long> live = 0, most = 0;

#ifdef COWGPU_COUNTS_HEAP
void* counted(void* block) {
  if (!block) return block;
  const long long now = live += (long long)malloc_usable_size(block);
  for (long long before = most; now > before && !most.compare_exchange_weak(before, now);) {
  }
  return block;
}

void uncount(void* block) {
  if (block) live -= (long long)malloc_usable_size(block);
}
#endif

} // namespace

#ifdef COWGPU_COUNTS_HEAP
// The C library's allocator under other names, so that its own can be counted.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
  return counted(__libc_malloc(size));
}
void* calloc(std::size_t count, std::size_t size) {
  return counted(__libc_calloc(count, size));
}
void* realloc(void* block, std::size_t size) {
  uncount(block);
  return counted(__libc_realloc(block, size));
}
void* memalign(std::size_t alignment, std::size_t size) {
  return counted(__libc_memalign(alignment, size));
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return counted(__libc_memalign(alignment, size));
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  *block = counted(__libc_memalign(alignment, size));
  return *block ? 0 : 12;
}
void free(void* block) {
  uncount(block);
  __libc_free(block);
}
}
#endif

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

// The most bytes that lived at one time during the work, beside those that lived before.
double peak_of(const std::function<void()>& work) {
  const long long before = live;
  most = before;
  work();
  return double(most - before);
}

std::vector<Vec3> scattered(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = {uniform(random), uniform(random), uniform(random)};
  return points;
}

// A call of a verb, what it says of its memory, and the call itself. The verb is made anew by both.
struct Call {
  std::string name;
  std::function<MemoryNeed(const Backend&)> need;
  std::function<void(const Backend&)> run;
};

// Each with much of one thing and little of the others, so that no term of a formula hides behind another.
std::vector<Call> calls() {
  std::vector<Call> all;
  static const RawMesh small = icosphere(2), large = icosphere(5);
  const auto named = [](const char* verb, const RawMesh& mesh, auto number) {
    return std::string(verb) + ", " + std::to_string(mesh.faces.size()) + " faces, " + std::to_string(number);
  };
  const auto problem = [](const RawMesh& mesh, int lmax) { return moment_problem(mesh, lmax); };
  for (const auto& [mesh, lmax] : {std::pair(&large, 4), std::pair(&small, 250)}) {
    const MomentProblem asked = problem(*mesh, lmax);
    all.push_back({named("moments to degree", *mesh, lmax),
                   [=](const Backend& b) { return b.moments(asked)->memory(); },
                   [=](const Backend& b) { b.moments(asked)->run(silent_monitor()); }});
  }
  for (const auto& [lmax, fields] : {std::pair(120, 1), std::pair(40, 20)}) {
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, lmax);
    all.push_back({"transforms to degree " + std::to_string(lmax) + ", fields " + std::to_string(fields),
                   [=, fields = fields, lmax = lmax](const Backend& b) {
                     MemoryNeed need = b.sphere_transform(grid, lmax)->memory(fields);
                     need.host += std::uint64_t(fields) * (8 * grid.points() + 16 * SphereCoefficients::count(lmax));
                     return need;
                   },
                   [=, fields = fields, lmax = lmax](const Backend& b) {
                     SphereCoefficients a(lmax, fields);
                     std::vector<double> values(grid.points() * std::size_t(fields));
                     const auto transform = b.sphere_transform(grid, lmax);
                     transform->synthesise(fields, a.values, values, silent_monitor());
                     transform->analyse(fields, values, a.values, silent_monitor());
                   }});
  }
  for (const auto& [mesh, count] : {std::pair(&large, 4'000), std::pair(&large, 30'000)}) { // where it pays
    std::vector<Vec3> points = scattered(std::size_t(count));
    for (Vec3& p : points) p = 0.9 * p.normalized(); // all near the body
    PolyhedronProblem asked;
    asked.vertices = mesh->vertices;
    asked.faces = mesh->faces;
    asked.tolerance = 1e-9;
    all.push_back({named("fast sums of polyhedra, points", *mesh, count),
                   [=](const Backend& b) { return b.polyhedron(asked)->memory(points.size()); },
                   [=](const Backend& b) { b.polyhedron(asked)->at(points, silent_monitor()); }});
  }
  for (const auto& [mesh, lmax] : {std::pair(&large, 20), std::pair(&small, 300)}) {
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, lmax);
    std::vector<Vec3> unit = mesh->vertices;
    for (Vec3& v : unit) v.normalize();
    all.push_back(
        {named("samples of a grid of degree", *mesh, lmax),
         [=, mesh = mesh](const Backend& b) { return b.sphere_sampler(grid)->memory(mesh->faces.size()); },
         [=, mesh = mesh](const Backend& b) { b.sphere_sampler(grid)->sample(unit, mesh->faces, silent_monitor()); }});
  }
  for (const auto& [mesh, count] : {std::pair(&large, 100), std::pair(&small, 50'000)}) {
    const std::vector<Vec3> points = scattered(std::size_t(count));
    all.push_back({named("distances, queries", *mesh, count),
                   [=, mesh = mesh](const Backend& b) {
                     return b.distance_field(mesh->vertices, mesh->faces)->memory(points.size());
                   },
                   [=, mesh = mesh](const Backend& b) {
                     b.distance_field(mesh->vertices, mesh->faces)->closest(points, {}, silent_monitor());
                   }});
  }
  for (const auto& [mesh, count] : {std::pair(&large, 100), std::pair(&small, 5'000)}) {
    const std::vector<Vec3> starts = scattered(std::size_t(count));
    FlowOptions how;
    how.time = 0.1;
    all.push_back({named("flows, starts", *mesh, count),
                   [=, mesh = mesh](const Backend& b) {
                     return b.distance_flow(mesh->vertices, mesh->faces)->memory(starts.size());
                   },
                   [=, mesh = mesh](const Backend& b) {
                     b.distance_flow(mesh->vertices, mesh->faces)->flow(starts, {}, how, silent_monitor());
                   }});
  }
  for (const auto& [lmax, count] : {std::pair(500, 10), std::pair(4, 50'000)}) {
    const auto moments = std::make_shared<Multipoles>(lmax);
    (*moments)(0, 0) = 1;
    std::vector<Vec3> points = scattered(std::size_t(count));
    for (Vec3& p : points) p = 2 * p.normalized();
    all.push_back({"potentials to degree " + std::to_string(lmax) + ", points " + std::to_string(count),
                   [=, lmax = lmax](const Backend& b) {
                     return b.exterior_potential({*moments, lmax})->memory(points.size());
                   },
                   [=, lmax = lmax](const Backend& b) {
                     b.exterior_potential({*moments, lmax})->at(points, silent_monitor());
                   }});
  }
  return all;
}

} // namespace

TEST_CASE("the CPU path allocates no more than it says, and not much less", "[memory]") {
  if (!memory_is_measurable()) return;
  const auto cpu = make_cpu_backend(2);
  for (const Call& call : calls()) {
    INFO(call.name);
    call.run(*cpu); // tables that are made once
    const double said = double(call.need(*cpu).host), taken = peak_of([&] { call.run(*cpu); });
    INFO("said " << said << " bytes, took " << taken);
    CHECK(taken <= said + 65536); // threads, lists of functions
    CHECK(said <= 3 * taken + 65536);
  }
}

TEST_CASE("a check of moments allocates no more than it says", "[memory]") {
  if (!memory_is_measurable()) return;
  const auto cpu = make_cpu_backend(2);
  for (const auto& [level, lmax] : {std::pair(4, 4), std::pair(2, 200)}) {
    const RawMesh mesh = cowgpu::test::icosphere(level);
    const MomentProblem problem = moment_problem(mesh, lmax);
    INFO(mesh.faces.size() << " faces to degree " << lmax);
    for (const Verify how : {Verify::sample, Verify::full}) {
      verify_moments(problem, *cpu, how, 1, silent_monitor());
      const double taken = peak_of([&] { verify_moments(problem, *cpu, how, 1, silent_monitor()); });
      const double said =
          double(verify_bytes(problem, how) + cpu->moments(problem)->memory().host + 16 * Multipoles::count(lmax));
      INFO("said " << said << " bytes, took " << taken);
      CHECK(taken <= said + 65536);
      if (how == Verify::full) CHECK(said <= 6 * taken + 65536); // the sample takes a part of the faces alone
    }
  }
}

TEST_CASE("moments, transforms and fast sums allocate on the device no more than they say", "[memory][vulkan]") {
  const auto gpu = gpu_backend();
  if (!gpu) return skip_without_gpu();
  const auto run_all = calls();
  VulkanFaults counts;
  for (const Call& call : run_all) {
    if (!call.name.starts_with("moments") && !call.name.starts_with("transforms to degree 120") &&
        !call.name.starts_with("fast sums"))
      continue;
    INFO(call.name);
    const auto before = counts.live_memory();
    counts.disarm();
    const double kept = double(counts.most_bytes());
    call.run(*gpu);
    const MemoryNeed need = call.need(*gpu);
    const double taken = double(counts.most_bytes()) - kept;
    INFO("said " << need.device << " bytes and " << need.host << " on the host, took " << taken);
    CHECK(counts.live_memory() == before);
    CHECK(taken <=
          double(need.device) + double(need.host)); // what goes to the device and back passes through the host's
    CHECK(double(need.device) <= 4 * taken + 65536);
  }
}
